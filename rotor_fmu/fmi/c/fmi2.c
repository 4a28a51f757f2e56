/* FMI 2.0 for co-simulation, over instance.h; types and functions are declared by the headers of the
   standard. */
#include "fmi2Functions.h"
#include "instance.h"

#define NEEDED(c)                                                                                  \
    if (!(c))                                                                                      \
    return fmi2Error
#define M ((Instance *)c)

static void emit(Instance *m, Status status, const char *category, const char *message)
{
    fmi2CallbackLogger log = (fmi2CallbackLogger)(uintptr_t)m->host;
    if (log)
        log(m->environment, m->name, status, category, "%s", message);
}
static const Skin SKIN = {emit, {"Real", "Integer", "Boolean", "Enumeration"}};

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}
const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging)
{
    static const fmi2CallbackFunctions none;
    const fmi2CallbackFunctions *host = functions ? functions : &none;
    (void)visible;
    return create(name, guid, resources, logging, &SKIN, (void *)(uintptr_t)host->logger,
                  host->componentEnvironment, type == fmi2CoSimulation ? NULL : OTHER_KIND);
}
void fmi2FreeInstance(fmi2Component c)
{
    destroy(c);
}
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                               const fmi2String categories[])
{
    unsigned chosen;
    NEEDED(c);
    if (read_categories(c, count, categories, &chosen))
        return fmi2Error;
    M->categories = on ? chosen : 0; /* only the ones that are named */
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop)
{
    NEEDED(c);
    return set_up(c, "setupExperiment", start, has_stop, stop, has_tolerance, tolerance);
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    NEEDED(c);
    return enter(c);
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    NEEDED(c);
    return leave_initialization(c);
}
fmi2Status fmi2Terminate(fmi2Component c)
{
    NEEDED(c);
    return terminate(c);
}
fmi2Status fmi2Reset(fmi2Component c)
{
    NEEDED(c);
    begin_anew(c);
    return fmi2OK;
}
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real current, fmi2Real size, fmi2Boolean no_set)
{
    (void)no_set;
    NEEDED(c);
    return advance_to(c, current, size);
}
fmi2Status fmi2CancelStep(fmi2Component c)
{
    NEEDED(c);
    return refuse(c, "cancelStep: no step is under way, steps are not asynchronous");
}

/* --- values --------------------------------------------------------------------------------- */

/* Integers, enumerations and Booleans can be read as Reals too, as some masters do with every output. */
#define VALUES(READ, KIND, TYPE, NAME)                                                             \
    static void put##NAME(void *values, size_t i, double value)                                    \
    {                                                                                              \
        ((TYPE *)values)[i] = (TYPE)value;                                                         \
    }                                                                                              \
    static double item##NAME(const void *values, size_t i)                                         \
    {                                                                                              \
        return (double)((const TYPE *)values)[i];                                                  \
    }                                                                                              \
    fmi2Status fmi2Get##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n,             \
                             TYPE values[])                                                        \
    {                                                                                              \
        NEEDED(c);                                                                                 \
        return get_values(c, READ, #NAME, vr, n, values, put##NAME);                               \
    }                                                                                              \
    fmi2Status fmi2Set##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n,             \
                             const TYPE values[])                                                  \
    {                                                                                              \
        NEEDED(c);                                                                                 \
        return set_values(c, KIND, #NAME, vr, n, values, item##NAME);                              \
    }
VALUES(ANY_KIND, A_REAL, fmi2Real, Real)
VALUES(AN_INTEGER, AN_INTEGER, fmi2Integer, Integer)
VALUES(A_BOOLEAN, A_BOOLEAN, fmi2Boolean, Boolean)

/* There are no Strings, so that every reference is refused before a value is touched. */
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                         fmi2String values[])
{
    NEEDED(c);
    return get_values(c, NO_KIND, "String", vr, n, values, NULL);
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                         const fmi2String values[])
{
    NEEDED(c);
    return set_values(c, NO_KIND, "String", vr, n, values, NULL);
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real values[])
{
    NEEDED(c);
    return set_slopes(c, vr, n, order, values);
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real values[])
{
    NEEDED(c);
    return get_derivatives(c, "getRealOutputDerivatives", vr, n, order, values);
}
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                        size_t unknowns, const fmi2ValueReference known[],
                                        size_t knowns, const fmi2Real along[], fmi2Real values[])
{
    NEEDED(c);
    return get_directional(c, unknown, unknowns, known, knowns, along, values);
}

/* --- state ---------------------------------------------------------------------------------- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    NEEDED(c);
    return take_state(c, state);
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    NEEDED(c);
    return give_state(c, state);
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    NEEDED(c);
    free_state(state);
    return fmi2OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    NEEDED(c);
    return state_size(c, state, size);
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    NEEDED(c);
    return write_state(c, state, bytes, size);
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state)
{
    NEEDED(c);
    return read_state(c, bytes, size, state);
}

/* --- status of a step, which is never asynchronous ------------------------------------------- */

#define NO_STATUS(NAME, TYPE)                                                                      \
    fmi2Status NAME(fmi2Component c, const fmi2StatusKind kind, TYPE *value)                       \
    {                                                                                              \
        (void)kind, (void)value;                                                                   \
        NEEDED(c);                                                                                 \
        return fmi2Discard;                                                                        \
    }
NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetStringStatus, fmi2String)

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    NEEDED(c && value);
    if (kind != fmi2LastSuccessfulTime)
        return fmi2Discard;
    *value = M->state->now;
    return fmi2OK;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    NEEDED(c && value);
    if (kind != fmi2Terminated)
        return fmi2Discard;
    *value = fmi2False; /* the FMU never asks to end the simulation */
    return fmi2OK;
}
