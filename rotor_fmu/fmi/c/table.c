/* The table of a machine: whether it is whole, and says what can be. */
#include "internal.h"

#include <string.h>

uint64_t checksum(const void *content, size_t size, size_t but)
{
    const unsigned char *from = content;
    uint64_t sum = 0xcbf29ce484222325u, word;
    for (size_t at = 0; at + 8 <= size; at += 8) {
        if (at == but)
            continue;
        memcpy(&word, from + at, 8);
        sum = (sum ^ word) * 0x9e3779b97f4a7c15u;
        sum ^= sum >> 29;
    }
    return sum;
}

/* Whether so many entries of a size lie within, from a place that is a multiple of 8. */
static int fits(int64_t at, int64_t count, int64_t size, int64_t within)
{
    return at >= 0 && at % 8 == 0 && count >= 0 && at <= within && count <= (within - at) / size;
}

static int is_within(int64_t i, int64_t count)
{
    return i >= 0 && i < count;
}

static int is_none_or_within(int64_t i, int64_t count)
{
    return i == -1 || is_within(i, count);
}

/* Whether a text begins there: the last of them ends with zeros, and the variables follow. */
static int is_text(const Table *t, int64_t at)
{
    return at >= (int64_t)sizeof *t && at < t->first_variable;
}

static int is_variable_sound(const Table *t, const Variable *v)
{
    int64_t reals = t->inputs - 1, count = 1; /* of what the role says that `at` counts */
    if (!is_text(t, v->name) || !is_text(t, v->unit) || !is_text(t, v->rule))
        return 0;
    if (v->role == LOAD)
        count = reals;
    else if (v->role == MACHINE)
        count = 2;
    else if (v->role == SETTING)
        count = t->settings;
    else if (v->role == READ || v->role == REMEMBERED || v->role == INSTANT)
        count = t->variables - t->observed_at;
    return is_within(v->kind, NO_KIND) && is_within(v->role, ROLES) && is_within(v->at, count);
}

/* Whether the parts of the file follow one another behind the texts, the block up to the end. */
static int are_parts_sound(const Table *t)
{
    const int64_t parts[][3] = {{t->first_variable, t->variables, sizeof(Variable)},
                                {t->first_write, t->writes, sizeof(Write)},
                                {t->first_need, t->needs, sizeof(Need)},
                                {t->first_sentence, t->sentences, sizeof(int64_t)},
                                {t->first_span, t->spans, sizeof(Span)},
                                {t->first_block, t->block, 1}};
    int64_t at = t->first_variable;
    if (at <= (int64_t)sizeof *t)
        return 0;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (parts[i][0] != at || !fits(at, parts[i][1], parts[i][2], t->bytes))
            return 0;
        at += parts[i][1] * parts[i][2];
    }
    return at == t->bytes;
}

/* Whether all that is counted and pointed to lies where it has to. */
static int is_sound(const Table *t)
{
    const char *file = (const char *)t;
    int64_t computed = t->variables - t->observed_at;
    if (!is_within(t->observed_at, t->variables) || t->inputs < 1 || t->inputs > t->observed_at
        || !is_within(t->drive_at, t->inputs) || t->settings > MOST_SETTINGS
        || !is_within(t->tolerance_at, t->settings) || t->tangent_bytes > t->block)
        return 0;
    if (!are_parts_sound(t) || file[t->first_variable - 1]
        || !fits(0, t->state_bytes, 1, t->tangent_bytes))
        return 0;
    const int64_t places[] = {t->is_free_at,
                              t->continues_at,
                              t->stops_at_contact_at,
                              t->has_sensitivities_at,
                              t->is_past_limit_at,
                              t->time_at,
                              t->time_of_host_at,
                              t->omega_at,
                              t->alpha_at,
                              t->torque_at,
                              t->surveyed_at,
                              t->surveyed_from,
                              t->surveyed_to};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        if (!fits(places[i], 1, sizeof(double), t->block))
            return 0;
    if (!fits(t->loads_at, t->inputs - 1, sizeof(double), t->block)
        || !fits(t->rates_at, t->inputs - 1, sizeof(double), t->block)
        || !fits(t->observed, computed, sizeof(double), t->block)
        || !fits(t->derivatives, 2 * computed, sizeof(double), t->block))
        return 0;
    int has_tolerance = 0;
    for (int64_t i = 0; i < t->variables; i++) {
        const Variable *v = variables(t) + i;
        if (!is_variable_sound(t, v))
            return 0;
        has_tolerance |= v->role == SETTING && v->at == t->tolerance_at;
    }
    if (!has_tolerance)
        return 0;
    const Write *write = (const Write *)(file + t->first_write);
    for (int64_t i = 0; i < t->writes; i++, write++)
        if (!is_within(write->variable, t->observed_at)
            || !fits(write->place, 1, sizeof(double), t->block))
            return 0;
    const Need *need = (const Need *)(file + t->first_need);
    for (int64_t i = 0; i < t->needs; i++, need++)
        if (!is_within(need->variable, t->observed_at) || !is_within(need->other, t->observed_at)
            || !is_text(t, need->sentence))
            return 0;
    const Span *span = (const Span *)(file + t->first_span);
    for (int64_t i = 0; i < t->spans; i++, span++)
        if (!is_within(span->sentence, t->sentences) || !is_none_or_within(span->of, t->observed_at)
            || !is_none_or_within(span->viscosity, t->observed_at)
            || !is_none_or_within(span->clearance, t->observed_at))
            return 0;
    for (int64_t i = 0; i < t->sentences; i++)
        if (!is_text(t, ((const int64_t *)(file + t->first_sentence))[i]))
            return 0;
    return 1;
}

const char *check_table(const void *content, size_t size)
{
    const Table *table = content;
    if (size < sizeof *table || memcmp(table->magic, "ROTORFMU", 8)
        || (size_t)table->bytes != size || size % 8)
        return "is not the table of a machine, or is truncated";
    if (memcmp(table->sources, SOURCES, sizeof table->sources))
        return "was made for another build of this FMU's library";
    if (checksum(table, size, offsetof(Table, checksum)) != table->checksum || !is_sound(table))
        return "is damaged";
    return NULL;
}
