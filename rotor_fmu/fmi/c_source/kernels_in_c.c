/* The kernels as C, which wasm2c made of a WebAssembly module: they know one array alone, the memory
   of an instance of that module. A run's block lies in it, with what they are handed behind it. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

#include "kernels.h"
#include "wasm_kernels.h"

enum { PAGE = 65536, HEAD = 64 };
/* Behind the block, each at a multiple of 8. */
enum {
    CODE = 0,
    EXCEPTION = 8,
    GIVEN = 16,
    OWN = GIVEN + 8 * MOST_SETTINGS,
    ARGUMENTS = OWN + 8 * MOST_SETTINGS,
    ROOM = ARGUMENTS + 8 * MESSAGE_NUMBERS
};

typedef struct {
    Z_kernels_instance_t module;
    uint32_t block, room; /* places in its memory */
} Memory;

uint8_t *new_block(size_t size, void **memory)
{
    size_t padded = (size + 7) & ~(size_t)7;
    Memory *m = *memory = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    Z_kernels_init_module();
    Z_kernels_instantiate(&m->module);
    Z_kernelsZ__initialize(&m->module);
    wasm_rt_memory_t *all = Z_kernelsZ_memory(&m->module);
    uint32_t pages = wasm_rt_grow_memory(all, (uint32_t)((HEAD + padded + ROOM) / PAGE + 1));
    if (pages == (uint32_t)-1)
        return NULL;
    m->block = pages * PAGE + HEAD;
    m->room = m->block + (uint32_t)padded;
    memcpy(all->data + m->block - sizeof m, &m, sizeof m); /* where a block finds its module */
    return all->data + m->block;
}

void free_block(void *memory)
{
    Memory *m = memory;
    if (!m)
        return;
    if (Z_kernelsZ_memory(&m->module)->data)
        Z_kernels_free(&m->module);
    free(m);
}

static Memory *memory_of(const uint8_t *block)
{
    Memory *m;
    memcpy(&m, block - sizeof m, sizeof m);
    return m;
}

static void hand_over(const uint8_t *block, int at, const double *numbers, int count)
{
    memcpy((uint8_t *)block + (memory_of(block)->room - memory_of(block)->block) + at, numbers,
           (size_t)count * sizeof(double));
}

static void take_back(const uint8_t *block, int at, void *numbers, size_t size)
{
    memcpy(numbers, block + (memory_of(block)->room - memory_of(block)->block) + at, size);
}

#define MODULE(NAME, BLOCK, ...)                                                                 \
    Z_kernelsZ_##NAME(&memory_of(BLOCK)->module, memory_of(BLOCK)->room + CODE,                  \
                      memory_of(BLOCK)->room + EXCEPTION, memory_of(BLOCK)->block, __VA_ARGS__)
#define AT(BLOCK, PLACE) (memory_of(BLOCK)->room + (PLACE))

/* The numbers of a message, and the result. */
static int32_t returned(const uint8_t *block, uint32_t status, int64_t *code, double *arguments)
{
    if (arguments)
        take_back(block, ARGUMENTS, arguments, MESSAGE_NUMBERS * sizeof *arguments);
    take_back(block, CODE, code, sizeof *code);
    return (int32_t)status;
}

#define KERNEL(NAME, ...)                                                                        \
    int32_t NAME##_kernel(int64_t *code, void **exception, uint8_t *block, __VA_ARGS__)

KERNEL(rotor_resolve_settings, double *given, double *arguments)
{
    (void)exception;
    hand_over(block, GIVEN, given, MOST_SETTINGS);
    uint32_t status = MODULE(rotor_resolve_settings_kernel, block, AT(block, GIVEN),
                             AT(block, ARGUMENTS));
    take_back(block, GIVEN, given, MOST_SETTINGS * sizeof *given);
    return returned(block, status, code, arguments);
}
KERNEL(rotor_settings_warning, double *given, double *own, double *arguments, int64_t slot)
{
    (void)exception;
    hand_over(block, GIVEN, given, MOST_SETTINGS);
    hand_over(block, OWN, own, MOST_SETTINGS);
    uint32_t status = MODULE(rotor_settings_warning_kernel, block, AT(block, GIVEN), AT(block, OWN),
                             AT(block, ARGUMENTS), (uint64_t)slot);
    return returned(block, status, code, arguments);
}
#define WITH_MOTION(NAME)                                                                        \
    KERNEL(NAME, double a, double b, double c)                                                   \
    {                                                                                            \
        (void)exception;                                                                         \
        return returned(block, MODULE(NAME##_kernel, block, a, b, c), code, NULL);               \
    }
WITH_MOTION(rotor_start)
WITH_MOTION(rotor_advance)
KERNEL(rotor_survey, double speed, int64_t is_start)
{
    (void)exception;
    uint32_t status = MODULE(rotor_survey_kernel, block, speed, (uint64_t)is_start);
    return returned(block, status, code, NULL);
}
#define WITH_INTEGER(NAME)                                                                       \
    KERNEL(NAME, int64_t of)                                                                     \
    {                                                                                            \
        (void)exception;                                                                         \
        return returned(block, MODULE(NAME##_kernel, block, (uint64_t)of), code, NULL);          \
    }
WITH_INTEGER(rotor_retune)
WITH_INTEGER(rotor_differentiate)
int32_t rotor_refresh_outputs_kernel(int64_t *code, void **exception, uint8_t *block)
{
    Memory *m = memory_of(block);
    (void)exception;
    uint32_t status = Z_kernelsZ_rotor_refresh_outputs_kernel(&m->module, m->room + CODE,
                                                              m->room + EXCEPTION, m->block);
    return returned(block, status, code, NULL);
}
#define WITH_STATUS(NAME)                                                                        \
    KERNEL(NAME, int64_t of, double *arguments)                                                  \
    {                                                                                            \
        (void)exception;                                                                         \
        return returned(block, MODULE(NAME##_kernel, block, (uint64_t)of, AT(block, ARGUMENTS)), \
                        code, arguments);                                                        \
    }
WITH_STATUS(rotor_no_rest)
WITH_STATUS(rotor_outcome)
#define WITH_NUMBERS(NAME)                                                                       \
    KERNEL(NAME, double *arguments)                                                              \
    {                                                                                            \
        (void)exception;                                                                         \
        return returned(block, MODULE(NAME##_kernel, block, AT(block, ARGUMENTS)), code,         \
                        arguments);                                                              \
    }
WITH_NUMBERS(rotor_growth)
WITH_NUMBERS(rotor_unstable)
WITH_NUMBERS(rotor_hidden)
