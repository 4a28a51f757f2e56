/* An FMU of FMI 2.0 that computes nothing: what a host costs by itself. */
#include <stddef.h>

#define IDLE(NAME)                                                                               \
    int NAME(void *m)                                                                            \
    {                                                                                            \
        (void)m;                                                                                 \
        return 0;                                                                                \
    }

const char *fmi2GetTypesPlatform(void)
{
    return "default";
}
const char *fmi2GetVersion(void)
{
    return "2.0";
}
void *fmi2Instantiate(const char *name)
{
    static int instance;
    (void)name;
    return &instance;
}
void fmi2FreeInstance(void *m)
{
    (void)m;
}
/* Callers hand over more arguments, which the platform's convention lets a function ignore. */
IDLE(fmi2SetDebugLogging)
IDLE(fmi2SetupExperiment)
IDLE(fmi2EnterInitializationMode)
IDLE(fmi2ExitInitializationMode)
IDLE(fmi2Terminate)
IDLE(fmi2Reset)
IDLE(fmi2GetReal)
IDLE(fmi2GetInteger)
IDLE(fmi2GetBoolean)
IDLE(fmi2GetString)
IDLE(fmi2SetReal)
IDLE(fmi2SetInteger)
IDLE(fmi2SetBoolean)
IDLE(fmi2SetString)
IDLE(fmi2GetFMUstate)
IDLE(fmi2SetFMUstate)
IDLE(fmi2FreeFMUstate)
IDLE(fmi2SerializedFMUstateSize)
IDLE(fmi2SerializeFMUstate)
IDLE(fmi2DeSerializeFMUstate)
IDLE(fmi2GetDirectionalDerivative)
IDLE(fmi2SetRealInputDerivatives)
IDLE(fmi2GetRealOutputDerivatives)
IDLE(fmi2DoStep)
IDLE(fmi2CancelStep)
IDLE(fmi2GetStatus)
IDLE(fmi2GetRealStatus)
IDLE(fmi2GetIntegerStatus)
IDLE(fmi2GetBooleanStatus)
IDLE(fmi2GetStringStatus)
