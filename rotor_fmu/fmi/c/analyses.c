/* What Python calls of linear answers and periodic motions, which no FMU has. */
#ifndef __wasm__
#include "instance.h"
#include "kernels.h"

int32_t rotor_call_laws_kernel(int64_t *, void **, uint8_t *, double, double, double, double);
int32_t rotor_linearize_laws_kernel(int64_t *, void **, uint8_t *, double);
int32_t rotor_vibrate_laws_kernel(int64_t *, void **, uint8_t *, double, double, double);
int32_t rotor_find_gaps_kernel(int64_t *, void **, uint8_t *);
int32_t rotor_find_invalid_kernel(int64_t *, void **, uint8_t *);
int32_t rotor_step_through_kernel(int64_t *, void **, uint8_t *, double);

EXPORT int rotor_call_laws(
    uint8_t *block, double displacement, double velocity, double rate, double speed
)
{
    CALL(rotor_call_laws, block, displacement, velocity, rate, speed);
}
EXPORT int rotor_linearize_laws(uint8_t *block, double speed)
{
    CALL(rotor_linearize_laws, block, speed);
}
EXPORT int rotor_vibrate_laws(uint8_t *block, double speed, double sliding, double frequency)
{
    CALL(rotor_vibrate_laws, block, speed, sliding, frequency);
}
EXPORT int rotor_find_gaps(uint8_t *block)
{
    CALL(rotor_find_gaps, block);
}
EXPORT int rotor_find_invalid(uint8_t *block)
{
    CALL(rotor_find_invalid, block);
}
EXPORT int rotor_step_through(uint8_t *block, double speed)
{
    CALL(rotor_step_through, block, speed);
}
#endif
