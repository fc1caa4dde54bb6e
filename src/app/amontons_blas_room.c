/* What the BLAS needs of addresses is asked for before it asks itself: where a limit leaves no room (ulimit -v),
   OpenBLAS repeats its request for ever. */
#define _GNU_SOURCE
#include <sched.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>

extern bool amontons_has_blas_room(int n_threads);

/* The status of a system failure; the Fortran side has the same number. */
enum { system_failure = 3 };

/* Ends the program where the BLAS has no room for its work arrays on some threads. Those that OpenBLAS began when it
   was loaded may be asking for theirs: nothing waits for them. */
void amontons_require_blas_room(int n_threads)
{
    static const char sentence[] =
        "amontons: not enough memory: the BLAS needs 128 MiB of addresses for each thread\n";
    if (amontons_has_blas_room(n_threads))
        return;
    (void)!write(STDERR_FILENO, sentence, sizeof sentence - 1);
    _exit(system_failure);
}

/* Returns the number in an environment variable, 0 if there is none. The C library may not be ready for getenv. */
static int number_in(char **environment, const char *name)
{
    size_t length = strlen(name);
    for (; *environment; environment++)
        if (strncmp(*environment, name, length) == 0 && (*environment)[length] == '=') {
            int number = 0;
            const char *digit = *environment + length + 1;
            while (*digit >= '0' && *digit <= '9' && number < 10000)
                number = 10 * number + (*digit++ - '0');
            return number;
        }
    return 0;
}

/* Checks the room for what OpenBLAS takes when it is loaded, the newer versions at once: a work array for each of its
   threads. They are as many as the first of these variables says that is set, and not more than the processors. */
static void require_room_for_loading(int n_arguments, char **arguments, char **environment)
{
    static const char *const variables[] = {"OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS"};
    (void)n_arguments, (void)arguments;
    cpu_set_t processors;
    int n_threads = sched_getaffinity(0, sizeof processors, &processors) == 0 ? CPU_COUNT(&processors) : 1;
    for (size_t i = 0; i < sizeof variables / sizeof *variables; i++) {
        int number = number_in(environment, variables[i]);
        if (number > 0) {
            n_threads = number < n_threads ? number : n_threads;
            break;
        }
    }
    amontons_require_blas_room(n_threads);
}

/* The loader calls what is listed here, in a program only, before the libraries that it is linked to begin. */
__attribute__((section(".preinit_array"), used)) static void (*const before_libraries)(int, char **, char **) =
    require_room_for_loading;
