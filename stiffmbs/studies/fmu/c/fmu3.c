/* FMI 3.0 for model exchange and co-simulation, by the functions of FMI 2.0: both have the same value references and states. */
#include <stdio.h>
#include <string.h>

#include "instance.h"
#undef FMI2_Export
#include "fmi3Functions.h"

typedef fmi3ValueReference reference;

static void report(instance *i, int status, const char *category, const char *text) {
    fmi3LogMessageCallback log = (fmi3LogMessageCallback)i->log_message;
    if (log) log(i->environment, (fmi3Status)status, category, text);
}

static fmi3Status refused(instance *i, const char *what) {
    char text[128];
    snprintf(text, sizeof text, "%s: the FMU does not provide it", what);
    if (i) report(i, fmi3Error, "logStatusError", text);
    return fmi3Error;
}

static fmi3Instance instantiated(fmi3String name, fmi3String token, int is_exchange, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    const char *why = reason_against(token);
    instance *i = why ? NULL : new_instance();
    if (!i) {
        if (log) log(environment, fmi3Error, "logStatusError", why ? why : "there is too little memory");
        return NULL;
    }
    i->environment = environment;
    i->log_message = (void *)log;
    i->report = report;
    i->is_exchange = is_exchange;
    snprintf(i->name, sizeof i->name, "%s", name ? name : "");
    return i;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    return instantiated(name, token, 1, environment, log);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                         fmi3Boolean event_mode, fmi3Boolean early_return, const reference intermediate[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
    return instantiated(name, token, 0, environment, log);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
                                               fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
    if (log) log(environment, fmi3Error, "logStatusError", "the FMU has no scheduled execution");
    return NULL;
}

const char *fmi3GetVersion(void) { return fmi3Version; }
void fmi3FreeInstance(fmi3Instance c) { fmi2FreeInstance(c); }

#define AS_BEFORE(name, arguments, call) \
    fmi3Status name arguments { return (fmi3Status)call; }
#define OK(name) AS_BEFORE(name, (fmi3Instance c), fmi3OK)
#define NOT_PROVIDED(name, arguments) AS_BEFORE(name, arguments, refused(c, #name))

AS_BEFORE(fmi3SetDebugLogging, (fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]), fmi3OK)
AS_BEFORE(fmi3ExitInitializationMode, (fmi3Instance c), fmi2ExitInitializationMode(c))
AS_BEFORE(fmi3Reset, (fmi3Instance c), fmi2Reset(c))
OK(fmi3Terminate)
OK(fmi3EnterEventMode)
OK(fmi3EnterContinuousTimeMode)
OK(fmi3EnterStepMode)
OK(fmi3EvaluateDiscreteStates)

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean has_stop,
                                       fmi3Float64 stop) {
    fmi2Status status = fmi2SetupExperiment(c, has_tolerance, tolerance, start, has_stop, stop);
    return (fmi3Status)(status == fmi2OK ? fmi2EnterInitializationMode(c) : status);
}

/* values */
AS_BEFORE(fmi3GetFloat64, (fmi3Instance c, const reference vr[], size_t n, fmi3Float64 value[], size_t m), fmi2GetReal(c, vr, n, value))
AS_BEFORE(fmi3SetFloat64, (fmi3Instance c, const reference vr[], size_t n, const fmi3Float64 value[], size_t m), fmi2SetReal(c, vr, n, value))
#define NO_VARIABLES(kind)                                                                                                                   \
    AS_BEFORE(fmi3Get##kind, (fmi3Instance c, const reference vr[], size_t n, fmi3##kind value[], size_t m), (n ? refused(c, #kind) : fmi3OK)) \
    AS_BEFORE(fmi3Set##kind, (fmi3Instance c, const reference vr[], size_t n, const fmi3##kind value[], size_t m), (n ? refused(c, #kind) : fmi3OK))
NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(Int32)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(Boolean)
NO_VARIABLES(String)
AS_BEFORE(fmi3GetBinary, (fmi3Instance c, const reference vr[], size_t n, size_t size[], fmi3Binary value[], size_t m), (n ? refused(c, "Binary") : fmi3OK))
AS_BEFORE(fmi3SetBinary, (fmi3Instance c, const reference vr[], size_t n, const size_t size[], const fmi3Binary value[], size_t m), (n ? refused(c, "Binary") : fmi3OK))
AS_BEFORE(fmi3GetClock, (fmi3Instance c, const reference vr[], size_t n, fmi3Clock value[]), (n ? refused(c, "Clock") : fmi3OK))
AS_BEFORE(fmi3SetClock, (fmi3Instance c, const reference vr[], size_t n, const fmi3Clock value[]), (n ? refused(c, "Clock") : fmi3OK))

/* states of the FMU */
AS_BEFORE(fmi3GetFMUState, (fmi3Instance c, fmi3FMUState *state), fmi2GetFMUstate(c, state))
AS_BEFORE(fmi3SetFMUState, (fmi3Instance c, fmi3FMUState state), fmi2SetFMUstate(c, state))
AS_BEFORE(fmi3FreeFMUState, (fmi3Instance c, fmi3FMUState *state), fmi2FreeFMUstate(c, state))
AS_BEFORE(fmi3SerializedFMUStateSize, (fmi3Instance c, fmi3FMUState state, size_t *size), fmi2SerializedFMUstateSize(c, state, size))
AS_BEFORE(fmi3SerializeFMUState, (fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size), fmi2SerializeFMUstate(c, state, (fmi2Byte *)bytes, size))
AS_BEFORE(fmi3DeserializeFMUState, (fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state), fmi2DeSerializeFMUstate(c, (const fmi2Byte *)bytes, size, state))

/* model exchange */
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals, fmi3Boolean *states, fmi3Boolean *has_next,
                                    fmi3Float64 *next) {
    fmi2EventInfo info;
    fmi2Status status = fmi2NewDiscreteStates(c, &info);
    *again = *terminate = *nominals = fmi3False;
    *states = info.valuesOfContinuousStatesChanged;
    *has_next = info.nextEventTimeDefined;
    *next = info.nextEventTime;
    return (fmi3Status)status;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_set, fmi3Boolean *event, fmi3Boolean *terminate) {
    *event = is_at_breakpoint(c) != 0;
    *terminate = fmi3False;
    return fmi3OK;
}

AS_BEFORE(fmi3SetTime, (fmi3Instance c, fmi3Float64 t), fmi2SetTime(c, t))
AS_BEFORE(fmi3SetContinuousStates, (fmi3Instance c, const fmi3Float64 x[], size_t n), fmi2SetContinuousStates(c, x, n))
AS_BEFORE(fmi3GetContinuousStates, (fmi3Instance c, fmi3Float64 x[], size_t n), fmi2GetContinuousStates(c, x, n))
AS_BEFORE(fmi3GetContinuousStateDerivatives, (fmi3Instance c, fmi3Float64 dx[], size_t n), fmi2GetDerivatives(c, dx, n))
AS_BEFORE(fmi3GetNominalsOfContinuousStates, (fmi3Instance c, fmi3Float64 x[], size_t n), fmi2GetNominalsOfContinuousStates(c, x, n))
AS_BEFORE(fmi3GetEventIndicators, (fmi3Instance c, fmi3Float64 values[], size_t n), fmi2GetEventIndicators(c, values, n))

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n) {
    *n = N_EVENTS;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n) {
    *n = N_STATES;
    return fmi3OK;
}

