/* FMI 2.0 for model exchange and co-simulation, by the functions of an instance. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

#define SAME_TIME 1e-9 /* relative difference of times that the sums of a simulating program may have */

static fmi2Status failed(instance *i, fmi2Status status, const char *what, const char *why) {
    char text[256];
    snprintf(text, sizeof text, "%s at t = %.9g s: %s", what, i->t, why);
    if (i->report) i->report(i, status, status == fmi2Discard ? "logStatusDiscard" : "logStatusError", text);
    return status;
}

static void report(instance *i, int status, const char *category, const char *text) {
    if (i->callbacks.logger) i->callbacks.logger(i->callbacks.componentEnvironment, i->name, status, category, "%s", text);
}

/* Report why a computation has no result; the simulating program may try another step. */
static fmi2Status discarded(instance *i, const char *what, const char *why) { return why ? failed(i, fmi2Discard, what, why) : fmi2OK; }

/* Return true if the processor has the instructions of the compiled code (AVX2, FMA, BMI). */
static int has_instructions(void) {
#if defined(__x86_64__)
    unsigned a, b, c, d;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_FMA) || !(c & bit_OSXSAVE)) return 0;
    return __get_cpuid_count(7, 0, &a, &b, &c, &d) && (b & bit_AVX2) && (b & bit_BMI2);
#else
    return 1;
#endif
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) { return fmi2OK; }

const char *reason_against(const char *token) {
    if (!has_instructions()) return "this processor lacks AVX2 or FMA, which the machine code of the FMU needs";
    return token && !strcmp(token, TOKEN) ? NULL : "the GUID is not that of this library";
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources, const fmi2CallbackFunctions *callbacks,
                              fmi2Boolean visible, fmi2Boolean logging) {
    const char *why = reason_against(guid);
    instance *i = why ? NULL : new_instance();
    if (!i) {
        if (callbacks && callbacks->logger)
            callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError", "%s", why ? why : "there is too little memory");
        return NULL;
    }
    if (callbacks) i->callbacks = *callbacks;
    i->report = report;
    i->is_exchange = type == fmi2ModelExchange;
    snprintf(i->name, sizeof i->name, "%s", name ? name : "");
    return i;
}

void fmi2FreeInstance(fmi2Component c) {
    if (c) free_instance(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    instance *i = c;
    if (OF_TIME && fabs(start - START_TIME) > SAME_TIME * fmax(fabs(START_TIME), STOP_TIME - START_TIME))
        return failed(i, fmi2Error, "setupExperiment", "the formulas of time were prepared for the start time of the scene");
    if (!OF_TIME) i->t = start;
    if (has_tolerance) set_tolerance(i, tolerance);
    i->must_restart = 1;
    forget(i);
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    ((instance *)c)->is_initializing = 1;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    instance *i = c;
    const char *why = restart(i);
    i->is_initializing = 0;
    return why ? failed(i, fmi2Error, "the start", why) : fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }

fmi2Status fmi2Reset(fmi2Component c) {
    to_start(c);
    return fmi2OK;
}

/* Value references: states, their derivatives, numbers of the output row, and inputs, each kind from its own first one. */
fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    instance *i = c;
    const char *why = NULL;
    for (size_t k = 0; k < n; k++) {
        if (vr[k] < N_X) value[k] = i->x[vr[k]];
        else if (vr[k] >= FIRST_DERIVATIVE && vr[k] < FIRST_DERIVATIVE + N_X) {
            if ((why = compute_rates(i))) return discarded(i, "accelerations", why);
            value[k] = i->dx[vr[k] - FIRST_DERIVATIVE];
        } else if (vr[k] >= FIRST_OUTPUT && vr[k] < FIRST_OUTPUT + N_ROW) {
            if ((why = compute_row(i))) return discarded(i, "outputs", why);
            value[k] = i->row[vr[k] - FIRST_OUTPUT];
        } else if (vr[k] >= FIRST_INPUT && vr[k] < FIRST_INPUT + N_INPUTS) value[k] = i->inputs[vr[k] - FIRST_INPUT];
        else if (vr[k] == TIME) value[k] = i->t;
        else if (vr[k] > TIME && vr[k] <= TIME + N_EVENTS) {
            double values[AT_LEAST_ONE(N_EVENTS)];
            compute_event_functions(i, values);
            value[k] = values[vr[k] - TIME - 1];
        }
        else return failed(i, fmi2Error, "getReal", "there is no such variable");
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    instance *i = c;
    for (size_t k = 0; k < n; k++) {
        if (!isfinite(value[k])) return failed(i, fmi2Error, "setReal", "a value is not finite");
        if (vr[k] < N_X) {
            i->x[vr[k]] = value[k];
            i->must_restart = 1;
            forget(i);
        } else if (vr[k] >= FIRST_INPUT && vr[k] < FIRST_INPUT + N_INPUTS) set_input(i, (int)(vr[k] - FIRST_INPUT), value[k]);
        else return failed(i, fmi2Error, "setReal", "there is no such state or input");
    }
    return fmi2OK;
}

#define NO_VARIABLES(kind, type)                                                                                    \
    fmi2Status fmi2Get##kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value[]) {              \
        return n ? failed(c, fmi2Error, "get" #kind, "there is no such variable") : fmi2OK;                           \
    }                                                                                                               \
    fmi2Status fmi2Set##kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, const type value[]) {        \
        return n ? failed(c, fmi2Error, "set" #kind, "there is no such variable") : fmi2OK;                           \
    }
NO_VARIABLES(Integer, fmi2Integer)
NO_VARIABLES(Boolean, fmi2Boolean)
NO_VARIABLES(String, fmi2String)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    saved_state *s = *state ? *state : malloc(sizeof *s);
    if (!s) return failed(c, fmi2Error, "getFMUstate", "there is too little memory");
    save(c, s);
    *state = s;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    if (!state) return failed(c, fmi2Error, "setFMUstate", "there is no state");
    restore(c, state);
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    *size = sizeof(saved_state);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    if (!state || size < sizeof(saved_state)) return failed(c, fmi2Error, "serializeFMUstate", "the memory is too small");
    memcpy(bytes, state, sizeof(saved_state));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    if (size != sizeof(saved_state) || memcmp(bytes, TOKEN, sizeof TOKEN))
        return failed(c, fmi2Error, "deSerializeFMUstate", "the state is not one of this FMU");
    saved_state *s = malloc(sizeof *s);
    if (!s) return failed(c, fmi2Error, "deSerializeFMUstate", "there is too little memory");
    memcpy(s, bytes, size);
    *state = s;
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown, const fmi2ValueReference known[],
                                        size_t n_known, const fmi2Real change[], fmi2Real found[]) {
    return failed(c, fmi2Error, "getDirectionalDerivative", "the FMU does not provide it");
}

