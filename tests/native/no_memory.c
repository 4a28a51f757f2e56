/* A host whose memory is out once: no_memory LIBRARY RESOURCES TOKEN
   In run k the k-th allocation fails, in run 0 none, and a call that fails is made once more. A line
   for each run: how many calls failed, whether one failed twice, a digest of the state after a step,
   and how many blocks of memory are left. */
#include "fmi3Functions.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);
void __libc_free(void *);

static int is_counting, blocks, allocations, fails_at;

static int is_out(void)
{
    return is_counting && ++allocations == fails_at;
}
static void *counted(void *block, const void *before)
{
    blocks += is_counting && block && !before;
    return block;
}
void *malloc(size_t size)
{
    return is_out() ? NULL : counted(__libc_malloc(size), NULL);
}
void *calloc(size_t count, size_t size)
{
    return is_out() ? NULL : counted(__libc_calloc(count, size), NULL);
}
void *realloc(void *block, size_t size)
{
    return is_out() ? NULL : counted(__libc_realloc(block, size), block);
}
void free(void *block)
{
    blocks -= is_counting && block;
    __libc_free(block);
}

#define TWICE(IS_DONE)                                                                             \
    if (!(IS_DONE)) {                                                                              \
        failed++;                                                                                  \
        failed_twice |= !(IS_DONE);                                                                \
    }
#define OF(NAME, ...) (((NAME##TYPE *)dlsym(library, #NAME))(__VA_ARGS__))

int main(int argc, char **argv)
{
    void *library = dlopen(argv[1], RTLD_NOW);
    if (argc != 4 || !library)
        return 2;
    for (fails_at = 0; fails_at <= allocations; fails_at++) {
        int failed = 0, failed_twice = 0;
        fmi3Instance m;
        fmi3FMUState state = NULL;
        fmi3ValueReference drive = 0;
        fmi3Float64 value = 300.0, reached;
        fmi3Boolean no;
        fmi3Byte *bytes = malloc(1 << 20);
        size_t size = 0;
        unsigned long sum = 0;
        fprintf(stderr, "run %d\n", fails_at); /* what the C library allocates for it is not ours */
        allocations = blocks = 0;
        is_counting = 1;
        TWICE(m = OF(fmi3InstantiateCoSimulation, "rotor", argv[3], argv[2], 0, 0, 0, 0, NULL, 0,
                     NULL, NULL, NULL));
        TWICE(!OF(fmi3SetFloat64, m, &drive, 1, &value, 1));
        TWICE(!OF(fmi3EnterInitializationMode, m, 0, 0.0, 0.0, 0, 0.0));
        TWICE(!OF(fmi3ExitInitializationMode, m));
        TWICE(!OF(fmi3DoStep, m, 0.0, 1e-3, 1, &no, &no, &no, &reached));
        TWICE(!OF(fmi3GetFMUState, m, &state));
        TWICE(!OF(fmi3SerializedFMUStateSize, m, state, &size));
        TWICE(!OF(fmi3SerializeFMUState, m, state, bytes, size));
        OF(fmi3FreeFMUState, m, &state);
        TWICE(!OF(fmi3DeserializeFMUState, m, bytes, size, &state));
        TWICE(!OF(fmi3SetFMUState, m, state));
        TWICE(!OF(fmi3DoStep, m, 1e-3, 1e-3, 1, &no, &no, &no, &reached));
        OF(fmi3FreeFMUState, m, &state);
        OF(fmi3FreeInstance, m);
        is_counting = 0;
        for (size_t i = 0; i < size; i++)
            sum = 31 * sum + bytes[i];
        free(bytes);
        printf("%d %d %lu %d\n", failed, failed_twice, sum, blocks);
    }
    return 0;
}
