/* A thin layer over UMFPACK: its objects stay on this side. */
#include <stdlib.h>
#include <umfpack.h>

/* What a call reports; the Fortran side has the same numbers. */
enum { done = 0, singular = 1, out_of_memory = 2 };

/* Frees a factorization; a null handle is none. */
void amontons_umfpack_free(void *numeric)
{
    if (numeric)
        umfpack_di_free_numeric(&numeric);
}

/* Factorizes a compressed matrix. On success the handle owns the factors. */
static int factorize(int n, const int *start, const int *index, const double *value, void **numeric)
{
    void *symbolic = NULL;
    int code = umfpack_di_symbolic(n, n, start, index, value, &symbolic, NULL, NULL);
    if (code == UMFPACK_OK)
        code = umfpack_di_numeric(start, index, value, symbolic, numeric, NULL, NULL);
    umfpack_di_free_symbolic(&symbolic);
    return code == UMFPACK_OK ? done : code == UMFPACK_WARNING_singular_matrix ? singular : out_of_memory;
}

/* Factorizes the n x n matrix of some entries, counted from 0, in any order; entries of one place add up. */
int amontons_umfpack_factorize(int n, int n_entries, const int *row, const int *column, const double *value,
                               void **numeric)
{
    int code = out_of_memory;
    size_t room = n_entries > 0 ? (size_t)n_entries : 1;
    int *start = malloc(((size_t)n + 1) * sizeof *start), *index = malloc(room * sizeof *index);
    double *sum = malloc(room * sizeof *sum);
    if (start && index && sum
        && umfpack_di_triplet_to_col(n, n, n_entries, row, column, value, start, index, sum, NULL) == UMFPACK_OK)
        code = factorize(n, start, index, sum, numeric);
    free(start);
    free(index);
    free(sum);
    return code;
}

/* Solves A^T x = b with the factors of A, without refinement, which would need A. */
int amontons_umfpack_solve_transposed(void *numeric, const double *right, double *solution)
{
    double control[UMFPACK_CONTROL];
    umfpack_di_defaults(control);
    control[UMFPACK_IRSTEP] = 0;
    return umfpack_di_solve(UMFPACK_At, NULL, NULL, NULL, solution, right, numeric, control, NULL) == UMFPACK_OK
               ? done
               : singular;
}
