/* The few system calls that Fortran has no name for. */
#define _XOPEN_SOURCE 700

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

/* Makes a directory and its parents. Returns 0 when it exists afterwards, the system's error number otherwise. */
int amontons_make_directory(const char *path)
{
    char parent[PATH_MAX];
    size_t length = strlen(path);
    if (length == 0)
        return ENOENT;
    if (length >= sizeof parent)
        return ENAMETOOLONG;
    for (size_t i = 1; i < length; i++) {
        if (path[i] != '/')
            continue;
        memcpy(parent, path, i);
        parent[i] = '\0';
        if (mkdir(parent, 0777) != 0 && errno != EEXIST)
            return errno;
    }
    if (mkdir(path, 0777) == 0)
        return 0;
    if (errno != EEXIST)
        return errno;
    struct stat status;
    if (stat(path, &status) != 0)
        return errno;
    return S_ISDIR(status.st_mode) ? 0 : ENOTDIR;
}

/* Puts the name of a file from the root on into a text of a given size; the name itself where there is no such file. */
void amontons_absolute_path(const char *path, char *text, int size)
{
    char resolved[PATH_MAX];
    snprintf(text, (size_t)size, "%s", realpath(path, resolved) ? resolved : path);
}

/* Puts a file in the place of another, in one step. Returns 0 or the system's error number. */
int amontons_rename(const char *from, const char *to)
{
    return rename(from, to) == 0 ? 0 : errno;
}

/* Removes a file. Returns 0 or the system's error number. */
int amontons_remove(const char *path)
{
    return unlink(path) == 0 ? 0 : errno;
}

/* Puts the system's words for an error number into a text of a given size, ended by a zero. */
void amontons_error_text(int code, char *text, int size)
{
    snprintf(text, (size_t)size, "%s", strerror(code));
}

/* The number of this process. */
int amontons_process_id(void)
{
    return (int)getpid();
}

/* The most memory this process ever held, in kibibytes. */
long amontons_peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_maxrss : 0;
}

/* Cuts a file to a number of bytes. Returns 0 or the system's error number. */
int amontons_truncate(const char *path, long n_bytes)
{
    return truncate(path, (off_t)n_bytes) == 0 ? 0 : errno;
}

/* Returns when every byte of a file is on the disk. Returns 0 or the system's error number. */
int amontons_synchronize(const char *path)
{
    int file = open(path, O_RDONLY);
    if (file < 0)
        return errno;
    /* Devices and some file systems know no synchronisation. */
    int code = fsync(file) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno;
    close(file);
    return code;
}

/* Whether somebody watches standard error on a terminal. */
int amontons_error_is_terminal(void)
{
    return isatty(STDERR_FILENO);
}

static volatile sig_atomic_t interrupt = 0;
static const int interrupts[] = {SIGINT, SIGTERM};
enum { n_interrupts = sizeof interrupts / sizeof interrupts[0] };
static struct sigaction before[n_interrupts];

static void note_interrupt(int signal)
{
    interrupt = signal;
}

/* From now on the first SIGINT or SIGTERM is noted, and the second ends the process. One that is ignored stays so. */
void amontons_hold_interrupts(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = note_interrupt;
    action.sa_flags = SA_RESTART | (int)SA_RESETHAND;
    sigemptyset(&action.sa_mask);
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

/* The number after a word in a file of the system such as /proc/meminfo; -1 where there is none. */
static long long number_after(const char *file, const char *word)
{
    FILE *stream = fopen(file, "r");
    if (!stream)
        return -1;
    char line[256];
    long long number = -1;
    while (number < 0 && fgets(line, sizeof line, stream))
        if (strncmp(line, word, strlen(word)) == 0)
            number = strtoll(line + strlen(word), NULL, 10);
    fclose(stream);
    return number;
}

/* The memory this process holds now, in kibibytes; 0 where the system does not tell. */
long long amontons_resident_memory(void)
{
    long long resident = number_after("/proc/self/status", "VmRSS:");
    return resident > 0 ? resident : 0;
}

/* The memory this process can still get, in kibibytes: what the system has to give and what the limit on the address
   space leaves; -1 where neither is known. */
long long amontons_available_memory(void)
{
    long long available = number_after("/proc/meminfo", "MemAvailable:");
    long long used = number_after("/proc/self/status", "VmSize:");
    struct rlimit limit;
    if (used >= 0 && getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        long long left = (long long)(limit.rlim_cur / 1024) - used;
        if (left < 0)
            left = 0;
        if (available < 0 || left < available)
            available = left;
    }
    return available;
}

/* Gives memory that was freed back to the system, where the C library keeps it for later. */
void amontons_return_memory(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}
