/* FMI 2.0 for co-simulation, over instance.h; types and functions as in section 2 and 4 of the
   standard. */
#include <stdio.h>

#include "instance.h"

typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef char fmi2Char, fmi2Byte;
typedef const fmi2Char *fmi2String;
typedef int fmi2Status, fmi2StatusKind, fmi2Type;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;
enum { CO_SIMULATION = 1, LAST_SUCCESSFUL_TIME = 2, TERMINATED_KIND = 3 };

#define NEEDED(c)                                                                                \
    if (!(c))                                                                                    \
    return ERROR
#define M ((Instance *)c)

static void emit(Instance *m, Status status, const char *category, const char *message)
{
    const fmi2CallbackFunctions *host = m->host;
    if (host && host->logger)
        host->logger(m->environment, m->name, status, category, "%s", message);
}
static const Skin SKIN = {emit, {"Real", "Integer", "Boolean", "Enumeration"}};

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}
EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                     fmi2String resources, const fmi2CallbackFunctions *functions,
                                     fmi2Boolean visible, fmi2Boolean logging)
{
    (void)visible;
    if (type != CO_SIMULATION) {
        fprintf(stderr, "instantiate: the FMU is for co-simulation alone\n");
        return NULL;
    }
    return create(name, guid, resources, logging, &SKIN, (void *)functions,
                  functions ? functions->componentEnvironment : NULL);
}
EXPORT void fmi2FreeInstance(fmi2Component c)
{
    destroy(c);
}
EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                                      const fmi2String categories[])
{
    NEEDED(c);
    return choose_categories(c, on, count, categories);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance,
                                      fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop,
                                      fmi2Real stop)
{
    NEEDED(c);
    return set_up(c, start, has_stop, stop, has_tolerance, tolerance);
}
EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    NEEDED(c);
    return enter(c);
}
EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    NEEDED(c);
    return leave_initialization(c);
}
EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    NEEDED(c);
    return terminate(c);
}
EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    NEEDED(c);
    begin_anew(c);
    return OK;
}
EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real current, fmi2Real size, fmi2Boolean no_set)
{
    (void)no_set;
    NEEDED(c);
    return advance_to(c, current, size);
}
EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    NEEDED(c);
    return refuse(c, "cancelStep: no step is under way, steps are not asynchronous");
}

/* --- values --------------------------------------------------------------------------------- */

/* Integers, enumerations and Booleans can be read as Reals too, as some masters do with every output. */
#define VALUES(READ, KIND, TYPE, NAME)                                                           \
    static void put##NAME(void *values, size_t i, double value)                                  \
    {                                                                                            \
        ((TYPE *)values)[i] = (TYPE)value;                                                       \
    }                                                                                            \
    static double item##NAME(const void *values, size_t i)                                       \
    {                                                                                            \
        return (double)((const TYPE *)values)[i];                                                \
    }                                                                                            \
    EXPORT fmi2Status fmi2Get##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n,    \
                                    TYPE values[])                                               \
    {                                                                                            \
        NEEDED(c);                                                                               \
        return get_values(c, READ, #NAME, vr, n, values, put##NAME);                             \
    }                                                                                            \
    EXPORT fmi2Status fmi2Set##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n,    \
                                    const TYPE values[])                                         \
    {                                                                                            \
        NEEDED(c);                                                                               \
        return set_values(c, KIND, #NAME, vr, n, values, item##NAME);                            \
    }
VALUES(ANY_KIND, A_REAL, fmi2Real, Real)
VALUES(AN_INTEGER, AN_INTEGER, fmi2Integer, Integer)
VALUES(A_BOOLEAN, A_BOOLEAN, fmi2Boolean, Boolean)

/* There are no Strings, so that every reference is refused before a value is touched. */
EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                fmi2String values[])
{
    NEEDED(c);
    return get_values(c, NO_KIND, "String", vr, n, values, NULL);
}
EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                const fmi2String values[])
{
    NEEDED(c);
    return set_values(c, NO_KIND, "String", vr, n, values, NULL);
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                              size_t n, const fmi2Integer order[],
                                              const fmi2Real values[])
{
    NEEDED(c);
    return set_slopes(c, vr, n, order, values);
}
EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                               size_t n, const fmi2Integer order[],
                                               fmi2Real values[])
{
    NEEDED(c);
    return get_derivatives(c, "getRealOutputDerivatives", vr, n, order, values);
}
EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                               size_t unknowns, const fmi2ValueReference known[],
                                               size_t knowns, const fmi2Real along[],
                                               fmi2Real values[])
{
    NEEDED(c);
    return get_directional(c, unknown, unknowns, known, knowns, along, values);
}

/* --- state ---------------------------------------------------------------------------------- */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    NEEDED(c);
    return take_state(c, state);
}
EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    NEEDED(c);
    return give_state(c, state);
}
EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    NEEDED(c);
    free_state(state);
    return OK;
}
EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    NEEDED(c);
    if (!state || !size)
        return refuse(c, "serializedFMUstateSize: NULL given");
    *size = state_size(state);
    return OK;
}
EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                        size_t size)
{
    NEEDED(c);
    return write_state(c, state, bytes, size);
}
EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                          fmi2FMUstate *state)
{
    NEEDED(c);
    return read_state(c, bytes, size, state);
}

/* --- status of a step, which is never asynchronous ------------------------------------------- */

#define NO_STATUS(NAME, TYPE)                                                                    \
    EXPORT fmi2Status NAME(fmi2Component c, const fmi2StatusKind kind, TYPE *value)              \
    {                                                                                            \
        (void)kind, (void)value;                                                                 \
        NEEDED(c);                                                                               \
        return DISCARD;                                                                          \
    }
NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetStringStatus, fmi2String)

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    NEEDED(c &&value);
    if (kind != LAST_SUCCESSFUL_TIME)
        return DISCARD;
    *value = M->state->now;
    return OK;
}
EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind,
                                       fmi2Boolean *value)
{
    NEEDED(c &&value);
    if (kind != TERMINATED_KIND)
        return DISCARD;
    *value = 0; /* the FMU never asks to end the simulation */
    return OK;
}
