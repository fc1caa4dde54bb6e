#!/usr/bin/env bash
# CHOLMOD 3.0.14 (SuiteSparse 5.12): a supernodal factorization with OMP_NUM_THREADS=1. Expected: one thread. Seen:
# four, also on two cores: the number is fixed when the library is compiled, and only omp_set_max_active_levels(0)
# ends it.
# shellcheck source=SCRIPTDIR/helpers/finding.sh
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/helpers/finding.sh"
need gcc-12=12.2.0-14+deb12u1
take libsuitesparse-dev=1:5.12.0+dfsg-2 libcholmod3=1:5.12.0+dfsg-2

cat >main.c <<'SOURCE'
#include <cholmod.h>
#include <stdio.h>

static int n_threads(void)
{
   char line[256];
   int n = 0;
   FILE *file = fopen("/proc/self/status", "r");
   while (fgets(line, sizeof line, file)) sscanf(line, "Threads: %d", &n);
   fclose(file);
   return n;
}

/* The Laplacian of a cube of 24 x 24 x 24 points. */
int main(void)
{
   int m = 24, n = m * m * m, step[3] = {1, m, m * m};
   cholmod_common common;
   cholmod_start(&common);
   common.supernodal = CHOLMOD_SUPERNODAL;
   cholmod_triplet *entries = cholmod_allocate_triplet(n, n, 4 * n, 1, CHOLMOD_REAL, &common);
   int *row = entries->i, *column = entries->j, k = 0;
   double *value = entries->x;
   for (int point = 0; point < n; point++) {
      row[k] = column[k] = point;
      value[k++] = 6.0;
      for (int axis = 0; axis < 3; axis++)
         if (point / step[axis] % m > 0) {
            row[k] = point - step[axis];
            column[k] = point;
            value[k++] = -1.0;
         }
   }
   entries->nnz = k;
   cholmod_sparse *matrix = cholmod_triplet_to_sparse(entries, 0, &common);
   printf("%d\n", n_threads());
   cholmod_factorize(matrix, cholmod_analyze(matrix, &common), &common);
   printf("%d\n", n_threads());
}
SOURCE
gcc-12 main.c -o main \
   -Iroot/usr/include/suitesparse -I/usr/include/suitesparse -Lroot/usr/lib/x86_64-linux-gnu -lcholmod
./main | seen 1 4