/* co-simulation */
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean no_set, fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early,
                      fmi3Float64 *last) {
    fmi2Status status = fmi2DoStep(c, t, h, no_set);
    *event = *terminate = *early = fmi3False;
    *last = ((instance *)c)->t;
    return (fmi3Status)status;
}

/* what the model description does not announce */
NOT_PROVIDED(fmi3GetNumberOfVariableDependencies, (fmi3Instance c, reference vr, size_t *n))
NOT_PROVIDED(fmi3GetVariableDependencies, (fmi3Instance c, reference vr, size_t of[], reference by[], size_t at[], fmi3DependencyKind kind[], size_t n))
NOT_PROVIDED(fmi3GetDirectionalDerivative, (fmi3Instance c, const reference u[], size_t n_u, const reference k[], size_t n_k, const fmi3Float64 seed[], size_t n_seed, fmi3Float64 found[], size_t n))
NOT_PROVIDED(fmi3GetAdjointDerivative, (fmi3Instance c, const reference u[], size_t n_u, const reference k[], size_t n_k, const fmi3Float64 seed[], size_t n_seed, fmi3Float64 found[], size_t n))
NOT_PROVIDED(fmi3EnterConfigurationMode, (fmi3Instance c))
NOT_PROVIDED(fmi3ExitConfigurationMode, (fmi3Instance c))
NOT_PROVIDED(fmi3GetIntervalDecimal, (fmi3Instance c, const reference vr[], size_t n, fmi3Float64 interval[], fmi3IntervalQualifier qualifier[]))
NOT_PROVIDED(fmi3GetIntervalFraction, (fmi3Instance c, const reference vr[], size_t n, fmi3UInt64 count[], fmi3UInt64 resolution[], fmi3IntervalQualifier qualifier[]))
NOT_PROVIDED(fmi3GetShiftDecimal, (fmi3Instance c, const reference vr[], size_t n, fmi3Float64 shift[]))
NOT_PROVIDED(fmi3GetShiftFraction, (fmi3Instance c, const reference vr[], size_t n, fmi3UInt64 count[], fmi3UInt64 resolution[]))
NOT_PROVIDED(fmi3SetIntervalDecimal, (fmi3Instance c, const reference vr[], size_t n, const fmi3Float64 interval[]))
NOT_PROVIDED(fmi3SetIntervalFraction, (fmi3Instance c, const reference vr[], size_t n, const fmi3UInt64 count[], const fmi3UInt64 resolution[]))
NOT_PROVIDED(fmi3SetShiftDecimal, (fmi3Instance c, const reference vr[], size_t n, const fmi3Float64 shift[]))
NOT_PROVIDED(fmi3SetShiftFraction, (fmi3Instance c, const reference vr[], size_t n, const fmi3UInt64 count[], const fmi3UInt64 resolution[]))
NOT_PROVIDED(fmi3GetOutputDerivatives, (fmi3Instance c, const reference vr[], size_t n, const fmi3Int32 order[], fmi3Float64 value[], size_t m))
NOT_PROVIDED(fmi3ActivateModelPartition, (fmi3Instance c, reference vr, fmi3Float64 t))
