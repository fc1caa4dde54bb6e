/* A thin layer over MUMPS, a multifrontal factorization on many processes: its structure changes with the version, so
   it does not cross into Fortran. Every procedure here is called on all ranks at the same time. */
#include <dmumps_c.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* MUMPS's numbers for its jobs, for the whole world of MPI, and for how its Schur complement takes part in a solution:
   forward to the condensed load, or backward from the Schur variables. */
enum { begin = -1, end = -2, analyze = 1, factorize = 2, solve = 3 };
enum { comm_world = -987654 };
enum { forward = 1, backward = 2 };
/* What the work space that MUMPS foresees may lack: its codes, and the most that is added, in percent. */
enum { work_array_short = -9, integer_work_short = -8, most_relaxation = 400 };

/* What MUMPS reports, as the Fortran side reads it. */
typedef struct {
    int code, detail;
    int64_t n_entries;
    double n_flops, own_mb, largest_mb, sum_mb;
} report_t;

static void run(DMUMPS_STRUC_C *mumps, int job)
{
    mumps->job = job;
    dmumps_c(mumps);
}

/* A count that MUMPS gives in millions where it is too large for an int: then it is negative. */
static int64_t count(MUMPS_INT number)
{
    return number >= 0 ? number : -(int64_t)number*1000000;
}

static report_t report_of(const DMUMPS_STRUC_C *mumps)
{
    const MUMPS_INT *info = mumps->infog;
    return (report_t){.code = info[0], .detail = info[1], .n_entries = count(info[19]), .n_flops = mumps->rinfog[0],
                      .own_mb = mumps->info[14], .largest_mb = info[15], .sum_mb = info[16]};
}

/* Puts MUMPS's version into a text. */
void amontons_mumps_text(char *text, int size)
{
    strncpy(text, MUMPS_VERSION, (size_t)size);
}

/* Makes an instance for a symmetric positive definite matrix, silent; NULL if memory ran out. */
void *amontons_mumps_new(void)
{
    DMUMPS_STRUC_C *mumps = calloc(1, sizeof *mumps);
    if (!mumps)
        return NULL;
    mumps->comm_fortran = comm_world;
    mumps->par = 1;
    mumps->sym = 1;
    run(mumps, begin);
    memset(mumps->icntl, 0, 4*sizeof *mumps->icntl);
    return mumps;
}

/* Frees an instance. */
void amontons_mumps_free(void *opaque)
{
    run(opaque, end);
    free(opaque);
}

/* Analyzes a matrix whose entries are spread over the ranks; entries at the same place add up. Rank 0 gives the order:
   `position` of each unknown, the Schur variables last. */
void amontons_mumps_analyze(void *opaque, int n, int64_t n_entries, int *row, int *column, int n_schur, int *schur,
                            int *position, report_t *report)
{
    DMUMPS_STRUC_C *mumps = opaque;
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
    DMUMPS_STRUC_C *mumps = opaque;
    mumps->a_loc = value;
    mumps->schur = schur;
    do {
        run(mumps, factorize);
        *report = report_of(mumps);
        mumps->icntl[13] *= 2;
    } while ((report->code == work_array_short || report->code == integer_work_short)
             && mumps->icntl[13] <= most_relaxation);
}

/* Forgets the matrix, which the caller may free: its factor is all that solutions need. */
void amontons_mumps_drop_matrix(void *opaque)
{
    DMUMPS_STRUC_C *mumps = opaque;
    mumps->nnz_loc = 0;
    mumps->irn_loc = mumps->jcn_loc = NULL;
    mumps->a_loc = mumps->schur = NULL;
}

/* Forward: rank 0 gives the load on all unknowns and gets it condensed to the Schur variables. Backward, after it: rank
   0 gives the Schur variables and gets all unknowns in the place of the load. Where there are no Schur variables
   backward is both. */
void amontons_mumps_solve(void *opaque, int is_backward, double *all, double *of_schur, report_t *report)
{
    DMUMPS_STRUC_C *mumps = opaque;
    mumps->nrhs = 1;
    mumps->lrhs = mumps->n;
    mumps->lredrhs = mumps->size_schur;
    mumps->rhs = all;
    mumps->redrhs = of_schur;
    mumps->icntl[25] = mumps->size_schur == 0 ? 0 : is_backward ? backward : forward;
    run(mumps, solve);
    *report = report_of(mumps);
}
