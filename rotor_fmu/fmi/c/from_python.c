/* What Python calls: a run without an FMU around it, and the instance of the FMU in Python. */
#include "instance.h"
#include "kernels.h"

EXPORT int rotor_start(uint8_t *block, double speed, double drive, double rate)
{
    CALL(rotor_start, block, speed, drive, rate);
}
EXPORT int rotor_advance(uint8_t *block, double t, double drive, double rate)
{
    CALL(rotor_advance, block, t, drive, rate);
}
EXPORT int rotor_survey(uint8_t *block, double speed, int64_t is_start)
{
    CALL(rotor_survey, block, speed, is_start);
}
EXPORT int rotor_refresh_outputs(uint8_t *block)
{
    CALL(rotor_refresh_outputs, block);
}

EXPORT int rotor_retune(uint8_t *block, int64_t is_changed)
{
    CALL(rotor_retune, block, is_changed);
}
EXPORT int rotor_differentiate(uint8_t *block, int64_t row)
{
    CALL(rotor_differentiate, block, row);
}

typedef void (*Receive)(void *environment, int status, const char *message);
static void receive(Instance *m, Status status, const char *category, const char *message)
{
    (void)category;
    ((Receive)(uintptr_t)m->host)(m->environment, status, message);
}
static const Skin SKIN = {receive, {"Real", "Integer", "Boolean", "Enumeration"}};
/* An instance whose messages go to `receiver`; the rest of its life is FMI 2.0's functions. */
EXPORT Instance *rotor_instantiate(const char *name, const void *table, size_t size, Receive receiver,
                                   void *environment)
{
    return create_of_table(name, table, size, 1, &SKIN, (void *)(uintptr_t)receiver, environment);
}
