/* FMI 3.0 for co-simulation, over instance.h; types and functions are declared by the headers of the
   standard. There are no clocks, no events, no arrays and no intermediate updates. */
#include "fmi3Functions.h"
#include "instance.h"

#define NEEDED(c)                                                                                  \
    if (!(c))                                                                                      \
    return fmi3Error

static void emit(Instance *m, Status status, const char *category, const char *message)
{
    fmi3LogMessageCallback log = (fmi3LogMessageCallback)(uintptr_t)m->host;
    if (log)
        log(m->environment, status, category, message);
}
static const Skin SKIN = {emit, {"Float64", "Int32", "Boolean", "Enumeration"}};

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                         fmi3Boolean visible, fmi3Boolean logging,
                                         fmi3Boolean has_events, fmi3Boolean may_return_early,
                                         const fmi3ValueReference required[], size_t required_count,
                                         fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update)
{
    Instance *m = create(
        name, token, resources, logging, &SKIN, (void *)(uintptr_t)log, environment,
        has_events ? "instantiate: the event mode is asked for, and there is none" : NULL);
    if (m) {
        m->returns_early = may_return_early;
        m->is_whole = !may_return_early; /* what is discarded then has to have changed nothing */
    }
    return m;
}
fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log)
{
    return create(name, token, resources, logging, &SKIN, (void *)(uintptr_t)log, environment,
                  OTHER_KIND);
}
fmi3Instance
fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                  fmi3Boolean visible, fmi3Boolean logging,
                                  fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                  fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                  fmi3UnlockPreemptionCallback unlock)
{
    return create(name, token, resources, logging, &SKIN, (void *)(uintptr_t)log, environment,
                  OTHER_KIND);
}
void fmi3FreeInstance(fmi3Instance c)
{
    destroy(c);
}
fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count,
                               const fmi3String categories[])
{
    Instance *m = c;
    unsigned chosen;
    NEEDED(c);
    if (read_categories(m, count, categories, &chosen))
        return fmi3Error;
    m->categories = on ? m->categories | chosen : m->categories & ~chosen;
    return fmi3OK;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance,
                                       fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean has_stop, fmi3Float64 stop)
{
    NEEDED(c);
    return set_up(c, "enterInitializationMode", start, has_stop, stop, has_tolerance, tolerance)
               ? ERROR
               : enter(c);
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    NEEDED(c);
    return leave_initialization(c);
}
fmi3Status fmi3Terminate(fmi3Instance c)
{
    NEEDED(c);
    return terminate(c);
}
fmi3Status fmi3Reset(fmi3Instance c)
{
    NEEDED(c);
    begin_anew(c);
    return fmi3OK;
}
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 current, fmi3Float64 size,
                      fmi3Boolean keeps_state, fmi3Boolean *needs_event, fmi3Boolean *terminates,
                      fmi3Boolean *early, fmi3Float64 *reached)
{
    NEEDED(c);
    const Instance *m = c;
    Status status = advance_to(c, current, size);
    int is_early = status == DISCARD && !m->is_whole;
    if (needs_event)
        *needs_event = false;
    if (terminates)
        *terminates = false;
    if (early)
        *early = is_early;
    if (reached)
        *reached = m->state->now;
    return is_early ? OK : status;
}

/* --- values: of the types that there are no variables of, every reference is refused ---------- */

#define VALUES(KIND, NAME)                                                                         \
    static void put##NAME(void *values, size_t i, double value)                                    \
    {                                                                                              \
        ((fmi3##NAME *)values)[i] = (fmi3##NAME)value;                                             \
    }                                                                                              \
    static double item##NAME(const void *values, size_t i)                                         \
    {                                                                                              \
        return (double)((const fmi3##NAME *)values)[i];                                            \
    }                                                                                              \
    fmi3Status fmi3Get##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n,              \
                             fmi3##NAME values[], size_t count)                                    \
    {                                                                                              \
        NEEDED(c);                                                                                 \
        if (count != n)                                                                            \
            return refuse(c, "get" #NAME ": %zu values for %zu variables", count, n);              \
        return get_values(c, KIND, #NAME, vr, n, values, put##NAME);                               \
    }                                                                                              \
    fmi3Status fmi3Set##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n,              \
                             const fmi3##NAME values[], size_t count)                              \
    {                                                                                              \
        NEEDED(c);                                                                                 \
        if (count != n)                                                                            \
            return refuse(c, "set" #NAME ": %zu values for %zu variables", count, n);              \
        return set_values(c, KIND, #NAME, vr, n, values, item##NAME);                              \
    }
VALUES(A_REAL, Float64)
VALUES(AN_INTEGER, Int32)
VALUES(A_BOOLEAN, Boolean)
VALUES(AN_ENUMERATION, Int64)

#define NO_VALUES(NAME)                                                                            \
    fmi3Status fmi3Get##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n,              \
                             fmi3##NAME values[], size_t count)                                    \
    {                                                                                              \
        NEEDED(c);                                                                                 \
        return get_values(c, NO_KIND, #NAME, vr, n, values, NULL);                                 \
    }                                                                                              \
    fmi3Status fmi3Set##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n,              \
                             const fmi3##NAME values[], size_t count)                              \
    {                                                                                              \
        NEEDED(c);                                                                                 \
        return set_values(c, NO_KIND, #NAME, vr, n, values, NULL);                                 \
    }
NO_VALUES(Float32)
NO_VALUES(Int8)
NO_VALUES(UInt8)
NO_VALUES(Int16)
NO_VALUES(UInt16)
NO_VALUES(UInt32)
NO_VALUES(UInt64)
NO_VALUES(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[],
                         fmi3Binary values[], size_t count)
{
    NEEDED(c);
    return get_values(c, NO_KIND, "Binary", vr, n, values, NULL);
}
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                         const size_t sizes[], const fmi3Binary values[], size_t count)
{
    NEEDED(c);
    return set_values(c, NO_KIND, "Binary", vr, n, values, NULL);
}
fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Clock values[])
{
    NEEDED(c);
    return get_values(c, NO_KIND, "Clock", vr, n, values, NULL);
}
fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                        const fmi3Clock values[])
{
    NEEDED(c);
    return set_values(c, NO_KIND, "Clock", vr, n, values, NULL);
}

/* --- state ---------------------------------------------------------------------------------- */

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state)
{
    NEEDED(c);
    return take_state(c, state);
}
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state)
{
    NEEDED(c);
    return give_state(c, state);
}
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state)
{
    NEEDED(c);
    free_state(state);
    return fmi3OK;
}
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    NEEDED(c);
    return state_size(c, state, size);
}
fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    NEEDED(c);
    return write_state(c, state, bytes, size);
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState *state)
{
    NEEDED(c);
    return read_state(c, bytes, size, state);
}

/* --- derivatives ------------------------------------------------------------------------------ */

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                    const fmi3Int32 orders[], fmi3Float64 values[], size_t count)
{
    NEEDED(c);
    if (count != n)
        return refuse(c, "getOutputDerivatives: %zu values for %zu variables", count, n);
    return get_derivatives(c, "getOutputDerivatives", vr, n, orders, values);
}
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknown[],
                                        size_t unknowns, const fmi3ValueReference known[],
                                        size_t knowns, const fmi3Float64 along[], size_t seeds,
                                        fmi3Float64 values[], size_t count)
{
    NEEDED(c);
    if (seeds != knowns || count != unknowns)
        return refuse(c,
                      "getDirectionalDerivative: %zu seeds for %zu inputs, %zu values for %zu "
                      "variables",
                      seeds, knowns, count, unknowns);
    return get_directional(c, unknown, unknowns, known, knowns, along, values);
}

