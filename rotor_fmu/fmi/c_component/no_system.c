/* What an instance asks of its system, as a component has it, which asks for no WASI: the table of the
   machine lies in its memory, behind what the linker laid out, where `library/component.py` puts it;
   there is no standard error, and messages go to the host's logger alone. */
#include "internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PAGE = 65536 };
extern const uint8_t __heap_end; /* where the linked memory ends */

Table *read_table(const char *resources, char *why, size_t room)
{
    (void)resources;
    const Table *table = (const Table *)&__heap_end;
    size_t most = __builtin_wasm_memory_size(0) * PAGE - (size_t)table;
    size_t size = most < sizeof *table ? 0 : (size_t)table->bytes;
    const char *fault = check_table(table, size <= most ? size : 0);
    Table *copy = fault ? NULL : malloc(size);
    if (fault)
        snprintf(why, room, "%s: %s", TABLE_FILE, fault);
    return copy ? memcpy(copy, table, size) : NULL;
}

void write_error(const char *name, const char *level, const char *message)
{
    (void)name, (void)level, (void)message;
}
