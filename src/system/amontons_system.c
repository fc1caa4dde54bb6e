/* The few system calls that Fortran has no name for. */
#define _XOPEN_SOURCE 700

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

/* The directories that this process has made, by their names from the root on. */
static char **made = NULL;
static size_t n_made = 0;

/* Removes the directories that this process has made and that are empty: a run that fails leaves none of them. */
static void remove_empty_directories(void)
{
    while (n_made > 0)
        rmdir(made[--n_made]);
}

/* Makes a directory, which is noted. Returns 0 or the system's error number. */
static int make_and_note(const char *path)
{
    if (mkdir(path, 0777) != 0)
        return errno;
    char **longer = realloc(made, (n_made + 1) * sizeof *made);
    if (!longer)
        return 0;
    if (!made)
        atexit(remove_empty_directories);
    made = longer;
    made[n_made] = realpath(path, NULL);
    n_made += made[n_made] != NULL;
    return 0;
}

/* Makes a directory and its parents; at the end of the process those that are still empty are removed. Returns 0 when
   it exists afterwards, the system's error number otherwise. */
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
        int code = make_and_note(parent);
        if (code != 0 && code != EEXIST)
            return code;
    }
    int code = make_and_note(path);
    if (code != EEXIST)
        return code;
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

/* Renames a file. Of two names in one directory that is open, when its number is not -1, only the last parts count: the
   directory may have got another name itself. Returns 0 or the system's error number. */
int amontons_rename(int directory, const char *from, const char *to)
{
    if (directory < 0)
        return rename(from, to) == 0 ? 0 : errno;
    const char *from_slash = strrchr(from, '/'), *to_slash = strrchr(to, '/');
    return renameat(directory, from_slash ? from_slash + 1 : from, directory, to_slash ? to_slash + 1 : to) == 0 ? 0
        : errno;
}

/* Finds the names in a directory, in the order of their bytes, each ended by a zero, one behind the other. Returns 0 or
   the system's error number. The caller takes the names with amontons_take_names. */
int amontons_list_directory(const char *path, char **names, int *n_names, long *length)
{
    struct dirent **entries;
    int n = scandir(path, &entries, NULL, alphasort);
    if (n < 0)
        return errno;
    size_t size = 0;
    for (int i = 0; i < n; i++)
        size += strlen(entries[i]->d_name) + 1;
    char *place = *names = malloc(size + 1);
    for (int i = 0; i < n; i++) {
        if (place) {
            strcpy(place, entries[i]->d_name);
            place += strlen(place) + 1;
        }
        free(entries[i]);
    }
    free(entries);
    *n_names = n;
    *length = (long)size;
    return *names ? 0 : ENOMEM;
}

/* Copies the names and gives their memory up. */
void amontons_take_names(char *names, char *text, long length)
{
    memcpy(text, names, (size_t)length);
    free(names);
}

/* Puts the system's words for an error number into a text of a given size, ended by a zero. */
void amontons_error_text(int code, char *text, int size)
{
    snprintf(text, (size_t)size, "%s", strerror(code));
}

/* Cuts a file to a number of bytes. Returns 0 or the system's error number. */
int amontons_truncate(const char *path, long n_bytes)
{
    return truncate(path, (off_t)n_bytes) == 0 ? 0 : errno;
}

/* Writes a text to an open file, all of it. Returns 0 or the system's error number. */
int amontons_write(int file, const char *text, long n_bytes)
{
    while (n_bytes > 0) {
        ssize_t n = write(file, text, (size_t)n_bytes);
        if (n < 0 && errno != EINTR)
            return errno;
        if (n > 0) {
            text += n;
            n_bytes -= n;
        }
    }
    return 0;
}

/* Appends bytes to a file, or to a new one that nothing may have the name of, and returns when they are on the disk. A
   link is not followed. Returns 0 or the system's error number. */
int amontons_append(const char *path, int is_new, const char *bytes, long n_bytes)
{
    int file = open(path, O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW | (is_new ? O_CREAT | O_EXCL : 0), 0666);
    if (file < 0)
        return errno;
    int code = amontons_write(file, bytes, n_bytes);
    /* Devices and some file systems know no synchronisation. */
    if (code == 0 && fsync(file) != 0 && errno != EINVAL && errno != EROFS)
        code = errno;
    if (close(file) != 0 && code == 0)
        code = errno;
    return code;
}

/* Opens a file to read from it. Returns its number, or minus the system's error number. */
int amontons_open_input(const char *path)
{
    /* How long a pipe that nobody writes to is waited for [ms]; then it is empty. */
    enum { patience = 5000 };
    struct stat status;

    int file = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0)
        return -errno;
    if (fstat(file, &status) == 0 && S_ISFIFO(status.st_mode)) {
        struct pollfd pipe = {.fd = file, .events = POLLIN};
        poll(&pipe, 1, patience);
    }
    return file;
}

/* Closes an open file, if there is one. That of a lock ends the lock. */
void amontons_close_file(int file)
{
    if (file >= 0)
        close(file);
}

/* Reads from an open file what there is, up to a number of bytes. Returns how many, 0 at the end, or minus the system's
   error number. */
long amontons_read_input(int file, char *text, long n_bytes)
{
    for (;;) {
        ssize_t n = read(file, text, (size_t)n_bytes);
        if (n >= 0)
            return (long)n;
        if (errno == EAGAIN) {
            struct pollfd source = {.fd = file, .events = POLLIN};
            poll(&source, 1, -1);
        } else if (errno != EINTR) {
            return -errno;
        }
    }
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

/* The most memory this process ever held, in kibibytes; 0 where the system does not tell. That of getrusage begins with
   what the process that started this one held. */
long long amontons_peak_memory(void)
{
    long long peak = number_after("/proc/self/status", "VmHWM:");
    return peak > 0 ? peak : 0;
}

/* The memory this process can still get, in kibibytes: what the system has to give and what the limit on the address
   space leaves; -1 where neither is known. */
long long amontons_available_memory(void)
{
    long long available = number_after("/proc/meminfo", "MemAvailable:");
    long long used = number_after("/proc/self/status", "VmSize:");
    struct rlimit limit;
    if (used >= 0 && getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        /* A fifth is for the results and for the heaps of threads, which reserve more addresses than they use. */
        long long left = ((long long)(limit.rlim_cur / 1024) - used) / 5 * 4;
        if (left < 0)
            left = 0;
        if (available < 0 || left < available)
            available = left;
    }
    return available;
}

/* Has large arrays go back to the system when they are freed. Left to itself glibc raises its threshold to 32 MB as
   they are, and keeps holes that nothing fits in: a tenth of the peak on half a million unknowns. What is free at the
   end of the heap stays for the arrays of the next case, up to those of half a million unknowns: new pages take the
   system longer than the work on them. */
void amontons_return_large_arrays(void)
{
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 10000000);
    mallopt(M_TRIM_THRESHOLD, 100000000);
#endif
}

/* Gives memory that was freed back to the system, where the C library keeps it for later. */
void amontons_return_memory(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}
