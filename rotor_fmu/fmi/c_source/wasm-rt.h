/* What C that wasm2c 1.0.32 made asks of its surroundings, and no more: one memory an instance, no
   signals, no imports. */
#ifndef WASM_RT_H_
#define WASM_RT_H_
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef __GNUC__
#define UNLIKELY(x) __builtin_expect(!!(x), 0)
#define LIKELY(x) __builtin_expect(!!(x), 1)
#else
#define UNLIKELY(x) (x)
#define LIKELY(x) (x)
#endif
#define wasm_rt_memcpy memcpy

/* gcc calls libm's sqrt for the errno of negative numbers, and FMPy links no libm. */
#if defined(__SSE2__)
#include <emmintrin.h>
static inline double root(double x)
{
    return _mm_cvtsd_f64(_mm_sqrt_sd(_mm_set_sd(x), _mm_set_sd(x)));
}
#define sqrt root
#elif defined(__aarch64__)
#include <arm_neon.h>
static inline double root(double x)
{
    return vget_lane_f64(vsqrt_f64(vdup_n_f64(x)), 0);
}
#define sqrt root
#endif

/* No check of every address: the kernels are those of the libraries, which have none. */
#define WASM_RT_MEMCHECK_SIGNAL_HANDLER 1
#define WASM_RT_USE_STACK_DEPTH_COUNT 0

typedef enum {
    WASM_RT_TRAP_NONE,
    WASM_RT_TRAP_OOB,
    WASM_RT_TRAP_INT_OVERFLOW,
    WASM_RT_TRAP_DIV_BY_ZERO,
    WASM_RT_TRAP_INVALID_CONVERSION,
    WASM_RT_TRAP_UNREACHABLE,
    WASM_RT_TRAP_CALL_INDIRECT,
    WASM_RT_TRAP_EXHAUSTION
} wasm_rt_trap_t;
typedef enum { WASM_RT_I32, WASM_RT_I64, WASM_RT_F32, WASM_RT_F64 } wasm_rt_type_t;
typedef void (*wasm_rt_function_ptr_t)(void);
typedef struct {
    uint32_t func_type;
    wasm_rt_function_ptr_t func;
    void *module_instance;
} wasm_rt_funcref_t;
typedef void *wasm_rt_externref_t;
static const wasm_rt_externref_t wasm_rt_externref_null_value = NULL;
typedef struct {
    uint8_t *data;
    uint32_t pages, max_pages;
    uint64_t size;
} wasm_rt_memory_t;
typedef struct {
    wasm_rt_funcref_t *data;
    uint32_t max_size, size;
} wasm_rt_funcref_table_t;
typedef struct {
    wasm_rt_externref_t *data;
    uint32_t max_size, size;
} wasm_rt_externref_table_t;

/* A kernel divided an integer by zero, say: machine code would end as hard. */
static inline void wasm_rt_trap(wasm_rt_trap_t trap)
{
    (void)trap;
    abort();
}
static inline int wasm_rt_is_initialized(void)
{
    return 1;
}
/* No function is called by its address: there is nothing that types are compared for. */
static inline uint32_t wasm_rt_register_func_type(uint32_t parameters, uint32_t results, ...)
{
    (void)parameters;
    (void)results;
    return 1;
}
static inline void wasm_rt_allocate_memory(wasm_rt_memory_t *m, uint32_t pages, uint32_t most)
{
    m->data = calloc(pages, 65536);
    m->pages = m->data ? pages : 0;
    m->max_pages = most;
    m->size = (uint64_t)m->pages * 65536;
}
static inline uint32_t wasm_rt_grow_memory(wasm_rt_memory_t *m, uint32_t more)
{
    uint32_t before = m->pages;
    size_t size = ((size_t)before + more) * 65536;
    uint8_t *data = m->data ? realloc(m->data, size) : NULL;
    if (!data)
        return (uint32_t)-1;
    memset(data + m->size, 0, size - (size_t)m->size);
    m->data = data;
    m->pages += more;
    m->size = size;
    return before;
}
static inline void wasm_rt_free_memory(wasm_rt_memory_t *m)
{
    free(m->data);
    m->data = NULL;
}
static inline void wasm_rt_allocate_funcref_table(wasm_rt_funcref_table_t *t, uint32_t size,
                                                  uint32_t most)
{
    t->data = calloc(size, sizeof *t->data);
    t->size = t->data ? size : 0;
    t->max_size = most;
}
static inline void wasm_rt_free_funcref_table(wasm_rt_funcref_table_t *t)
{
    free(t->data);
}
#endif
