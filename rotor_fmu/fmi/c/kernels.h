/* The compiled kernels (`library/entry_points.py`), in numba's calling convention: a status that is 0 unless
   the kernel is broken, the result by address, and an unused place for an exception. */
#ifndef ROTOR_KERNELS_H
#define ROTOR_KERNELS_H
#include <stdint.h>

enum { BROKEN = 1 << 20 };
enum { UNFINISHED = 3 }; /* of rotor_advance (`model/march/march.py`) */

int32_t rotor_settle_kernel(int64_t *, void **, uint8_t *, double *, double *);
int32_t rotor_doubt_kernel(int64_t *, void **, uint8_t *, double *, double *, double *, int64_t);
int32_t rotor_start_kernel(int64_t *, void **, uint8_t *, double, double, double);
int32_t rotor_advance_kernel(int64_t *, void **, uint8_t *, double, double, double);
int32_t rotor_survey_kernel(int64_t *, void **, uint8_t *, double, int64_t);
int32_t rotor_look_kernel(int64_t *, void **, uint8_t *);
int32_t rotor_no_rest_kernel(int64_t *, void **, uint8_t *, int64_t, double *);
int32_t rotor_growth_kernel(int64_t *, void **, uint8_t *, double *);
int32_t rotor_hidden_kernel(int64_t *, void **, uint8_t *, double *);
int32_t rotor_outcome_kernel(int64_t *, void **, uint8_t *, int64_t, double *);

/* A status or the code of a sentence, 0 where all is well. */
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
static inline int rotor_no_rest(uint8_t *block, int status, double *told)
{
    CALL(rotor_no_rest, block, status, told);
}
static inline int rotor_growth(uint8_t *block, double *told)
{
    CALL(rotor_growth, block, told);
}
static inline int rotor_hidden(uint8_t *block, double *told)
{
    CALL(rotor_hidden, block, told);
}
static inline int rotor_outcome(uint8_t *block, int status, double *told)
{
    CALL(rotor_outcome, block, status, told);
}

/* Of a run, exported too (`model/kernels/library.py`). */
int rotor_start(uint8_t *block, double speed, double drive, double rate);
int rotor_advance(uint8_t *block, double t, double drive, double rate);
int rotor_survey(uint8_t *block, double speed, int64_t is_start);
int rotor_look(uint8_t *block);
#endif
