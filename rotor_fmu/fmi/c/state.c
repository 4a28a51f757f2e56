/* The state of an instance, kept and given back, as bytes too. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

#include "kernels.h"

size_t state_size(const Instance *m)
{
    const Table *t = m->table;
    return sizeof(State) + (size_t)(t->observed_at + t->inputs) * sizeof(double)
           + (size_t)t->state_bytes;
}

void free_state(void **state)
{
    if (!state)
        return;
    free(*state);
    *state = NULL;
}

static uint8_t *run_in(const Instance *m, void *state)
{
    return (uint8_t *)state + state_size(m) - m->table->state_bytes;
}

Status take_state(Instance *m, void **state)
{
    size_t size = state_size(m);
    if (!state)
        return refuse(m, "getFMUstate: NULL given");
    void *room = realloc(*state, size); /* what is given may be of another instance */
    if (!room)
        return refuse(m, "getFMUstate: out of memory");
    *state = room;
    memcpy(room, m->state, size);
    if (m->state->is_built)
        memcpy(run_in(m, *state), m->block, (size_t)m->table->state_bytes);
    ((State *)*state)->bytes = size;
    return OK;
}

Status give_state(Instance *m, const void *state)
{
    const State *given = state;
    const Table *t = m->table;
    if (!given)
        return refuse(m, "setFMUstate: NULL given");
    if (memcmp(given->guid, t->guid, sizeof t->guid) || given->bytes != state_size(m))
        return refuse(m, "the FMU state comes from another build of this FMU");
    memcpy(m->state, given, given->bytes);
    if (given->is_built) {
        /* what is scratch in the block has to be there too */
        memcpy(m->block, (const char *)t + t->first_block, (size_t)t->block);
        memcpy(m->block, run_in(m, m->state), (size_t)t->state_bytes);
        if (rotor_refresh_outputs(m->block))
            return refuse(m, "internal error");
    }
    return OK;
}

Status write_state(Instance *m, const void *state, void *bytes, size_t size)
{
    if (!state || !bytes)
        return refuse(m, "serializeFMUstate: NULL given");
    if (size < state_size(m))
        return refuse(m, "serializeFMUstate: %zu bytes given, %zu needed", size, state_size(m));
    uint64_t sum = checksum(state, state_size(m), offsetof(State, checksum));
    memcpy(bytes, state, state_size(m));
    memcpy((char *)bytes + offsetof(State, checksum), &sum, sizeof sum); /* it may lie anywhere */
    return OK;
}

Status read_state(Instance *m, const void *bytes, size_t size, void **state)
{
    State head;
    if (!bytes || !state)
        return refuse(m, "deSerializeFMUstate: NULL given");
    memset(&head, 0, sizeof head);
    memcpy(&head, bytes, size < sizeof head ? size : sizeof head);
    if (size < sizeof head || head.bytes != size)
        return refuse(m, "the FMU state is truncated or corrupted");
    void *copy = malloc(size);
    if (!copy)
        return refuse(m, "deSerializeFMUstate: out of memory");
    memcpy(copy, bytes, size);
    if (size % 8 || checksum(copy, size, offsetof(State, checksum)) != head.checksum) {
        free(copy);
        return refuse(m, "the FMU state is truncated or corrupted");
    }
    if (memcmp(head.guid, m->table->guid, sizeof head.guid) || size != state_size(m)) {
        free(copy);
        return refuse(m, "the FMU state comes from another build of this FMU");
    }
    free(*state);
    *state = copy;
    return OK;
}
