/* The C interface of Amontons: plane contact with Coulomb friction.
 *
 * No procedure prints, ends the program or keeps anything between calls. Several threads may call; the calls wait for
 * each other, and each has threads of its own inside. Texts end with a zero; those that a procedure writes are cut to
 * the size given with them.
 */
#ifndef AMONTONS_H
#define AMONTONS_H

#ifdef __cplusplus
extern "C" {
#endif

/* What a procedure returns; also the exit status of the program. */
enum {
    AMONTONS_SOLVED = 0,
    AMONTONS_INPUT_REFUSED = 1,     /* a deck, an array or an argument is at fault */
    AMONTONS_NUMERICAL_FAILURE = 2, /* no equilibrium, not positive definite, numbers out of range */
    AMONTONS_SYSTEM_FAILURE = 3,    /* a file cannot be written */
    AMONTONS_NOT_CONVERGED = 4      /* results are there, but not to the tolerance, or their check failed */
};

/* Status of a contact. */
enum { AMONTONS_OPEN = 1, AMONTONS_STICK = 2, AMONTONS_SLIP_PLUS = 3, AMONTONS_SLIP_MINUS = 4 };

/* The version, "major.minor.patch". */
const char *amontons_version_text(void);

/* Sets the number of threads (at least 1) of the loops inside, and one thread for the BLAS. To be called, if at all,
   before any other procedure, while no other thread runs. */
void amontons_set_threads(int n_threads);

/* Solves a reduced problem of m contacts with friction: forces r and displacements u with

       u = W r + q,   0 <= u_N _|_ r_N >= 0,   |r_T| <= mu r_N,   r_T opposes u_T.

   The unknowns of a contact stand together, the normal one first: u_N1, u_T1, u_N2, u_T2, ... Returns one of the codes
   above; r, u, status, residual and n_iterations are set if it is 0 or 4. */
int amontons_solve_reduced_problem(
    int n_contacts,     /* number m of contacts */
    const double *w,    /* W, symmetric and positive semidefinite, column by column (2m x 2m) */
    const double *q,    /* u without forces (2m) */
    const double *mu,   /* coefficients of friction, at least 0 (m) */
    const char *method, /* a word for `&solver method` in a deck; NULL for "auto" */
    double tolerance,   /* residual that counts as solved; 0 for 1e-10 */
    int max_iterations, /* most iterations; 0 for 1000 */
    double *r,          /* forces (2m) */
    double *u,          /* displacements or velocities (2m) */
    int *status,        /* status of each contact (m) */
    double *residual,   /* residual reached, free of units */
    int *n_iterations,  /* number of iterations done */
    char *message,      /* what went wrong, in a sentence; empty if nothing did */
    int message_size);  /* room in message */

/* Does what the program does with one deck: solves it and writes its files. Returns the program's exit status. */
int amontons_solve_deck(
    const char *deck,      /* name of the deck */
    const char *directory, /* where the files go; made if it is not there */
    char *name,            /* name of the case: its files are directory/name.lst, ...; empty if the deck is refused */
    int name_size,         /* room in name */
    char *message,         /* what went wrong, one line per fault; empty if nothing did */
    int message_size);     /* room in message */

/* Does the same with a deck that is a text. */
int amontons_solve_deck_text(
    const char *text,      /* the deck */
    const char *deck,      /* name of the deck in messages; names of files in it are seen from the folder of this name,
                              and the case has its name unless `&case` gives one */
    const char *settings,  /* lines `GROUP.KEY=VALUE` or `GROUP(2).KEY=VALUE`, which take the place of what the deck
                              says, as the option --set of the program does; empty for none */
    const char *directory, /* as above, and so are the others */
    char *name,
    int name_size,
    char *message,
    int message_size);

#ifdef __cplusplus
}
#endif

#endif
