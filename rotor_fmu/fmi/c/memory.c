/* Memory of a run, in which kernels of machine code work; `c_source/` has another for kernels in C. */
#include "internal.h"

#include <stdlib.h>

enum { ALIGNMENT = 64 };

uint8_t *new_block(size_t size, void **memory)
{
    *memory = malloc(size + ALIGNMENT);
    if (!*memory)
        return NULL;
    return (uint8_t *)(((uintptr_t)*memory + ALIGNMENT - 1) & ~(uintptr_t)(ALIGNMENT - 1));
}

void free_block(void *memory)
{
    free(memory);
}
