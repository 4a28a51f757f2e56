/* The life of an instance, and which call its phase allows. See instance.h. Where the standard leaves
   a choice: a call that is refused changes nothing, so that the host may go on after it; values that
   a host may set can be read in every phase. */
#include "internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char RECOVER[] = "reset the FMU, or set a state from before";

size_t head_size(const Instance *m)
{
    return sizeof(State) + (size_t)(m->table->observed_at + 2 * m->table->inputs) * sizeof(double);
}

void forget_slopes(Instance *m)
{
    for (int64_t i = 0; i < m->table->inputs; i++) {
        m->slopes[i] = NAN;
        m->continued[i] = 0.0;
    }
}

void begin_anew(Instance *m)
{
    const Table *t = m->table;
    memset(m->state, 0, head_size(m));
    memcpy(m->state->guid, t->guid, sizeof t->guid);
    for (int64_t i = 0; i < t->observed_at; i++)
        m->values[i] = variables(t)[i].start;
    forget_slopes(m);
    memset(m->warned, 0, sizeof m->warned);
    m->limit_at = NAN;
}

static Instance *refused(Instance *m, const char *message)
{
    refuse(m, "%s", message);
    destroy(m);
    return NULL;
}

/* An instance that can speak, and nothing more. */
static Instance *named(const char *name, int is_logging, const Skin *skin, void *host,
                       void *environment)
{
    const char *called = name && *name ? name : "rotor";
    Instance *m = calloc(1, sizeof *m);
    if (!m || !(m->name = malloc(strlen(called) + 1))) {
        free(m);
        return NULL;
    }
    strcpy(m->name, called);
    m->skin = skin;
    m->host = host;
    m->environment = environment;
    m->categories = is_logging ? ~0u : 0u;
    return m;
}

/* The same with room for a run of its table's machine. */
static Instance *furnished(Instance *m)
{
    m->state = calloc(1, head_size(m));
    m->block = new_block((size_t)m->table->block, &m->memory);
    if (!m->state || !m->block)
        return refused(m, "out of memory");
    m->values = (double *)(m->state + 1);
    m->slopes = m->values + m->table->observed_at;
    m->continued = m->slopes + m->table->inputs;
    begin_anew(m);
    return m;
}

Instance *create(const char *name, const char *guid, const char *resources, int is_logging,
                 const Skin *skin, void *host, void *environment, const char *unfit)
{
    char why[LONGEST] = "out of memory";
    Instance *m = named(name, is_logging, skin, host, environment);
    if (!m)
        return NULL;
    if (unfit)
        return refused(m, unfit);
    m->file = read_table(resources, why, sizeof why);
    m->table = m->file;
    if (!m->table)
        return refused(m, why);
    if (!guid || strncmp(guid, m->table->guid, sizeof m->table->guid))
        return refused(m, "instantiate: the GUID is not this FMU's");
    return furnished(m);
}

Instance *create_of_table(const char *name, const void *table, size_t size, int is_logging,
                          const Skin *skin, void *host, void *environment)
{
    Instance *m = named(name, is_logging, skin, host, environment);
    const char *fault = check_table(table, size);
    if (m && fault) {
        refuse(m, "%s: %s", TABLE_FILE, fault);
        destroy(m);
    }
    if (!m || fault)
        return NULL;
    m->table = table;
    return furnished(m);
}

void destroy(Instance *m)
{
    if (!m)
        return;
    free(m->state);
    free(m->before);
    free_block(m->memory);
    free(m->file);
    free(m->name);
    free(m);
}

Status allow(Instance *m, const char *call, unsigned phases)
{
    State *s = m->state;
    if (phases & 1u << s->phase)
        return OK;
    switch (s->phase) {
    case INSTANTIATED:
        return refuse(m, "%s: the initialization has not begun", call);
    case INITIALIZING:
        return refuse(m, "%s: the initialization has %s", call,
                      phases & 1u << INSTANTIATED ? "begun" : "not ended");
    case STEPPING:
        return refuse(m, "%s: the initialization has ended", call);
    case FAILED:
        return refuse(m, "%s: an earlier step failed (%s); %s", call, s->failure, RECOVER);
    default:
        return refuse(m, "%s: the simulation was terminated; %s", call, RECOVER);
    }
}
