/* Takes a history step by step, with loads of its own; a step that does not converge is halved.
   Usage: step_history_c DECK */
#include <amontons.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROOM = 1000, MAX_COLUMNS = 100, N_CHANGES = 2 };

/* A body and where it is. */
struct body {
    amontons_stepper *stepper;
    int n_points, n_state;
    double *state, *after; /* before and after a step */
    double columns[MAX_COLUMNS];
    int *status;
    char message[ROOM];
};

/* Takes a step from the loads before to those at its end; if it does not converge, in two halves. */
static int step(struct body *body, double begin, const double before[N_CHANGES], double end,
                const double loads[N_CHANGES], int n_halvings)
{
    int code = amontons_step(body->stepper, end, N_CHANGES, loads, body->n_state, body->state, body->after,
                             MAX_COLUMNS, body->columns, body->n_points, NULL, body->status, body->message, ROOM);
    if (code == AMONTONS_SOLVED) {
        double *kept = body->state; /* the state after is the one before the next step */
        body->state = body->after;
        body->after = kept;
    } else if (code == AMONTONS_NOT_CONVERGED && n_halvings > 0) {
        const double middle[N_CHANGES] = {0.5 * (before[0] + loads[0]), 0.5 * (before[1] + loads[1])};
        code = step(body, begin, before, 0.5 * (begin + end), middle, n_halvings - 1);
        if (code == AMONTONS_SOLVED)
            code = step(body, 0.5 * (begin + end), middle, end, loads, n_halvings - 1);
    }
    return code;
}

/* The place of a name among the columns, -1 if it is not there. */
static int column(const char *columns, const char *name)
{
    size_t length = strlen(name);
    for (int place = 0; columns; place++) {
        if (strncmp(columns, name, length) == 0 && (columns[length] == ',' || columns[length] == '\0'))
            return place;
        columns = strchr(columns, ',');
        if (columns)
            columns++;
    }
    return -1;
}

/* The text of a file, NULL if it cannot be read. */
static char *text_of(const char *path)
{
    static char text[100000];
    FILE *file = fopen(path, "r");
    if (!file)
        return NULL;
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

int main(int n_arguments, char **arguments)
{
    const double push[] = {0.0, 10.0, 15.0, 5.0};
    struct body body = {0};
    char columns[ROOM];
    int n_changes, code;
    const char *text = n_arguments == 2 ? text_of(arguments[1]) : NULL;

    if (!text) {
        fprintf(stderr, "usage: %s DECK\n", arguments[0]);
        return AMONTONS_INPUT_REFUSED;
    }
    code = amontons_new_stepper(text, arguments[1], "", &body.stepper, &n_changes, &body.n_points, &body.n_state,
                                columns, sizeof columns, body.message, ROOM);
    int displacement = code == AMONTONS_SOLVED ? column(columns, "ux_1") : -1;
    if (code == AMONTONS_SOLVED && (n_changes != N_CHANGES || displacement < 0)) {
        snprintf(body.message, ROOM, "expected two &steps of loads and a probe");
        code = AMONTONS_INPUT_REFUSED;
    }
    if (code == AMONTONS_SOLVED) {
        body.state = calloc(body.n_state, sizeof(double)); /* at rest */
        body.after = calloc(body.n_state, sizeof(double));
        body.status = calloc(body.n_points, sizeof(int));
    }
    for (int i = 0; i < 4 && code == AMONTONS_SOLVED; i++) {
        const double before[N_CHANGES] = {i > 0 ? push[i - 1] : 0.0, i > 0}, loads[N_CHANGES] = {push[i], 1.0};
        code = step(&body, i, before, i + 1, loads, i > 0 ? 10 : 0);
        if (code == AMONTONS_SOLVED)
            printf("push %5.1f, displacement of the corner %12.9f, dissipation %.6f\n", push[i],
                   body.columns[displacement], body.columns[column(columns, "dissipation")]);
    }
    if (code != AMONTONS_SOLVED)
        fprintf(stderr, "%s\n", body.message);
    free(body.state);
    free(body.after);
    free(body.status);
    amontons_free_stepper(body.stepper);
    return code;
}