/* --- what an FMU may leave out, and this one does -------------------------------------------- */

#define NOT_OFFERED(NAME, PARAMETERS)                                                              \
    fmi3Status fmi3##NAME PARAMETERS                                                               \
    {                                                                                              \
        NEEDED(c);                                                                                 \
        return refuse(c, #NAME ": is not offered");                                                \
    }
#define ALONE (fmi3Instance c)
#define OF_CLOCKS(...) (fmi3Instance c, const fmi3ValueReference vr[], size_t n, __VA_ARGS__)
NOT_OFFERED(EnterEventMode, ALONE)
NOT_OFFERED(EnterStepMode, ALONE)
NOT_OFFERED(EnterConfigurationMode, ALONE)
NOT_OFFERED(ExitConfigurationMode, ALONE)
NOT_OFFERED(EnterContinuousTimeMode, ALONE)
NOT_OFFERED(EvaluateDiscreteStates, ALONE)
NOT_OFFERED(UpdateDiscreteStates,
            (fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminates, fmi3Boolean *nominals,
             fmi3Boolean *values, fmi3Boolean *has_next, fmi3Float64 *next))
NOT_OFFERED(GetNumberOfVariableDependencies,
            (fmi3Instance c, fmi3ValueReference variable, size_t *count))
NOT_OFFERED(GetVariableDependencies,
            (fmi3Instance c, fmi3ValueReference dependent, size_t elements[],
             fmi3ValueReference independents[], size_t of_independents[],
             fmi3DependencyKind kinds[], size_t count))
NOT_OFFERED(GetAdjointDerivative,
            (fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,
             const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seeds[],
             size_t seed_count, fmi3Float64 values[], size_t count))
NOT_OFFERED(GetIntervalDecimal,
            OF_CLOCKS(fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]))
NOT_OFFERED(GetIntervalFraction, OF_CLOCKS(fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                           fmi3IntervalQualifier qualifiers[]))
NOT_OFFERED(GetShiftDecimal, OF_CLOCKS(fmi3Float64 shifts[]))
NOT_OFFERED(GetShiftFraction, OF_CLOCKS(fmi3UInt64 counters[], fmi3UInt64 resolutions[]))
NOT_OFFERED(SetIntervalDecimal, OF_CLOCKS(const fmi3Float64 intervals[]))
NOT_OFFERED(SetIntervalFraction,
            OF_CLOCKS(const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
NOT_OFFERED(SetShiftDecimal, OF_CLOCKS(const fmi3Float64 shifts[]))
NOT_OFFERED(SetShiftFraction,
            OF_CLOCKS(const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
NOT_OFFERED(CompletedIntegratorStep, (fmi3Instance c, fmi3Boolean keeps_state,
                                      fmi3Boolean *needs_event, fmi3Boolean *terminates))
NOT_OFFERED(SetTime, (fmi3Instance c, fmi3Float64 time))
NOT_OFFERED(SetContinuousStates, (fmi3Instance c, const fmi3Float64 states[], size_t n))
NOT_OFFERED(GetContinuousStates, (fmi3Instance c, fmi3Float64 states[], size_t n))
NOT_OFFERED(GetContinuousStateDerivatives, (fmi3Instance c, fmi3Float64 rates[], size_t n))
NOT_OFFERED(GetNominalsOfContinuousStates, (fmi3Instance c, fmi3Float64 nominals[], size_t n))
NOT_OFFERED(GetNumberOfContinuousStates, (fmi3Instance c, size_t *n))
NOT_OFFERED(GetEventIndicators, (fmi3Instance c, fmi3Float64 indicators[], size_t n))
NOT_OFFERED(GetNumberOfEventIndicators, (fmi3Instance c, size_t *n))
NOT_OFFERED(ActivateModelPartition, (fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time))
