/* Makes the processor one that OpenBLAS does not know: loaded before the program, with OPENBLAS_CORETYPE=Prescott, it
   removes that variable after OpenBLAS has read it. */
#define _POSIX_C_SOURCE 200112L
#include <stdlib.h>

extern int openblas_get_num_threads(void); /* makes the loader start OpenBLAS first */

__attribute__((constructor)) static void forget(void)
{
    if (openblas_get_num_threads() > 0)
        unsetenv("OPENBLAS_CORETYPE");
}
