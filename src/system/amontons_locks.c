/* Locks between processes. They die with the process that holds them, however it ends. */
#define _DEFAULT_SOURCE

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* What a call reports of a lock that another process has; the Fortran side has the same number. */
enum { taken = -1 };

/* Locks an open file unless somebody else has. A file system without locks is taken for one where nobody has. */
static int try_lock(int file)
{
    int code;
    do
        code = flock(file, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
    while (code == EINTR);
    return code == EWOULDBLOCK ? taken : 0;
}

/* Whether a name still stands for an open file, and this is a plain one. */
static int is_at(const char *path, int file)
{
    struct stat found, opened;
    return lstat(path, &found) == 0 && fstat(file, &opened) == 0 && S_ISREG(found.st_mode)
        && found.st_dev == opened.st_dev && found.st_ino == opened.st_ino;
}

/* Opens a file, makes it if it is not there, and locks it; a link or anything else that is no plain file is put out of
   the way. Gives the open file; returns 0, `taken` or the system's error number. */
int amontons_lock_path(const char *path, int *lock)
{
    enum { most_attempts = 100 };
    for (int i = 0; i < most_attempts; i++) {
        int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
        if (file < 0 && errno != ELOOP && errno != ENXIO)
            return errno;
        int code = file < 0 ? 0 : try_lock(file);
        /* The process that had the lock may have removed the file just before: then it is another one. */
        if (file >= 0 && code == 0 && is_at(path, file)) {
            *lock = file;
            return 0;
        }
        if (file >= 0) {
            struct stat opened;
            int is_plain = fstat(file, &opened) == 0 && S_ISREG(opened.st_mode);
            close(file);
            if (code != 0)
                return code;
            if (is_plain)
                continue;
        }
        if (unlink(path) != 0 && errno != ENOENT)
            return errno;
    }
    return taken;
}

/* Locks a directory for the short time that files in it change hands. Returns a number for amontons_close_file, -1
   where there is no lock: somebody may keep it who has nothing to do with us, so that it is not waited for for ever. */
int amontons_lock_directory(const char *path)
{
    enum { most_attempts = 2000 };
    static const struct timespec pause = {0, 1000000};
    int file = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (int i = 0; file >= 0 && i < most_attempts; i++) {
        if (try_lock(file) == 0)
            return file;
        nanosleep(&pause, NULL);
    }
    if (file >= 0)
        close(file);
    return -1;
}
