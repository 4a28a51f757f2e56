/* The compiled kernels (`native/flat.py`), in numba's calling convention: a status that is 0 unless
   the kernel is broken, the result by address, and an unused place for an exception. */
#ifndef ROTOR_KERNELS_H
#define ROTOR_KERNELS_H
#include <stdint.h>

enum { BROKEN = 1 << 20 };

int32_t rotor_settle_kernel(int64_t *, void **, uint8_t *, double *, double *);
int32_t rotor_doubt_kernel(int64_t *, void **, uint8_t *, double *, double *, double *, int64_t);
int32_t rotor_start_kernel(int64_t *, void **, uint8_t *, double, double, double, double *);
int32_t rotor_advance_kernel(int64_t *, void **, uint8_t *, double, double, double, double *);
int32_t rotor_look_kernel(int64_t *, void **, uint8_t *);

/* The code of a sentence, 0 where all is well. */
#define CALL(NAME, ...)                                                                          \
    int64_t code = 0;                                                                            \
    void *exception = 0;                                                                         \
    return NAME##_kernel(&code, &exception, __VA_ARGS__) ? BROKEN : (int)code

static inline int rotor_settle(uint8_t *block, double *given, double *told)
{
    CALL(rotor_settle, block, given, told);
}
static inline int rotor_doubt(uint8_t *block, double *given, double *own, double *told, int64_t slot)
{
    CALL(rotor_doubt, block, given, own, told, slot);
}
static inline int rotor_start(uint8_t *block, double speed, double drive, double rate, double *told)
{
    CALL(rotor_start, block, speed, drive, rate, told);
}
static inline int rotor_advance(uint8_t *block, double t, double drive, double rate, double *told)
{
    CALL(rotor_advance, block, t, drive, rate, told);
}
static inline int rotor_look(uint8_t *block)
{
    CALL(rotor_look, block);
}
#endif
