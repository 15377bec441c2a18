/* Memory of an instance, and calls of the compiled code of the model. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

enum { PAUSED, AT_END, AT_EVENT }; /* stiffmbs/compile/machine/native/statuses.py */
#define STEPS_OF_A_CALL 1000

extern word CONSISTENT_RATES(double t, double *x, double *dx, double *lam, word *dynamics);
extern void EVENT_FUNCTIONS(double t, double *x, double *values, word *watch, word *dynamics);
extern word ADVANCE(double end, word steps, word held, word own_steps, word *steps_table);
extern word OUTPUT_POINTS(word count, double *t, double *q, double *u, word projects, double tolerance, word stride, double *rows_q,
                          double *rows_u, double *rows_a, double *rows_lam, double *rows_output, double *rows_judged, word *dynamics);

/* the name by which compiled code asks for memory */
__attribute__((visibility("hidden"))) void *PyMem_RawRealloc(void *block, size_t size) { return realloc(block, size); }

static word *word_at(instance *i, word place) { return (word *)(i->memory + place); }
static double *float_at(instance *i, word place) { return (double *)(i->memory + place); }

static void relocate(instance *i) {
    for (int k = 0; k < N_LINKS; k++) *word_at(i, links[k].at) = (word)(intptr_t)(i->memory + links[k].to);
    for (int k = 0; k < N_CALLS; k++) *word_at(i, calls[k].at) = (word)(intptr_t)functions[calls[k].to];
}

/* Forget the arrays that compiled code has allocated, and their sizes. */
static void without_own(instance *i) {
    for (int k = 0; k < N_OWN; k++) *word_at(i, own[k]) = 0;
}

static void free_own(instance *i) {
    for (int k = 0; k < N_OWNED; k++) free((void *)(intptr_t)*word_at(i, own[k]));
    without_own(i);
}

instance *new_instance(void) {
    instance *i = calloc(1, sizeof *i);
    if (!i) return NULL;
    i->block = calloc(1, IMAGE_SIZE + ALIGNMENT);
    if (!i->block) {
        free(i);
        return NULL;
    }
    i->memory = i->block + (ALIGNMENT - (uintptr_t)i->block % ALIGNMENT) % ALIGNMENT;
    to_start(i);
    return i;
}

void free_instance(instance *i) {
    free_own(i);
    free(i->block);
    free(i);
}

void to_start(instance *i) {
    free_own(i);
    memset(i->memory, 0, IMAGE_SIZE);
    memcpy(i->memory, image, IMAGE_CONTENT);
    relocate(i);
    memcpy(i->x, start_x, N_X * sizeof(double));
    for (int k = 0; k < N_INPUTS; k++) i->inputs[k] = start_inputs[k];
    i->t = START_TIME;
    i->next_break = 0;
    i->is_initializing = 0;
    i->must_restart = 1;
    forget(i);
}

/* Forget what belongs to the instance in the simulating program, not to its state. */
static void without_program(instance *i) {
    i->block = i->memory = NULL;
    i->report = NULL;
    memset(&i->callbacks, 0, sizeof i->callbacks);
    i->environment = i->log_message = NULL;
    memset(i->name, 0, sizeof i->name);
}

/* The pivots of the factors are no part of a state: without them here too, this instance goes on as one that is restored. */
void save(instance *i, saved_state *s) {
    free_own(i);
    memset(s, 0, sizeof *s);
    memcpy(s->token, TOKEN, sizeof TOKEN);
    memcpy(&s->own, i, sizeof *i);
    without_program(&s->own);
    memcpy(s->memory, i->memory, IMAGE_SIZE);
}

void restore(instance *i, const saved_state *s) {
    instance now = *i;
    free_own(i);
    memcpy(i, &s->own, sizeof *i);
    i->block = now.block;
    i->memory = now.memory;
    i->report = now.report;
    i->callbacks = now.callbacks;
    i->environment = now.environment;
    i->log_message = now.log_message;
    i->is_exchange = now.is_exchange;
    memcpy(i->name, now.name, sizeof i->name);
    memcpy(i->memory, s->memory, IMAGE_SIZE);
    without_own(i);
    relocate(i);
}

void forget(instance *i) { i->has_rates = i->has_row = 0; }

void set_tolerance(instance *i, double tolerance) {
    double *rtol = float_at(i, AT_RTOL), *atol = float_at(i, AT_ATOL);
    if (!(tolerance > 0 && tolerance < *rtol)) return;
    for (int k = 0; k < N_X; k++) atol[k] *= tolerance / *rtol;
    *rtol = tolerance;
}

void set_input(instance *i, int k, double value) {
    if (i->inputs[k] == value) return;
    i->inputs[k] = value;
    for (int n = 0; n < N_NUMBERS; n++)
        if (numbers[n].input == k) *float_at(i, numbers[n].at) = numbers[n].offset + numbers[n].slope * value;
    forget(i);
    i->must_restart = 1;
}

static const char *reason(word status) {
    static const char *const reasons[] = {REASONS};
    word k = -status - 1;
    return k >= 0 && k < (word)(sizeof reasons / sizeof *reasons) ? reasons[k] : "the computation failed";
}

/* Time at which the equations hold: just before a breakpoint that has not been passed, just after one that has. */
static double time_of(const instance *i) {
    if (i->next_break < N_BREAKS && i->t > breaks[i->next_break] - ASIDE) return breaks[i->next_break] - ASIDE;
    if (i->next_break > 0 && i->t < breaks[i->next_break - 1] + ASIDE) return breaks[i->next_break - 1] + ASIDE;
    return i->t;
}

