/* What a long run is doing: on a terminal a line drawn anew each second, gone before anything is printed; in a log
   lines of their own, less and less often. */
#define _DEFAULT_SOURCE

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

int amontons_write(int file, const char *text, long n_bytes);

/* The longest line, and the columns that the echo of a key such as Ctrl-C takes behind it. */
enum { longest = 400, echo = 2 };

/* What the line tells. Never waited for long. */
static pthread_mutex_t words = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t closing;
static int is_open = 0;
static struct timespec begin;
static char name[longest], work[longest];
static int has_seconds, is_log;

/* Draws. It takes no signals, so that a handler never finds itself inside of a drawing. */
static pthread_t painter;

/* Whoever draws or prints has the screen. A terminal that takes nothing more keeps him, but not the work. */
static pthread_mutex_t screen = PTHREAD_MUTEX_INITIALIZER;
static atomic_int width, is_abandoned;

/* Whether the terminal is that of another program now. */
static int is_elsewhere(void)
{
    pid_t group = tcgetpgrp(STDERR_FILENO);
    return group >= 0 && group != getpgrp();
}

/* Whether the terminal takes a line without delay. */
static int is_ready(void)
{
    struct pollfd terminal = {.fd = STDERR_FILENO, .events = POLLOUT};
    return poll(&terminal, 1, 0) == 1 && terminal.revents == POLLOUT;
}

/* Writes a text in the place of the line. A terminal that went away is no fault. */
static void replace(const char *text, int n_columns)
{
    char line[2*longest + 2*echo + 2] = "\r";
    int n = 1, n_before = atomic_load(&width);
    if (n_before > 0) {
        memset(line + n, ' ', (size_t)n_before);
        n += n_before;
        line[n++] = '\r';
    }
    memcpy(line + n, text, (size_t)n_columns);
    atomic_store(&width, n_columns > 0 ? n_columns + echo : 0);
    amontons_write(STDERR_FILENO, line, n + n_columns);
}

/* Puts together the line as it is after some seconds, cut to the width of the terminal, between two characters. Returns
   its length, 0 where there is nothing to tell. A log always has the seconds, for it shows no clock. */
static int compose(char *line, long seconds)
{
    struct winsize size;
    int n = 0, n_most = longest - 1;

    pthread_mutex_lock(&words);
    if (work[0])
        n = has_seconds || is_log ? snprintf(line, longest, "%s: %s, %ld s", name, work, seconds)
            : snprintf(line, longest, "%s: %s", name, work);
    pthread_mutex_unlock(&words);
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > echo && size.ws_col - echo <= n_most)
        n_most = size.ws_col - echo - 1;
    if (n > n_most)
        for (n = n_most; n > 0 && ((unsigned char)line[n] & 0xc0) == 0x80; n--)
            ;
    return n;
}

/* Writes the line as it is after some seconds to the log. One that takes no more is no fault. */
static void write_to_log(long seconds)
{
    char line[longest + 1];
    pthread_mutex_lock(&screen);
    int n = compose(line, seconds);
    line[n++] = '\n';
    if (n > 1 && !atomic_load(&is_abandoned))
        amontons_write(STDERR_FILENO, line, n);
    pthread_mutex_unlock(&screen);
}

/* Draws the line as it is after some seconds. */
static void draw(long seconds)
{
    char line[longest];
    pthread_mutex_lock(&screen);
    int n = compose(line, seconds);
    if (n > 0 && !is_elsewhere() && is_ready() && !atomic_load(&is_abandoned))
        replace(line, n);
    pthread_mutex_unlock(&screen);
}

/* Waits until the line is a number of seconds old. Returns whether it is still open. */
static int wait_until(long seconds)
{
    struct timespec end = begin;
    end.tv_sec += seconds;
    pthread_mutex_lock(&words);
    while (is_open && pthread_cond_timedwait(&closing, &words, &end) == 0)
        ;
    int answer = is_open;
    pthread_mutex_unlock(&words);
    return answer;
}

/* Draws the line once a second until it is closed; in a log, after 1, 2, 4 ... 64 seconds and each minute from then
   on. */
static void *paint(void *nothing)
{
    long seconds = 0, due = 1;
    while (wait_until(seconds + 1)) {
        struct timespec now;
        clock_gettime(CLOCK_MONOTONIC, &now);
        seconds = now.tv_sec - begin.tv_sec - (now.tv_nsec < begin.tv_nsec);
        if (!is_log)
            draw(seconds);
        else if (seconds >= due)
            write_to_log(seconds);
        while (due <= seconds)
            due += due < 60 ? due : 60;
    }
    return nothing;
}

/* Starts to paint. Returns 0 or the system's error number. */
static int start_painter(void)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int code = pthread_create(&painter, NULL, paint, NULL);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return code;
}

/* Opens the line of a case, if standard error is a terminal or a log is to have lines: what is noted from now on will
   be on it. Where there is no thread to be had there is no line. */
void amontons_open_line(const char *text, int has_log)
{
    pthread_condattr_t monotonic;
    is_log = !isatty(STDERR_FILENO);
    if (is_open || (is_log && !has_log))
        return;
    snprintf(name, sizeof name, "%s", text);
    work[0] = '\0';
    clock_gettime(CLOCK_MONOTONIC, &begin);
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(&closing, &monotonic);
    pthread_condattr_destroy(&monotonic);
    is_open = 1;
    if (start_painter() == 0)
        return;
    is_open = 0;
    pthread_cond_destroy(&closing);
}

/* Notes what is done from now on, for the line if there is one; the seconds since it was opened may follow. */
void amontons_note_work(const char *text, int is_timed)
{
    pthread_mutex_lock(&words);
    if (is_open) {
        snprintf(work, sizeof work, "%s", text);
        has_seconds = is_timed;
    }
    pthread_mutex_unlock(&words);
}

/* Removes the line, if there is one on the screen. */
static void erase(void)
{
    if (atomic_load(&width) > 0 && !is_elsewhere())
        replace("", 0);
}

/* Closes the line, if there is one, and removes it. */
void amontons_close_line(void)
{
    pthread_mutex_lock(&words);
    int was_open = is_open;
    is_open = 0;
    if (was_open)
        pthread_cond_signal(&closing);
    pthread_mutex_unlock(&words);
    if (!was_open)
        return;
    pthread_join(painter, NULL);
    pthread_cond_destroy(&closing);
    erase();
}

/* Removes the line for a signal that ends the process, and lets no other be drawn. For its handler: takes no lock and
   waits for nobody. */
void amontons_abandon_line(void)
{
    atomic_store(&is_abandoned, 1);
    if (is_ready())
        erase();
}

/* Prints a text, all of it, in the place of the line, which comes back with the next work that is noted. Returns 0 or
   the system's error number. */
int amontons_print(int file, const char *text, long n_bytes)
{
    pthread_mutex_lock(&screen);
    pthread_mutex_lock(&words);
    work[0] = '\0';
    pthread_mutex_unlock(&words);
    erase();
    int code = amontons_write(file, text, n_bytes);
    pthread_mutex_unlock(&screen);
    return code;
}
