/* A run as it is called from Python, without an FMU around it. */
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
EXPORT int rotor_look(uint8_t *block)
{
    CALL(rotor_look, block);
}
