/* What OpenBLAS can be told beyond the BLAS itself. Weak references leave any other BLAS linkable. */
#define _DEFAULT_SOURCE
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>

extern void openblas_set_num_threads(int n_threads) __attribute__((weak));
extern int openblas_get_num_threads(void) __attribute__((weak));
extern int blas_thread_shutdown_(void) __attribute__((weak));
extern char *openblas_get_corename(void) __attribute__((weak));
extern char *openblas_get_config(void) __attribute__((weak));
extern void *blas_memory_alloc(int kind) __attribute__((weak));
extern void blas_memory_free(void *buffer) __attribute__((weak));
extern void gotoblas_dynamic_init(void) __attribute__((weak));
extern void gotoblas_dynamic_quit(void) __attribute__((weak));

/* Sets the number of threads; a BLAS without such a call is left alone. */
void amontons_set_blas_threads(int n_threads)
{
    if (openblas_set_num_threads && openblas_get_num_threads && openblas_get_num_threads() != n_threads)
        openblas_set_num_threads(n_threads);
}

/* Returns the number of threads, 1 for a BLAS that does not tell. */
int amontons_blas_threads(void)
{
    return openblas_get_num_threads ? openblas_get_num_threads() : 1;
}

/* Ends the threads that OpenBLAS starts when it is loaded, and which wait for work with all their might for a while: up
   to 50 ms of processor time. It starts them anew should it be given more than one thread. */
void amontons_end_blas_threads(void)
{
    if (blas_thread_shutdown_)
        blas_thread_shutdown_();
}

/* Bytes of addresses that OpenBLAS takes for the work array of a thread, and the system for its stack. */
static const size_t buffer_size = (size_t)129 << 20, stack_size = (size_t)8 << 20;

/* Returns whether OpenBLAS's work arrays may lack addresses: a limit is set (ulimit -v). */
static bool is_limited(void)
{
    struct rlimit limit;
    return blas_memory_alloc && blas_memory_free && getrlimit(RLIMIT_AS, &limit) == 0
        && limit.rlim_cur != RLIM_INFINITY;
}

/* Returns whether as many bytes of addresses can be had. */
static bool has_room(size_t size)
{
    void *place = mmap(NULL, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (place == MAP_FAILED)
        return false;
    munmap(place, size);
    return true;
}

/* Returns whether the BLAS can work on some threads, of which it begins all but one: where OpenBLAS has no room for a
   work array it asks for it for ever. */
bool amontons_has_blas_room(int n_threads)
{
    return !is_limited() || has_room((size_t)n_threads * (buffer_size + stack_size) - stack_size);
}

/* Makes OpenBLAS take a work array for each of some threads, which it keeps for good, and returns for how many there
   was room, at least 1: it must not need one when matrices have filled the rest. As much again is left for matrices. */
int amontons_take_blas_buffers(int n_threads)
{
    enum { most = 64 };
    void *buffers[most];
    int n = 0;

    if (!is_limited())
        return n_threads;
    do
        buffers[n++] = blas_memory_alloc(0);
    while (n < n_threads && n < most && has_room(2 * buffer_size));
    for (int i = 0; i < n; i++)
        blas_memory_free(buffers[i]);
    return n;
}

/* Returns OpenBLAS's name for the kernels that suit the instructions of this processor, or NULL. */
static const char *suitable_kernels(void)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")
        && __builtin_cpu_supports("avx512vl"))
        return "SkylakeX";
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        return "Haswell";
#endif
    return NULL;
}

/* OpenBLAS knows processors by a list of models, and gives one that is newer than the list its oldest kernels, which
   are four times slower. Where that happened this picks by instructions instead, as setting OPENBLAS_CORETYPE before
   the start would; a value that the user set stands. It runs when the program or library that it is part of is loaded:
   after OpenBLAS, and before anyone can be waiting for a result. */
__attribute__((constructor)) static void choose_blas_kernels(void)
{
    const char *const variable = "OPENBLAS_CORETYPE";
    if (!openblas_get_corename || !gotoblas_dynamic_init || !gotoblas_dynamic_quit || getenv(variable)
        || strcmp(openblas_get_corename(), "Prescott") != 0)
        return;
    const char *kernels = suitable_kernels();
    if (!kernels || setenv(variable, kernels, 1) != 0)
        return;
    gotoblas_dynamic_quit();
    gotoblas_dynamic_init();
    unsetenv(variable);
}

/* Puts the name, version and kernels of OpenBLAS into a text; for any other BLAS the name of the library that the build
   found. OpenBLAS's own text is a list of settings, the version among the first. */
void amontons_blas_text(char *text, int size)
{
    snprintf(text, (size_t)size, "%s", AMONTONS_BLAS);
    if (!openblas_get_config || !openblas_get_corename)
        return;
    const char *config = openblas_get_config(), *name = "OpenBLAS ";
    if (strncmp(config, name, strlen(name)) == 0)
        config += strlen(name);
    snprintf(text, (size_t)size, "%s%.*s, kernels %s", name, (int)strcspn(config, " "), config,
             openblas_get_corename());
}