/* model exchange */
fmi2Status fmi2EnterEventMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) { return fmi2OK; }

/* At events, states are projected onto the constraints, and formulas of time change to the side after a breakpoint. */
fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
    instance *i = c;
    double before[AT_LEAST_ONE(N_X)];
    memset(info, 0, sizeof *info);
    memcpy(before, i->x, sizeof before);
    pass_breakpoints(i);
    const char *why = project(i);
    if (why) return discarded(i, "an event", why);
    info->valuesOfContinuousStatesChanged = memcmp(before, i->x, sizeof before) != 0;
    info->nextEventTimeDefined = i->next_break < N_BREAKS;
    if (info->nextEventTimeDefined) info->nextEventTime = breaks[i->next_break];
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set, fmi2Boolean *event, fmi2Boolean *terminate) {
    *event = is_at_breakpoint(c);
    *terminate = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real t) {
    instance *i = c;
    if (t != i->t) forget(i);
    i->t = t;
    return fmi2OK;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n) {
    instance *i = c;
    if (n != N_STATES) return failed(i, fmi2Error, "setContinuousStates", "the number of states is wrong");
    for (size_t k = 0; k < n; k++) i->x[states[k]] = x[k];
    forget(i);
    return fmi2OK;
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n) {
    if (n != N_STATES) return failed(c, fmi2Error, "getContinuousStates", "the number of states is wrong");
    for (size_t k = 0; k < n; k++) x[k] = ((instance *)c)->x[states[k]];
    return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x[], size_t n) {
    if (n != N_STATES) return failed(c, fmi2Error, "getNominalsOfContinuousStates", "the number of states is wrong");
    for (size_t k = 0; k < n; k++) x[k] = nominal_x[states[k]];
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real dx[], size_t n) {
    instance *i = c;
    const char *why = compute_rates(i);
    if (why) return discarded(i, "accelerations", why);
    if (n != N_STATES) return failed(i, fmi2Error, "getDerivatives", "the number of states is wrong");
    for (size_t k = 0; k < n; k++) dx[k] = i->dx[states[k]];
    return fmi2OK;
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real values[], size_t n) {
    if (n != N_EVENTS) return failed(c, fmi2Error, "getEventIndicators", "the number of event indicators is wrong");
    compute_event_functions(c, values);
    return fmi2OK;
}

/* co-simulation */
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_set) {
    instance *i = c;
    double end = t + h, margin = SAME_TIME * fmax(fabs(i->t), h);
    if (!(h >= 0)) return failed(i, fmi2Error, "doStep", "the step is negative");
    if (fabs(t - i->t) > margin) return failed(i, fmi2Error, "doStep", "a step does not begin where the last one ended");
    if (OF_TIME && end > STOP_TIME + margin) return failed(i, fmi2Error, "doStep", "the formulas of time were prepared up to the stop time of the scene");
    const char *why = advance(i, end);
    return why ? failed(i, fmi2Discard, "doStep", why) : fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) { return failed(c, fmi2Error, "cancelStep", "steps are not asynchronous"); }

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], const fmi2Real value[]) {
    return n ? failed(c, fmi2Error, "setRealInputDerivatives", "inputs are constant over a step") : fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], fmi2Real value[]) {
    return n ? failed(c, fmi2Error, "getRealOutputDerivatives", "the FMU does not provide them") : fmi2OK;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) { return fmi2Discard; }

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = ((instance *)c)->t;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) { return fmi2Discard; }
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) { return fmi2Discard; }
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) { return fmi2Discard; }
