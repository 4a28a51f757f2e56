/* The state of an instance, kept and given back, as bytes too. */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

#include "kernels.h"

static size_t size_of(const void *state)
{
    return (size_t)((const State *)state)->bytes;
}

Status state_size(Instance *m, const void *state, size_t *size)
{
    if (!state || !size)
        return refuse(m, "serializedFMUstateSize: NULL given");
    *size = size_of(state);
    return OK;
}

/* Whether a state is of this size. */
static int is_size(const Instance *m, uint64_t bytes)
{
    return bytes == head_size(m) + (size_t)m->table->state_bytes
           || bytes == head_size(m) + (size_t)m->table->tangent_bytes;
}

void free_state(void **state)
{
    if (!state)
        return;
    free(*state);
    *state = NULL;
}

/* How much of the block is the run: the tangents belong to it where they are asked for. */
static size_t run_size(const Instance *m)
{
    const Table *t = m->table;
    int has_tangents = m->state->is_built && *(const int64_t *)(m->block + t->has_sensitivities_at);
    return (size_t)(has_tangents ? t->tangent_bytes : t->state_bytes);
}

Status take_state(Instance *m, void **state)
{
    size_t head = head_size(m), run = run_size(m);
    if (!state)
        return refuse(m, "getFMUstate: NULL given");
    uint8_t *room = *state;
    if (!room || size_of(room) != head + run) /* what is given may be of another instance */
        room = realloc(room, head + run);
    if (!room)
        return refuse(m, "out of memory for a state");
    *state = room;
    memcpy(room, m->state, head);
    if (m->state->is_built)
        memcpy(room + head, m->block, run);
    else
        memset(room + head, 0, run);
    ((State *)*state)->bytes = head + run;
    return OK;
}

Status give_state(Instance *m, const void *state)
{
    const State *given = state;
    const Table *t = m->table;
    size_t head = head_size(m);
    if (!given)
        return refuse(m, "setFMUstate: NULL given");
    if (memcmp(given->guid, t->guid, sizeof t->guid) || !is_size(m, given->bytes))
        return refuse(m, "the FMU state comes from another build of this FMU");
    memcpy(m->state, given, head);
    if (given->is_built) {
        /* what is scratch in the block has to be there too */
        memcpy(m->block, (const char *)t + t->first_block, (size_t)t->block);
        memcpy(m->block, (const uint8_t *)state + head, given->bytes - head);
        choose_contacts(m);
        if (rotor_refresh_outputs(m->block))
            return refuse(m, "internal error");
    }
    return OK;
}

Status write_state(Instance *m, const void *state, void *bytes, size_t size)
{
    if (!state || !bytes)
        return refuse(m, "serializeFMUstate: NULL given");
    size_t needed = size_of(state);
    if (size < needed)
        return refuse(m, "serializeFMUstate: %zu bytes given, %zu needed", size, needed);
    uint64_t sum = checksum(state, needed, offsetof(State, checksum));
    memcpy(bytes, state, needed);
    memcpy((char *)bytes + offsetof(State, checksum), &sum, sizeof sum); /* it may lie anywhere */
    return OK;
}

Status read_state(Instance *m, const void *bytes, size_t size, void **state)
{
    State head;
    if (!bytes || !state)
        return refuse(m, "deSerializeFMUstate: NULL given");
    if (size >= sizeof head)
        memcpy(&head, bytes, sizeof head);
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
    if (memcmp(head.guid, m->table->guid, sizeof head.guid) || !is_size(m, size)) {
        free(copy);
        return refuse(m, "the FMU state comes from another build of this FMU");
    }
    *state = copy; /* what it held before is none of this function's business */
    return OK;
}
