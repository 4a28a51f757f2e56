/* The life of an instance, and which call its phase allows. See instance.h. Where the standard leaves
   a choice: a call that is refused changes nothing, so that the host may go on after it; values that
   a host may set can be read in every phase. */
#include "internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char RECOVER[] = "reset the FMU, or set a state from before";

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

/* The variable of one of the solver's settings. */
static const Variable *setting(const Table *t, int64_t at)
{
    const Variable *v = variables(t);
    while (v->role != SETTING || v->at != at)
        v++;
    return v;
}

Status set_up(Instance *m, const char *call, double start, int has_stop, double stop,
              int has_tolerance, double tolerance)
{
    State *s = m->state;
    if (allow(m, call, 1u << INSTANTIATED))
        return ERROR;
    if (!isfinite(start))
        return refuse(m, "%s: start time = %g: must be finite", call, start);
    if (has_stop && !(stop >= start))
        return refuse(m, "%s: stop time = %g s: must not lie before the start time, %g s", call,
                      stop, start);
    const Variable *rule = setting(m->table, m->table->tolerance_at);
    if (has_tolerance && !(tolerance > 0 && tolerance <= rule->most))
        return refuse(m, "%s: tolerance = %g: %s", call, tolerance, text(m->table, rule->rule));
    if (has_tolerance && tolerance < rule->least) { /* hosts give one for all FMUs of a system */
        warn_of(m, "%s: tolerance = %g: %g is taken, the least that can be held "
                   "[tolerance-raised]",
                call, tolerance, rule->least);
        tolerance = rule->least;
    }
    s->start = s->now = start;
    s->has_stop = has_stop != 0;
    s->stop = has_stop ? stop : 0.0;
    s->has_tolerance = has_tolerance != 0;
    s->tolerance = has_tolerance ? tolerance : 0.0;
    return OK;
}

Status enter(Instance *m)
{
    if (allow(m, "enterInitializationMode", 1u << INSTANTIATED))
        return ERROR;
    m->state->phase = INITIALIZING;
    return OK;
}

Status leave_initialization(Instance *m)
{
    if (allow(m, "exitInitializationMode", 1u << INITIALIZING) || build(m))
        return ERROR;
    m->state->phase = STEPPING;
    return m->is_whole ? take_state(m, &m->before) : OK; /* steps then need no memory */
}

Status terminate(Instance *m)
{
    if (allow(m, "terminate", 1u << STEPPING | 1u << FAILED))
        return ERROR;
    m->state->phase = TERMINATED;
    return OK;
}
