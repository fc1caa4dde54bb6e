/* Signals, and the temporary files that none of them leaves behind. */
#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void amontons_abandon_line(void);

/* A file that is to be removed if a signal ends the process. Nodes are used again and never freed, so that a handler
   can walk over them at any time. */
typedef struct temporary {
    struct temporary *next;
    atomic_flag is_taken;
    char path[PATH_MAX];
} temporary_t;

static _Atomic(temporary_t *) temporaries;

/* How many threads are between a hold and its release; `dying` once a handler has begun to remove files. */
static atomic_int holders;
enum { dying = -1 };
static volatile atomic_int pending;

/* From here to the release no signal ends the process, so that what changes on the disk meanwhile changes whole. */
void amontons_hold_signals(void)
{
    int n = atomic_load(&holders);
    do {
        while (n == dying) {
            pause();
            n = atomic_load(&holders);
        }
    } while (!atomic_compare_exchange_weak(&holders, &n, n + 1));
}

/* Ends what the hold began; a signal that came meanwhile now does its work. */
void amontons_release_signals(void)
{
    if (atomic_fetch_sub(&holders, 1) == 1 && atomic_load(&pending) != 0)
        raise(atomic_load(&pending));
}

/* What a process takes away before it ends: its temporary files, its line on the terminal. */
static void clear_up(void)
{
    for (temporary_t *file = atomic_load(&temporaries); file; file = file->next)
        if (file->path[0])
            unlink(file->path);
    amontons_abandon_line();
}

/* Clears up, then lets the signal end the process as if nothing had been arranged. */
static void end_process(int number)
{
    int none = 0, before = errno;
    atomic_store(&pending, number);
    if (atomic_compare_exchange_strong(&holders, &none, dying)) {
        clear_up();
        signal(number, SIG_DFL);
        raise(number);
    }
    errno = before;
}

/* What the signals of a fault did before: the run-time library tells where it happened. */
static struct sigaction tellers[NSIG];

/* As end_process, for the signals that a fault of the program raises; they may be sent from outside, too. A fault of
   the program's own cannot wait: it happens again on return, and is then told. */
static void end_fault(int number, siginfo_t *information, void *context)
{
    (void)context;
    int none = 0, before = errno;
    int is_sent = information->si_code <= 0;
    atomic_store(&pending, number);
    if (atomic_compare_exchange_strong(&holders, &none, dying) || !is_sent) {
        clear_up();
        sigaction(number, &tellers[number], NULL);
        if (is_sent)
            raise(number);
    }
    errno = before;
}

/* A node that no file has, or NULL where memory ran out. */
static temporary_t *take_node(void)
{
    temporary_t *node = atomic_load(&temporaries);
    while (node && atomic_flag_test_and_set(&node->is_taken))
        node = node->next;
    if (node)
        return node;
    node = calloc(1, sizeof *node);
    if (!node)
        return NULL;
    atomic_flag_test_and_set(&node->is_taken);
    node->next = atomic_load(&temporaries);
    while (!atomic_compare_exchange_weak(&temporaries, &node->next, node))
        ;
    return node;
}

/* Forgets a file. */
static void drop_node(temporary_t *node)
{
    node->path[0] = '\0';
    atomic_flag_clear(&node->is_taken);
}

/* Makes an empty file beside another, under a name that nobody could foresee and that nothing had before: a link laid
   out under it is not followed. Returns 0 or the system's error number. */