int is_at_breakpoint(const instance *i) { return i->next_break < N_BREAKS && i->t >= breaks[i->next_break] - ASIDE; }

void pass_breakpoints(instance *i) {
    while (is_at_breakpoint(i)) {
        i->next_break++;
        i->must_restart = 1;
        forget(i);
    }
}

const char *compute_rates(instance *i) {
    if (i->has_rates) return NULL;
    double x[AT_LEAST_ONE(N_X)];
    memcpy(x, i->x, sizeof x);
    word status = CONSISTENT_RATES(time_of(i), x, i->dx, i->lam, word_at(i, AT_DYNAMICS));
    i->has_rates = status >= 0;
    for (int k = 0; k < N_ALGEBRAIC; k++) i->x[algebraic[k]] = x[algebraic[k]]; /* the next iteration begins there */
    return status < 0 ? reason(status) : NULL;
}

const char *compute_row(instance *i) {
    if (i->has_row) return NULL;
    double x[AT_LEAST_ONE(N_X)], *r = i->row, t = time_of(i);
    memcpy(x, i->x, sizeof x);
    word *dynamics = word_at(i, AT_DYNAMICS);
    double *judged = r + N_X + N_U + N_C + N_OUTPUT;
    i->has_row = OUTPUT_POINTS(1, &t, x, x + N_Q, 1, POSITION_TOLERANCE, 1, r, r + N_Q, r + N_X, r + N_X + N_U, r + N_X + N_U + N_C,
                               judged, dynamics) == 1;
    r[N_ROW - 1] = judged[KINETIC] + judged[POTENTIAL];
    return i->has_row ? NULL : reason(*word_at(i, AT_STATUS));
}

void compute_event_functions(instance *i, double values[]) {
    if (N_EVENTS > 0) EVENT_FUNCTIONS(time_of(i), i->x, values, word_at(i, AT_WATCH), word_at(i, AT_DYNAMICS));
}

const char *project(instance *i) {
    word status = CONSISTENT_RATES(time_of(i), i->x, i->dx, i->lam, word_at(i, AT_DYNAMICS));
    i->has_rates = status >= 0;
    i->has_row = 0;
    return status < 0 ? reason(status) : NULL;
}

/* Return the reason why the state is beyond the limits of a force; NULL if it is within all. */
static const char *beyond_limits(instance *i) {
    double values[AT_LEAST_ONE(N_EVENTS)];
    if (FIRST_LIMIT == N_EVENTS) return NULL;
    compute_event_functions(i, values);
    for (int k = FIRST_LIMIT; k < N_EVENTS; k++)
        if (values[k] <= 0) return "a force is beyond the limits of its law";
    return NULL;
}

const char *restart(instance *i) {
    const char *fault;
    if ((fault = project(i)) || (fault = beyond_limits(i))) return fault;
    i->must_restart = 0;
    memcpy(float_at(i, AT_Y), i->x, N_X * sizeof(double));
    memcpy(float_at(i, AT_END_RATES), i->dx, N_X * sizeof(double));
    memcpy(float_at(i, AT_LAM), i->lam, N_C * sizeof(double));
    *float_at(i, AT_T) = *float_at(i, AT_T_BEFORE) = time_of(i);
    *float_at(i, AT_LAST_ERROR) = 0;
    *float_at(i, AT_DISTANCE) = *float_at(i, AT_DISTANCE_OF_END) = INFINITY;
    *word_at(i, AT_STARTED) = *word_at(i, AT_AT_EVENT) = *word_at(i, AT_UNCERTAIN) = 0;
    *float_at(i, AT_BEGUN) = INFINITY; /* no values of the search for events are known */
    if (N_FOUND > 0) memset(word_at(i, AT_FOUND), 0, N_FOUND * sizeof(word));
    return NULL;
}

/* Return true if events have come so fast, over two windows, that too many more are expected up to a time. */
static int chatters(word events, double t, double end, double *since, int *fast) {
    if (events % EVENTS_OF_A_WINDOW) return 0;
    *fast = (end - t) * EVENTS_OF_A_WINDOW > MOST_EVENTS * (t - *since) ? *fast + 1 : 0;
    *since = t;
    return *fast > 1;
}

/* Integrate to a time, with restarts at events and at breakpoints of inputs. */
const char *advance(instance *i, double end) {
    word *table = word_at(i, AT_EXPLICIT), events = 0;
    const char *fault = NULL;
    double since = i->t;
    int fast = 0;
    while (i->t < end) {
        if (i->next_break < N_BREAKS && i->t >= breaks[i->next_break] - ASIDE) {
            if (end <= breaks[i->next_break] + ASIDE) break; /* the end is at the breakpoint: its values are those before it */
            i->t = breaks[i->next_break] + ASIDE;
            pass_breakpoints(i);
        }
        if (i->must_restart && (fault = restart(i))) return fault;
        double stop = end;
        if (i->next_break < N_BREAKS && breaks[i->next_break] - ASIDE < end) stop = breaks[i->next_break] - ASIDE;
        *word_at(i, AT_STIFF_STEPS) = 0;
        word status = ADVANCE(stop, STEPS_OF_A_CALL, (word)1 << 40, 0, table);
        i->t = *float_at(i, AT_T);
        memcpy(i->x, float_at(i, AT_Y), N_X * sizeof(double));
        forget(i);
        if (status < 0) return reason(status);
        if (status == AT_EVENT) {
            if (chatters(++events, i->t, end, &since, &fast)) return "a force chatters: its events do not end";
            i->must_restart = 1;
        }
    }
    i->t = end;
    return NULL;
}
