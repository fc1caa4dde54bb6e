/* A thin layer over CHOLMOD and CAMD: their structures change with the version, so none crosses into Fortran. */
#include <camd.h>
#include <cholmod.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* What a call reports; the Fortran side has the same numbers. */
enum { done = 0, not_positive_definite = 1, out_of_memory = 2 };

/* Everything that belongs to one factorization; opaque to Fortran. */
typedef struct {
    cholmod_common common;
    cholmod_factor *factor;
} handle_t;

/* The arrays of a supernodal factor, as the Fortran side reads them. Indices count from 0. Supernode k has the columns
   column[k] to column[k+1]-1; its rows are row[row_start[k]] to row[row_start[k+1]-1], its own columns first; its dense
   block starts at value[value_start[k]]. */
typedef struct {
    int64_t n_supernodes, n_entries;
    const int64_t *column, *row_start, *value_start, *row;
    const double *value;
} supernodes_t;

/* Puts the versions of SuiteSparse and of CHOLMOD into a text. */
void amontons_suitesparse_text(char *text, int size)
{
    int suite[3], cholmod[3];
    SuiteSparse_version(suite);
    cholmod_l_version(cholmod);
    snprintf(text, (size_t)size, "%d.%d.%d, CHOLMOD %d.%d.%d", suite[0], suite[1], suite[2], cholmod[0], cholmod[1],
             cholmod[2]);
}

/* Orders a graph by approximate minimum degree, the members of constraint set 0 before those of set 1. */
int amontons_camd_order(int64_t n, const int64_t *start, const int64_t *neighbor, const int64_t *constraint,
                        int64_t *order)
{
    if (n == 0)
        return done;
    SuiteSparse_long code = camd_l_order(n, start, neighbor, order, NULL, NULL, constraint);
    return code == CAMD_OK || code == CAMD_OK_BUT_JUMBLED ? done : out_of_memory;
}

/* Frees a factorization; a null handle is none. */
void amontons_cholmod_free(void *opaque)
{
    handle_t *handle = opaque;
    if (!handle)
        return;
    cholmod_l_free_factor(&handle->factor, &handle->common);
    cholmod_l_finish(&handle->common);
    free(handle);
}

/* Settings: supernodal L L^T of the matrix in the order it has, silently. */
static void choose(cholmod_common *common)
{
    cholmod_l_start(common);
    common->print = 0;
    common->nmethods = 1;
    common->method[0].ordering = CHOLMOD_NATURAL;
    common->postorder = 0;
    common->supernodal = CHOLMOD_SUPERNODAL;
    common->final_ll = 1;
    common->quick_return_if_not_posdef = 1;
}

/* The matrix as CHOLMOD wants it: its lower triangle by columns, counted from 0, in the order of elimination. */
static cholmod_sparse view_matrix(int64_t n, int64_t *column_start, int64_t *row, double *value)
{
    return (cholmod_sparse){.nrow = (size_t)n, .ncol = (size_t)n, .nzmax = (size_t)column_start[n], .p = column_start,
                            .i = row, .x = value, .stype = -1, .itype = CHOLMOD_LONG, .xtype = CHOLMOD_REAL,
                            .dtype = CHOLMOD_DOUBLE, .sorted = 0, .packed = 1};
}

/* Finds the shape of the factor: how many numbers it will hold, how many more the work on it takes, and how many
   floating-point operations. The handle made here is the caller's to free, whatever happens. */
int amontons_cholmod_analyze(int64_t n, int64_t *column_start, int64_t *row, double *value, void **opaque,
                             int64_t *n_entries, int64_t *n_work_entries, double *n_flops)
{
    handle_t *handle = calloc(1, sizeof *handle);
    if (!handle)
        return out_of_memory;
    *opaque = handle;
    choose(&handle->common);
    cholmod_sparse matrix = view_matrix(n, column_start, row, value);
    handle->factor = cholmod_l_analyze(&matrix, &handle->common);
    cholmod_l_free_work(&handle->common);
    if (!handle->factor)
        return out_of_memory;
    *n_entries = (int64_t)handle->factor->xsize;
    *n_work_entries = (int64_t)handle->factor->maxcsize;
    *n_flops = handle->common.fl;
    return done;
}

/* Factorizes the matrix that was analyzed. On success `supernodes` shows the factor, which the handle owns; if a pivot
   fails, `failed` is its column. */
int amontons_cholmod_factorize(void *opaque, int64_t n, int64_t *column_start, int64_t *row, double *value,
                               supernodes_t *supernodes, int64_t *failed)
{
    handle_t *handle = opaque;
    cholmod_common *common = &handle->common;
    cholmod_factor *factor = handle->factor;
    cholmod_sparse matrix = view_matrix(n, column_start, row, value);
    cholmod_l_factorize(&matrix, factor, common);
    cholmod_l_free_work(common);

    if (common->status == CHOLMOD_NOT_POSDEF) {
        *failed = (int64_t)factor->minor;
        return not_positive_definite;
    }
    if (common->status != CHOLMOD_OK)
        return out_of_memory;
    *supernodes = (supernodes_t){(int64_t)factor->nsuper, (int64_t)factor->xsize, factor->super, factor->pi, factor->px,
                                 factor->s, factor->x};
    return done;
}