static int create(const char *path, char *name, size_t size)
{
    enum { most_attempts = 100 };
    for (int i = 0; i < most_attempts; i++) {
        uint32_t number;
        if (getentropy(&number, sizeof number) != 0)
            return errno;
        int length = snprintf(name, size, "%s.%08x.tmp", path, (unsigned)number);
        if (length < 0 || (size_t)length >= size)
            return ENAMETOOLONG;
        int file = open(name, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
        if (file >= 0)
            return close(file) == 0 ? 0 : errno;
        if (errno != EEXIST)
            return errno;
    }
    return EEXIST;
}

/* Makes a temporary file for a final name and puts its name into a text. Until it is forgotten a signal that ends the
   process removes it. Returns 0 or the system's error number. */
int amontons_create_temporary(const char *path, char *text, int size)
{
    temporary_t *node = take_node();
    if (!node)
        return ENOMEM;
    amontons_hold_signals();
    int code = create(path, node->path, sizeof node->path);
    if (code == 0)
        snprintf(text, (size_t)size, "%s", node->path);
    else
        drop_node(node);
    amontons_release_signals();
    return code;
}

/* Forgets a temporary file, which has been renamed or removed. */
void amontons_forget_temporary(const char *name)
{
    for (temporary_t *node = atomic_load(&temporaries); node; node = node->next)
        if (strcmp(node->path, name) == 0) {
            drop_node(node);
            return;
        }
}

/* Has a signal that asks for the end remove the temporary files first. One that is ignored stays so; one that somebody
   else takes, other than the run-time library, is left to him. */
static void arrange_end(int number, int is_library_taken)
{
    struct sigaction action, found;
    memset(&action, 0, sizeof action);
    action.sa_handler = end_process;
    action.sa_flags = SA_RESTART;
    sigfillset(&action.sa_mask);
    if (sigaction(number, NULL, &found) == 0 && found.sa_handler != SIG_IGN
        && (found.sa_handler == SIG_DFL || is_library_taken))
        sigaction(number, &action, NULL);
}

/* Has a signal of a fault remove the temporary files before it is told. */
static void arrange_fault(int number)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_sigaction = end_fault;
    action.sa_flags = SA_SIGINFO;
    sigfillset(&action.sa_mask);
    if (sigaction(number, NULL, &tellers[number]) == 0 && tellers[number].sa_handler != SIG_IGN)
        sigaction(number, &action, NULL);
}

/* Makes the process behave: a standard stream that is closed stays unusable instead of becoming the next file that is
   opened; a closed pipe and a limit on file sizes are errors of a write, not the end; and any other signal that ends
   the process does so after the temporary files are removed. */
void amontons_prepare_process(void)
{
    static const int ends[] = {SIGHUP, SIGINT, SIGTERM, SIGALRM, SIGVTALRM, SIGPROF, SIGPOLL, SIGUSR1, SIGUSR2,
#ifdef SIGPWR
        SIGPWR,
#endif
#ifdef SIGSTKFLT
        SIGSTKFLT,
#endif
    };
    static const int library_ends[] = {SIGQUIT, SIGXCPU};
    static const int faults[] = {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS, SIGTRAP};

    for (int file = STDIN_FILENO; file <= STDERR_FILENO; file++)
        if (fcntl(file, F_GETFD) == -1 && open("/dev/null", file == STDIN_FILENO ? O_WRONLY : O_RDONLY) != file)
            break;
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
        arrange_end(ends[i], 0);
    for (int number = SIGRTMIN; number <= SIGRTMAX; number++)
        arrange_end(number, 0);
    for (size_t i = 0; i < sizeof library_ends / sizeof library_ends[0]; i++)
        arrange_end(library_ends[i], 1);
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++)
        arrange_fault(faults[i]);
}

static volatile sig_atomic_t interrupt = 0;
static const int interrupts[] = {SIGINT, SIGTERM};
enum { n_interrupts = sizeof interrupts / sizeof interrupts[0] };
static struct sigaction before[n_interrupts];

static void note_interrupt(int number)
{
    if (interrupt)
        end_process(number);
    else
        interrupt = number;
}

/* From now on the first SIGINT or SIGTERM is noted, and the second ends the process. One that is ignored stays so. */
void amontons_hold_interrupts(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = note_interrupt;
    action.sa_flags = SA_RESTART;
    sigfillset(&action.sa_mask);
    interrupt = 0;
    for (int i = 0; i < n_interrupts; i++)
        if (sigaction(interrupts[i], NULL, &before[i]) == 0 && before[i].sa_handler != SIG_IGN)
            sigaction(interrupts[i], &action, NULL);
}

/* Puts back what amontons_hold_interrupts found. */
void amontons_release_interrupts(void)
{
    for (int i = 0; i < n_interrupts; i++)
        sigaction(interrupts[i], &before[i], NULL);
}

/* The signal that was noted, 0 for none. */
int amontons_interrupt(void)
{
    return interrupt;
}
