/* The compiled kernels (`library/entry_points.py`), in numba's calling convention: a status that is 0 unless
   the kernel is broken, the result by address, and an unused place for an exception. */
#ifndef ROTOR_KERNELS_H
#define ROTOR_KERNELS_H
#include <stdint.h>

enum { RAISED = 1 << 20 };
/* Of rotor_advance, and what else ends it early is above this (`model/step/step_status.py`). */
enum { UNFINISHED = 3, ENDED_EARLY = 8, CLOSED_EARLY = 11 };

int32_t rotor_resolve_settings_kernel(int64_t *, void **, uint8_t *, double *, double *);
int32_t rotor_settings_warning_kernel(int64_t *, void **, uint8_t *, double *, double *, double *, int64_t);
int32_t rotor_start_kernel(int64_t *, void **, uint8_t *, double, double, double);
int32_t rotor_advance_kernel(int64_t *, void **, uint8_t *, double, double, double);
int32_t rotor_survey_kernel(int64_t *, void **, uint8_t *, double, int64_t);
int32_t rotor_refresh_outputs_kernel(int64_t *, void **, uint8_t *);
int32_t rotor_retune_kernel(int64_t *, void **, uint8_t *, int64_t);
int32_t rotor_differentiate_kernel(int64_t *, void **, uint8_t *, int64_t);
int32_t rotor_no_rest_kernel(int64_t *, void **, uint8_t *, int64_t, double *);
int32_t rotor_growth_kernel(int64_t *, void **, uint8_t *, double *);
int32_t rotor_unstable_kernel(int64_t *, void **, uint8_t *, double *);
int32_t rotor_hidden_kernel(int64_t *, void **, uint8_t *, double *);
int32_t rotor_outcome_kernel(int64_t *, void **, uint8_t *, int64_t, double *);

/* Kernels compute as IEEE 754 has it by default, whatever the host has chosen for itself: traps,
   another rounding, denormals as 0. */
#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
typedef unsigned int Arithmetic;
static inline Arithmetic default_arithmetic(void)
{
    Arithmetic hosts = _mm_getcsr();
    _mm_setcsr(0x1f80);
    return hosts;
}
static inline void give_back(Arithmetic hosts)
{
    _mm_setcsr(hosts);
}
#elif defined(__aarch64__) && defined(__GNUC__)
typedef uint64_t Arithmetic;
static inline Arithmetic default_arithmetic(void)
{
    Arithmetic hosts, none = 0;
    __asm__ volatile("mrs %0, fpcr" : "=r"(hosts));
    __asm__ volatile("msr fpcr, %0" : : "r"(none));
    return hosts;
}
static inline void give_back(Arithmetic hosts)
{
    __asm__ volatile("msr fpcr, %0" : : "r"(hosts));
}
#else
typedef int Arithmetic;
static inline Arithmetic default_arithmetic(void)
{
    return 0;
}
static inline void give_back(Arithmetic hosts)
{
    (void)hosts;
}
#endif

/* A status or the code of a sentence, 0 where all is well. */
#define CALL(NAME, ...)                                                                          \
    int64_t code = 0;                                                                            \
    void *exception = 0;                                                                         \
    Arithmetic hosts = default_arithmetic();                                                     \
    int is_raised = NAME##_kernel(&code, &exception, __VA_ARGS__);                               \
    give_back(hosts);                                                                            \
    return is_raised ? RAISED : (int)code

static inline int rotor_resolve_settings(uint8_t *block, double *given, double *arguments)
{
    CALL(rotor_resolve_settings, block, given, arguments);
}
static inline int rotor_settings_warning(uint8_t *block, double *given, double *own, double *arguments, int64_t slot)
{
    CALL(rotor_settings_warning, block, given, own, arguments, slot);
}
static inline int rotor_no_rest(uint8_t *block, int status, double *arguments)
{
    CALL(rotor_no_rest, block, status, arguments);
}
static inline int rotor_growth(uint8_t *block, double *arguments)
{
    CALL(rotor_growth, block, arguments);
}
static inline int rotor_unstable(uint8_t *block, double *arguments)
{
    CALL(rotor_unstable, block, arguments);
}
static inline int rotor_hidden(uint8_t *block, double *arguments)
{
    CALL(rotor_hidden, block, arguments);
}
static inline int rotor_outcome(uint8_t *block, int status, double *arguments)
{
    CALL(rotor_outcome, block, status, arguments);
}

/* Of a run, exported too (`model/kernels/library.py`). */
int rotor_start(uint8_t *block, double speed, double drive, double rate);
int rotor_advance(uint8_t *block, double t, double drive, double rate);
int rotor_survey(uint8_t *block, double speed, int64_t is_start);
int rotor_refresh_outputs(uint8_t *block);
int rotor_retune(uint8_t *block, int64_t is_changed);
int rotor_differentiate(uint8_t *block, int64_t row);
#endif
