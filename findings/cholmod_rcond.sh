#!/usr/bin/env bash
# CHOLMOD 3.0.14 (SuiteSparse 5.12): cholmod_rcond, "a rough estimate" of the reciprocal condition number. Expected:
# some digits of the exponent. Seen: 1, as for the unit matrix, where it is 3e-14 (Moler's matrix of order 20, whose
# factor has a diagonal of ones): only the diagonal of the factor is looked at.
# shellcheck source=SCRIPTDIR/helpers/finding.sh
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/helpers/finding.sh"
need gcc-12=12.2.0-14+deb12u1
take libsuitesparse-dev=1:5.12.0+dfsg-2 libcholmod3=1:5.12.0+dfsg-2

cat >main.c <<'SOURCE'
#include <cholmod.h>
#include <math.h>
#include <stdio.h>

int main(void)
{
   int n = 20, k = 0;
   cholmod_common common;
   cholmod_start(&common);
   common.nmethods = 1;
   common.method[0].ordering = CHOLMOD_NATURAL;
   common.postorder = 0;
   cholmod_triplet *entries = cholmod_allocate_triplet(n, n, n * n, -1, CHOLMOD_REAL, &common);
   int *row = entries->i, *column = entries->j;
   double *value = entries->x;
   for (int j = 0; j < n; j++)
      for (int i = j; i < n; i++) {
         row[k] = i;
         column[k] = j;
         value[k++] = i == j ? i + 1 : j - 1;
      }
   entries->nnz = k;
   cholmod_sparse *matrix = cholmod_triplet_to_sparse(entries, 0, &common);
   cholmod_factor *factor = cholmod_analyze(matrix, &common);
   cholmod_factorize(matrix, factor, &common);

   /* The largest column sum of the matrix, and of its inverse by solutions with unit vectors. */
   double norm = 0.0, norm_of_inverse = 0.0;
   for (int j = 0; j < n; j++) {
      double sum = 0.0, sum_of_inverse = 0.0;
      cholmod_dense *unit = cholmod_zeros(n, 1, CHOLMOD_REAL, &common);
      ((double *)unit->x)[j] = 1.0;
      cholmod_dense *solution = cholmod_solve(CHOLMOD_A, factor, unit, &common);
      for (int i = 0; i < n; i++) {
         sum += fabs(i == j ? i + 1 : (i < j ? i : j) - 1.0);
         sum_of_inverse += fabs(((double *)solution->x)[i]);
      }
      norm = fmax(norm, sum);
      norm_of_inverse = fmax(norm_of_inverse, sum_of_inverse);
   }
   printf("%.1g\n%.1g\n", cholmod_rcond(factor, &common), 1.0 / (norm * norm_of_inverse));
}
SOURCE
gcc-12 main.c -o main \
   -Iroot/usr/include/suitesparse -I/usr/include/suitesparse -Lroot/usr/lib/x86_64-linux-gnu -lcholmod -lm
./main | seen 1 3e-14
