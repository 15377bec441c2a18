/* Instance of the model of an FMU: its tables, its state, and what follows from it. The numbers in capitals are in model.h. */
#ifndef STIFFMBS_INSTANCE_H
#define STIFFMBS_INSTANCE_H

#include "fmi2Functions.h"
#include "model.h"

#define N_X (N_Q + N_U)
#define N_ROW (N_X + N_U + N_C + N_OUTPUT + N_JUDGED + 1)
#define AT_LEAST_ONE(n) ((n) > 0 ? (n) : 1)

typedef long long word;

typedef struct instance instance;
struct instance {
    char *block, *memory; /* allocated memory, and the aligned image of the tables within it */
    double t, x[AT_LEAST_ONE(N_X)];
    double dx[AT_LEAST_ONE(N_X)], lam[AT_LEAST_ONE(N_C)], row[N_ROW]; /* rates, multipliers and outputs at the state */
    double inputs[AT_LEAST_ONE(N_INPUTS)];
    int has_rates, has_row; /* whether they are those of the state */
    int must_restart;       /* whether the state or an input has changed since the last step */
    int is_exchange, is_initializing;
    int next_break; /* first breakpoint that has not been passed */
    char name[128];
    void (*report)(instance *i, int status, const char *category, const char *text); /* that of the interface */
    fmi2CallbackFunctions callbacks;                                                /* FMI 2.0 */
    void *environment, *log_message;                                                /* FMI 3.0 */
};

typedef struct {
    char token[sizeof TOKEN];
    instance own;
    char memory[IMAGE_SIZE];
} saved_state;

instance *new_instance(void);
void free_instance(instance *i);
void to_start(instance *i);
void save(instance *i, saved_state *s);
void restore(instance *i, const saved_state *s);

void forget(instance *i);
void set_tolerance(instance *i, double tolerance);
void set_input(instance *i, int k, double value);
const char *restart(instance *i);
const char *compute_rates(instance *i);
const char *compute_row(instance *i);
void compute_event_functions(instance *i, double values[]);
const char *project(instance *i);
const char *advance(instance *i, double end);
const char *reason_against(const char *token); /* of an instance; NULL if there is none */
int is_at_breakpoint(const instance *i);
void pass_breakpoints(instance *i);

#endif
