/* Values of variables: which may be read and set, and when. */
#include "internal.h"

#include <math.h>
#include <stdio.h>

static Status check_references(Instance *m, int is_set, Kind kind, const char *name,
                               const uint32_t *references, size_t count, const void *values)
{
    const char *call = is_set ? "set" : "get";
    const Table *t = m->table;
    if (count && (!references || !values))
        return refuse(m, "%s%s: NULL where %zu values are asked for", call, name, count);
    for (size_t i = 0; i < count; i++) {
        if (references[i] >= t->variables)
            return refuse(m, "%s%s: value reference %lu: there is none; they go to %d", call, name,
                          (unsigned long)references[i], (int)t->variables - 1);
        int64_t own = variables(t)[references[i]].kind;
        if (own != (int64_t)kind && kind != ANY_KIND)
            return refuse(m, "%s%s: %s: is of type %s", call, name, name_of(m, references[i]),
                          m->skin->kinds[own]);
    }
    return OK;
}

Status get_values(Instance *m, Kind kind, const char *name, const uint32_t *references,
                  size_t count, void *values, Put put)
{
    const Table *t = m->table;
    if (check_references(m, 0, kind, name, references, count, values))
        return ERROR;
    for (size_t i = 0; i < count && !m->state->is_built; i++) {
        int64_t role = variables(t)[references[i]].role;
        if (role != READ && role != INSTANT)
            continue;
        if (m->state->phase == INSTANTIATED)
            return refuse(m, "%s: is computed, and not before the initialization begins",
                          name_of(m, references[i]));
        if (build(m))
            return ERROR;
    }
    const double *observed = (const double *)(m->block + t->observed);
    for (size_t i = 0; i < count; i++) {
        const Variable *v = variables(t) + references[i];
        double value;
        if (v->role == TIME)
            value = m->state->now;
        else if (v->role < READ)
            value = m->values[references[i]];
        else
            value = observed[v->at];
        if (v->role == INSTANT && value >= 0.0)
            value += m->state->start;
        put(values, i, value);
    }
    return OK;
}

static Status check_value(Instance *m, uint32_t reference, double value)
{
    const Variable *v = variables(m->table) + reference;
    const char *name = name_of(m, reference);
    int is_outside = v->kind == AN_INTEGER && !(v->low <= value && value <= v->high);
    char shown[LONGEST] = "";
    if (!isfinite(value) || is_outside)
        add_number(shown, value, 17);
    if (!isfinite(value))
        return refuse(m, "%s = %s: must be a finite number", name, shown);
    if (v->role >= READ)
        return refuse(m, "%s: is computed and cannot be set", name);
    if (v->role > LOAD && m->state->phase == STEPPING)
        return refuse(m, "%s: a fixed parameter cannot be set after initialization", name);
    if (is_outside)
        return refuse(m, "%s = %s: must be an integer from %d to %d", name, shown, (int)v->low,
                      (int)v->high);
    return OK;
}

Status set_values(Instance *m, Kind kind, const char *name, const uint32_t *references,
                  size_t count, const void *values, Item item)
{
    if (check_references(m, 1, kind, name, references, count, values))
        return ERROR;
    if (!count)
        return OK;
    if (m->state->phase > STEPPING) {
        char call[40];
        snprintf(call, sizeof call, "set%s", name);
        return allow(m, call, 1u << INSTANTIATED | 1u << INITIALIZING | 1u << STEPPING);
    }
    for (size_t i = 0; i < count; i++)
        if (check_value(m, references[i], item(values, i)))
            return ERROR;
    for (size_t i = 0; i < count; i++)
        m->values[references[i]] = item(values, i);
    if (m->state->phase != STEPPING)
        m->state->is_built = 0;
    return OK;
}
