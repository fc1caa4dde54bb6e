/* What the C interface has in C: its call for problems of the plane, and what surrounds each call. Calls from several
 * threads wait for each other, the BLAS has one thread while one runs, and a process may fork between them.
 *
 * The BLAS of the caller may be ours, too. Threads of its own gain it little here, and on a busy machine the one that
 * has no core keeps the others waiting. A fork leaves a child with one thread: OpenBLAS ends its own threads before;
 * those of OpenMP would be waited for in vain, so they are ended here, and parent and child start others when they need
 * them.
 */
#define _POSIX_C_SOURCE 200112L
#include <pthread.h>
#include "amontons.h"

extern int amontons_blas_threads(void);
extern void amontons_set_blas_threads(int n_threads);
extern int omp_pause_resource_all(int kind) __attribute__((weak));
extern void omp_set_num_threads(int n_threads);

static pthread_mutex_t call_lock = PTHREAD_MUTEX_INITIALIZER;
static int n_blas_threads; /* those that the BLAS had before the call */
static int has_lost_threads; /* whether a child would wait for threads that it does not have */

/* Waits until no other call runs. */
void amontons_begin_call(void)
{
    pthread_mutex_lock(&call_lock);
    n_blas_threads = amontons_blas_threads();
    amontons_set_blas_threads(1);
}

/* Lets the next call run. */
void amontons_end_call(void)
{
    amontons_set_blas_threads(n_blas_threads);
    pthread_mutex_unlock(&call_lock);
}

/* Ends the threads of OpenMP that belong to the one that forks. */
static void prepare_fork(void)
{
    const int soft = 1;
    has_lost_threads = !omp_pause_resource_all || omp_pause_resource_all(soft) != 0;
}

/* In the child, which has none of the threads that may have been within a call. */
static void begin_child(void)
{
    pthread_mutex_init(&call_lock, NULL);
    if (has_lost_threads)
        omp_set_num_threads(1);
}

__attribute__((constructor)) static void watch_forks(void)
{
    pthread_atfork(prepare_fork, NULL, begin_child);
}

int amontons_solve_reduced_problem(
    int n_contacts, const double *w, const double *q, const double *mu, const char *method, double tolerance,
    int max_iterations, double *r, double *u, int *status, double *residual, int *n_iterations, char *message,
    int message_size)
{
    return amontons_solve_contacts(2, n_contacts, w, q, mu, method, tolerance, max_iterations, r, u, status, residual,
                                   n_iterations, message, message_size);
}
