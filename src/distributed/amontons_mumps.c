/* A thin layer over MUMPS, a multifrontal factorization on many processes: its structure changes with the version, so
   it does not cross into Fortran. Every procedure here is called on all ranks at the same time. */
#define _DEFAULT_SOURCE
#include <dmumps_c.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* MUMPS's numbers for its jobs, for the whole world of MPI, and for how its Schur complement takes part in a solution:
   forward to the condensed load, or backward from the Schur variables. */
enum { begin = -1, end = -2, analyze = 1, factorize = 2, solve = 3 };
enum { comm_world = -987654 };
enum { forward = 1, backward = 2 };
/* What the work space that MUMPS foresees may lack: its codes, and the most that is added, in percent. */
enum { work_array_short = -9, given_array_short = -11, integer_work_short = -8, most_relaxation = 400 };
enum { million = 1000000 };

/* An instance: MUMPS's structure, and the work array of the factorization, which begins with the factor. */
typedef struct {
    DMUMPS_STRUC_C mumps;
    size_t work_bytes;
} instance_t;

/* What MUMPS reports, as the Fortran side reads it. */
typedef struct {
    int code, detail;
    int64_t n_entries;
    double n_flops, own_mb, largest_mb;
} report_t;

static void run(DMUMPS_STRUC_C *mumps, int job)
{
    mumps->job = job;
    dmumps_c(mumps);
}

/* A count that MUMPS gives in millions where it is too large for an int: then it is negative. */
static int64_t count(MUMPS_INT number)
{
    return number >= 0 ? number : -(int64_t)number*million;
}

static report_t report_of(const DMUMPS_STRUC_C *mumps)
{
    const MUMPS_INT *info = mumps->infog;
    return (report_t){.code = info[0], .detail = info[1], .n_entries = count(info[19]), .n_flops = mumps->rinfog[0],
                      .own_mb = mumps->info[14], .largest_mb = info[15]};
}

/* Puts MUMPS's version into a text. */
void amontons_mumps_text(char *text, int size)
{
    strncpy(text, MUMPS_VERSION, (size_t)size);
}

/* Makes an instance for a symmetric positive definite matrix, silent; NULL if memory ran out. */
void *amontons_mumps_new(void)
{
    instance_t *instance = calloc(1, sizeof *instance);
    if (!instance)
        return NULL;
    DMUMPS_STRUC_C *mumps = &instance->mumps;
    mumps->comm_fortran = comm_world;
    mumps->par = 1;
    mumps->sym = 1;
    run(mumps, begin);
    memset(mumps->icntl, 0, 4*sizeof *mumps->icntl);
    return instance;
}

/* Frees the work array. */
static void free_work(instance_t *instance)
{
    if (instance->work_bytes > 0)
        munmap(instance->mumps.wk_user, instance->work_bytes);
    instance->work_bytes = 0;
    instance->mumps.wk_user = NULL;
    instance->mumps.lwk_user = 0;
}

/* Allocates the work array as large as MUMPS foresees and the relaxation says. Only what it writes on takes memory.
   Where the limit on addresses does not allow so much, MUMPS allocates it, and says what it lacks. */
static void new_work(instance_t *instance)
{
    DMUMPS_STRUC_C *mumps = &instance->mumps;
    int64_t millions = count(mumps->info[7])*(100 + mumps->icntl[13])/100/million + 1;
    size_t bytes = (size_t)millions*million*sizeof *mumps->wk_user;
    free_work(instance);
    void *work = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (work == MAP_FAILED)
        return;
    instance->work_bytes = bytes;
    mumps->wk_user = work;
    mumps->lwk_user = -(MUMPS_INT)millions;
}

/* Gives the memory behind the factor back: that of fronts that are done with. */
static void trim_work(instance_t *instance)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    int64_t n_entries = count(instance->mumps.info[8]);
    /* A count in millions may be rounded down. */
    size_t kept = (size_t)(n_entries + (instance->mumps.info[8] < 0 ? million : 0))*sizeof(double);
    kept = (kept + page - 1)/page*page;
    if (kept < instance->work_bytes)
        madvise((char *)instance->mumps.wk_user + kept, instance->work_bytes - kept, MADV_DONTNEED);
}

/* Frees an instance. */
void amontons_mumps_free(void *opaque)
{
    instance_t *instance = opaque;
    run(&instance->mumps, end);
    free_work(instance);
    free(instance);
}

/* Analyzes a matrix whose entries are spread over the ranks; entries at the same place add up. Rank 0 gives the order:
   `position` of each unknown, the Schur variables last. */
void amontons_mumps_analyze(void *opaque, int n, int64_t n_entries, int *row, int *column, int n_schur, int *schur,
                            int *position, report_t *report)
{
    DMUMPS_STRUC_C *mumps = &((instance_t *)opaque)->mumps;
    mumps->n = n;
    mumps->nnz_loc = n_entries;
    mumps->irn_loc = row;
    mumps->jcn_loc = column;
    mumps->size_schur = n_schur;
    mumps->listvar_schur = schur;
    mumps->perm_in = position;
    mumps->icntl[5] = 0;   /* no exchange of columns */
    mumps->icntl[6] = 1;   /* the given order */
    mumps->icntl[7] = 0;   /* no scaling */
    mumps->icntl[13] = 10; /* work space beyond what is foreseen, in percent */
    mumps->icntl[17] = 3;  /* entries on every rank */
    mumps->icntl[18] = n_schur > 0;  /* a Schur complement, whole, on rank 0 */
    mumps->icntl[27] = 1;  /* the analysis on rank 0: with a Schur complement there is no other */
    run(mumps, analyze);
    *report = report_of(mumps);
}

/* Factorizes the matrix; rank 0 gets its Schur complement. Work space that falls short is enlarged. */
void amontons_mumps_factorize(void *opaque, double *value, double *schur, report_t *report)
{
    instance_t *instance = opaque;
    DMUMPS_STRUC_C *mumps = &instance->mumps;
    mumps->a_loc = value;
    mumps->schur = schur;
    do {
        new_work(instance);
        run(mumps, factorize);
        *report = report_of(mumps);
        mumps->icntl[13] *= 2;
    } while ((report->code == work_array_short || report->code == given_array_short
              || report->code == integer_work_short) && mumps->icntl[13] <= most_relaxation);
    if (report->code >= 0)
        trim_work(instance);
}

/* Forgets the matrix, which the caller may free: its factor is all that solutions need. */
void amontons_mumps_drop_matrix(void *opaque)
{
    DMUMPS_STRUC_C *mumps = &((instance_t *)opaque)->mumps;
    mumps->nnz_loc = 0;
    mumps->irn_loc = mumps->jcn_loc = NULL;
    mumps->a_loc = mumps->schur = NULL;
}

/* Forward: rank 0 gives loads on all unknowns and gets them condensed to the Schur variables. Backward, after it: rank
   0 gives the Schur variables and gets all unknowns in the place of the loads. Where there are no Schur variables
   backward is both. */
void amontons_mumps_solve(void *opaque, int is_backward, int n_loads, double *all, double *of_schur, report_t *report)
{
    DMUMPS_STRUC_C *mumps = &((instance_t *)opaque)->mumps;
    mumps->nrhs = n_loads;
    mumps->lrhs = mumps->n;
    mumps->lredrhs = mumps->size_schur;
    mumps->rhs = all;
    mumps->redrhs = of_schur;
    mumps->icntl[25] = mumps->size_schur == 0 ? 0 : is_backward ? backward : forward;
    run(mumps, solve);
    *report = report_of(mumps);
}
