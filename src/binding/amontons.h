/* The C interface of Amontons: contact with Coulomb friction.
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

/* What a procedure returns; also the exit status of the program, but that it ends with 2 without equilibrium, too. */
enum {
    AMONTONS_SOLVED = 0,
    AMONTONS_INPUT_REFUSED = 1,     /* a deck, an array or an argument is at fault */
    AMONTONS_NUMERICAL_FAILURE = 2, /* not positive definite, numbers out of range */
    AMONTONS_SYSTEM_FAILURE = 3,    /* a file cannot be written */
    AMONTONS_NOT_CONVERGED = 4,     /* results are there, but not to the tolerance, or their check failed */
    AMONTONS_NO_EQUILIBRIUM = 6     /* contact and friction cannot balance the loads, or nothing holds the body */
};

/* Status of a contact. */
enum {
    AMONTONS_OPEN = 1,
    AMONTONS_STICK = 2,
    AMONTONS_SLIP_PLUS = 3,  /* in the plane: along the tangent */
    AMONTONS_SLIP_MINUS = 4, /* in the plane: against it */
    AMONTONS_SLIP = 5        /* in space: along the tangential part of u */
};

/* The version, "major.minor.patch". */
const char *amontons_version_text(void);

/* Sets the number of threads (at least 1) of the loops inside, and one thread for the BLAS. To be called, if at all,
   before any other procedure, while no other thread runs. */
void amontons_set_threads(int n_threads);

/* Solves a reduced problem of m contacts with friction: forces r and displacements u with

       u = W r + q,   0 <= u_N _|_ r_N >= 0,   |r_T| <= mu r_N,   r_T opposes u_T.

   The unknowns of a contact are adjacent, the normal one first: u_N1, u_T1, u_N2, u_T2, ... in the plane, two
   tangential ones in space, along any two tangents at right angles. Returns one of the codes above; r, u, status,
   residual and n_iterations are set if it is 0 or 4. */
int amontons_solve_contacts(
    int dimension,      /* number d of unknowns of a contact: 2 in the plane, 3 in space */
    int n_contacts,     /* number m of contacts */
    const double *w,    /* W, symmetric and positive semidefinite, column by column (dm x dm) */
    const double *q,    /* u without forces (dm) */
    const double *mu,   /* coefficients of friction, at least 0 (m) */
    const char *method, /* a word for `&solver method` in a deck; NULL for "auto" */
    double tolerance,   /* residual that counts as solved; 0 for 1e-10 */
    int max_iterations, /* most iterations; 0 for 1000 */
    double *r,          /* forces (dm) */
    double *u,          /* displacements or velocities (dm) */
    int *status,        /* status of each contact (m) */
    double *residual,   /* residual reached, free of units */
    int *n_iterations,  /* number of iterations done */
    char *message,      /* what went wrong, in a sentence; empty if nothing did */
    int message_size);  /* room in message */

/* Solves a reduced problem in the plane: `amontons_solve_contacts` with the dimension 2. */
int amontons_solve_reduced_problem(
    int n_contacts, const double *w, const double *q, const double *mu, const char *method, double tolerance,
    int max_iterations, double *r, double *u, int *status, double *residual, int *n_iterations, char *message,
    int message_size);

/* Does what the program does with one deck: solves it and writes its files. Returns one of
   the codes above. */
int amontons_solve_deck(
    const char *deck,      /* name of the deck */
    const char *directory, /* where the files go; made if it is not there */
    char *name,            /* name of the case: its files are directory/name.lst, ...; empty if the deck is refused */
    int name_size,         /* room in name */
    char *message,         /* what went wrong, one line per fault; empty if nothing did */
    int message_size);     /* room in message */

/* Solves a deck given as a text, and writes its files. Returns the program's exit status. */
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

/* A body whose loads, supports, obstacles and friction the caller changes step by step. Apart from a stepper's own body
   nothing is kept between calls: each step has the state before it in and the state after it out. */
typedef struct amontons_stepper amontons_stepper;

/* Makes a stepper of a deck with &history, as a text. Its &steps say what changes; their values, the times and the keys
   that choose the steps do not matter. Returns one of the codes above, and a stepper if it is 0. */
int amontons_new_stepper(
    const char *text,           /* the deck, and so on as for `amontons_solve_deck_text` */
    const char *deck,
    const char *settings,
    amontons_stepper **stepper, /* the stepper, for `amontons_free_stepper` in the end; NULL if there is none */
    int *n_changes,             /* how many numbers change: 1 for a &steps, 3 for that of an obstacle */
    int *n_points,              /* number m of contact points */
    int *n_state,               /* how many numbers a state has: 7 + n_changes + 11m, 3m more for
                                   a twisted body, and one for each motion that the deck may
                                   lock */
    char *columns,              /* names of the numbers of a step, commas between them: pseudo-time, changes, and what
                                   NAME.history.csv has behind them up to `iterations` */
    int columns_size,           /* room in columns */
    char *message,
    int message_size);

/* Takes a step. Returns one of the codes above; the state, the numbers and the statuses are set if it is 0 or 4. With 4
   the state is no solution: a shorter step from the state before may be one. The state before must be in equilibrium
   with the body and with what acted on it at its time: that of another body is refused with 1.

   A state of zeros is the body at rest. Any other holds the number of steps; the changes; the time; the work of loads,
   supports and obstacles; residual and iterations; where each motion was locked, huge before that; then for all
   points in turn their statuses, normal forces, tangential forces, normal displacements, tangential
   displacements, anchors (what the slip of the step counts from), accumulated slips, dissipations, sums of normal force
   times slip, what was added to their gaps, depths worn. In a twisted body all tangential forces, displacements and
   anchors are followed by those around the axis. */
int amontons_step(
    amontons_stepper *stepper,
    double time,           /* the time at the end of the step */
    int n_changes,         /* as `amontons_new_stepper` gave it, and so are n_state and n_points */
    const double *changes, /* the numbers of all &steps at the end of the step, in the order of the deck */
    int n_state,
    const double *before,  /* the state at the beginning of the step */
    double *after,         /* the state at its end; not the same array */
    int n_columns,         /* room in columns */
    double *columns,       /* the numbers of the step */
    int n_points,
    const double *gap,     /* what is added to the gap of each contact point in this step (m); NULL for nothing */
    int *status,           /* status of each contact point (m) */
    char *message,
    int message_size);

/* Writes the places of the contact points. Returns the number of their tangents: 1, in a twisted body and a solid 2. */
int amontons_stepper_points(
    amontons_stepper *stepper,
    int n_points,    /* as `amontons_new_stepper` gave it */
    double *points); /* x of all points, y of all, then the lengths and the areas that belong to each (4m) */

/* Writes the places of the contact points again, of a solid with z, and the directions of their numbers in a state:
   the normal, towards the obstacle, and the tangents. Returns the number of coordinates: 2, of a solid 3. */
int amontons_stepper_frames(
    amontons_stepper *stepper,
    int n_points,    /* as `amontons_new_stepper` gave it */
    double *frames); /* of each point x, y, z, normal, first tangent and second tangent; 0 what it has not (12m) */

/* Frees a stepper. */
void amontons_free_stepper(amontons_stepper *stepper);

#ifdef __cplusplus
}
#endif

#endif
