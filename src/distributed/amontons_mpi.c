/* The few calls of MPI that the program makes, and nothing of its types: Fortran sees numbers and bytes. */
#define _POSIX_C_SOURCE 200809L
#include <mpi.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

/* MPI counts in int: longer messages go in parts. */
enum { longest = 1 << 30, message_tag = 1 };

/* Starts MPI where the program was started by mpiexec, srun or the like. Alone it is the program without MPI. */
int amontons_mpi_begin(int *rank, int *size)
{
    static const char *const launchers[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};
    int is_launched = 0, provided;
    for (size_t i = 0; i < sizeof launchers/sizeof *launchers; ++i)
        is_launched = is_launched || getenv(launchers[i]);
    *rank = 0;
    *size = 1;
    if (!is_launched || MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &provided) != MPI_SUCCESS)
        return 0;
    MPI_Comm_rank(MPI_COMM_WORLD, rank);
    MPI_Comm_size(MPI_COMM_WORLD, size);
    return 1;
}

/* Ends MPI. */
void amontons_mpi_end(void)
{
    MPI_Finalize();
}

/* Rank 0 gives an order to all others, which sleep until it comes: what rank 0 does meanwhile may need their cores. */
void amontons_mpi_order(int *order, int is_giver)
{
    MPI_Request request;
    int is_here = 0;
    struct timespec pause = {0, 20000};
    MPI_Ibcast(order, 1, MPI_INT, 0, MPI_COMM_WORLD, &request);
    MPI_Test(&request, &is_here, MPI_STATUS_IGNORE);
    while (!is_here) {
        if (!is_giver) {
            nanosleep(&pause, NULL);
            if (pause.tv_nsec < 1000000)
                pause.tv_nsec *= 2;
        }
        MPI_Test(&request, &is_here, MPI_STATUS_IGNORE);
    }
}

/* Passes bytes: to the peer or from it, or, where the peer is negative, from rank 0 to all others. */
void amontons_mpi_pass(void *bytes, int64_t n, int peer, int is_sender)
{
    for (char *at = bytes; n > 0; at += longest, n -= longest) {
        int size = (int)(n < longest ? n : longest);
        if (peer < 0)
            MPI_Bcast(at, size, MPI_BYTE, 0, MPI_COMM_WORLD);
        else if (is_sender)
            MPI_Send(at, size, MPI_BYTE, peer, message_tag, MPI_COMM_WORLD);
        else
            MPI_Recv(at, size, MPI_BYTE, peer, message_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    }
}

/* The least of a number over all ranks. */
int amontons_mpi_least(int number)
{
    int least;
    MPI_Allreduce(&number, &least, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    return least;
}

/* The sum of a number over the ranks that share the memory of this one. */
double amontons_mpi_sum_here(double number)
{
    MPI_Comm machine;
    double sum;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    MPI_Allreduce(&number, &sum, 1, MPI_DOUBLE, MPI_SUM, machine);
    MPI_Comm_free(&machine);
    return sum;
}
