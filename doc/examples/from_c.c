/* Solves a reduced problem and a deck from C. Usage: from_c DECK DIRECTORY */
#include <amontons.h>
#include <stdio.h>

/* Two contacts, their unknowns in the order u_N1, u_T1, u_N2, u_T2. */
static int solve_reduced_problem(void)
{
    const double w[] = {2.0, 0.5, 0.5, 0.0,   0.5, 3.0, 0.0, 0.25,   0.5, 0.0, 2.0, -0.5,   0.0, 0.25, -0.5, 3.0};
    const double q[] = {-1.0, -0.5, -2.0, -4.0}, mu[] = {0.75, 0.5};
    double r[4], u[4], residual;
    int status[2], n_iterations;
    char message[1000];

    int code = amontons_solve_reduced_problem(2, w, q, mu, "auto", 0.0, 0, r, u, status, &residual, &n_iterations,
                                              message, sizeof message);
    if (code != AMONTONS_SOLVED) {
        fprintf(stderr, "%s\n", message);
        return code;
    }
    printf("iterations: %d, residual: %.1e\n", n_iterations, residual);
    for (int i = 0; i < 2; i++)
        printf("r = %9.6f %9.6f  u = %9.6f %9.6f  %s\n", r[2 * i], r[2 * i + 1], u[2 * i], u[2 * i + 1],
               status[i] == AMONTONS_OPEN ? "open" : status[i] == AMONTONS_STICK ? "stick" : "slip");
    return code;
}

int main(int n_arguments, char **arguments)
{
    char name[256], message[4000];

    if (n_arguments != 3) {
        fprintf(stderr, "usage: %s DECK DIRECTORY\n", arguments[0]);
        return AMONTONS_INPUT_REFUSED;
    }
    printf("Amontons %s\n", amontons_version_text());
    int code = solve_reduced_problem();
    if (code != AMONTONS_SOLVED)
        return code;
    code = amontons_solve_deck(arguments[1], arguments[2], name, sizeof name, message, sizeof message);
    if (code != AMONTONS_SOLVED)
        fprintf(stderr, "%s\n", message);
    else
        printf("%s: solved, see %s/%s.lst\n", name, arguments[2], name);
    return code;
}
