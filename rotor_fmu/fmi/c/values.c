/* Values of variables: which may be read and set, and when. */
#include "internal.h"

#include <math.h>
#include <stdio.h>

#include "kernels.h"

/* An enumeration is read and set as an Integer too: so FMI 2.0 does, and hosts that set numbers. */
static int is_of(int64_t own, Kind asked)
{
    return asked == ANY_KIND || own == (int64_t)asked
           || (own == AN_ENUMERATION && asked == AN_INTEGER);
}

static Status check_reference(Instance *m, const char *call, uint32_t reference)
{
    if (reference < m->table->variables)
        return OK;
    return refuse(m, "%s: value reference %lu: there is none; they go to %d", call,
                  (unsigned long)reference, (int)m->table->variables - 1);
}

static Status check_input(Instance *m, const char *call, uint32_t reference)
{
    if (check_reference(m, call, reference))
        return ERROR;
    return reference < m->table->inputs
               ? OK
               : refuse(m, "%s: %s: is not an input", call, name_of(m, reference));
}

static Status check_references(Instance *m, int is_set, Kind kind, const char *name,
                               const uint32_t *references, size_t count, const void *values)
{
    char call[40];
    snprintf(call, sizeof call, "%s%s", is_set ? "set" : "get", name);
    if (count && (!references || !values))
        return refuse(m, "%s: NULL where %zu values are asked for", call, count);
    for (size_t i = 0; i < count; i++) {
        if (check_reference(m, call, references[i]))
            return ERROR;
        int64_t own = variables(m->table)[references[i]].kind;
        if (!is_of(own, kind))
            return refuse(m, "%s: %s: is of type %s", call, name_of(m, references[i]),
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
        if (role < READ || role == TIME)
            continue;
        if (m->state->phase == INSTANTIATED)
            return refuse(m, "%s: is computed, and not before the initialization begins",
                          name_of(m, references[i]));
        if (build(m, 0))
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
        if (v->kind == AN_INTEGER && value > INT32_MAX) /* a counter after days */
            value = INT32_MAX;
        put(values, i, value);
    }
    return OK;
}

/* A number is finite, and no larger in size than what a machine may have; call: named if any. */
static Status check_number(Instance *m, const char *call, uint32_t reference, double value)
{
    const char *name = name_of(m, reference), *colon = *call ? ": " : "";
    char shown[LONGEST] = "";
    if (islessequal(fabs(value), m->table->largest)) /* of a NaN it does not trap */
        return OK;
    add_number(shown, value, 17);
    if (!isfinite(value))
        return refuse(m, "%s%s%s = %s: must be a finite number", call, colon, name, shown);
    return refuse(m, "%s%s%s = %s: must not exceed %g in size", call, colon, name, shown,
                  m->table->largest);
}

static Status check_value(Instance *m, uint32_t reference, double value)
{
    const Variable *v = variables(m->table) + reference;
    const char *name = name_of(m, reference);
    int is_whole = v->kind == AN_INTEGER || v->kind == AN_ENUMERATION;
    if (check_number(m, "", reference, value))
        return ERROR;
    if (v->role >= READ)
        return refuse(m, "%s: is computed and cannot be set", name);
    int is_tunable = v->role == MACHINE && v->at;
    if (is_tunable && m->state->phase == STEPPING && check_parameter(m, v, value))
        return ERROR;
    if (v->role > LOAD && !is_tunable && m->state->phase == STEPPING)
        return refuse(m, "%s: a fixed parameter cannot be set after initialization", name);
    if (is_whole && !(v->low <= value && value <= v->high))
        return refuse(m, "%s = %.17g: must be an integer from %d to %d", name, value, (int)v->low,
                      (int)v->high);
    return OK;
}

/* Any number but 0 is true: hosts of other languages have -1. */
static double as_kind(const Instance *m, uint32_t reference, double value)
{
    return variables(m->table)[reference].kind == A_BOOLEAN ? value != 0.0 : value;
}

static void take_value(Instance *m, uint32_t reference, double value)
{
    if (variables(m->table)[reference].role == MACHINE && m->values[reference] != value)
        m->state->is_retuned = m->state->phase == STEPPING;
    if (reference < m->table->inputs && m->continued[reference] != 0.0) {
        m->slopes[reference] = NAN;
        m->continued[reference] = 0.0;
    }
    m->values[reference] = value;
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
        if (check_value(m, references[i], as_kind(m, references[i], item(values, i))))
            return ERROR;
    for (size_t i = 0; i < count; i++)
        take_value(m, references[i], as_kind(m, references[i], item(values, i)));
    if (m->state->phase != STEPPING)
        m->state->is_built = 0;
    return OK;
}

Status set_slopes(Instance *m, const uint32_t *references, size_t count, const int *orders,
                  const double *values)
{
    const char call[] = "setRealInputDerivatives";
    if (count && (!references || !orders || !values))
        return refuse(m, "%s: NULL where %zu values are given", call, count);
    if (allow(m, call, 1u << INSTANTIATED | 1u << INITIALIZING | 1u << STEPPING))
        return ERROR;
    for (size_t i = 0; i < count; i++) {
        if (check_input(m, call, references[i]))
            return ERROR;
        if (orders[i] != 1)
            return refuse(m, "%s: %s: order %d: must be 1", call, name_of(m, references[i]),
                          orders[i]);
        if (check_number(m, call, references[i], values[i]))
            return ERROR;
    }
    for (size_t i = 0; i < count; i++) {
        m->slopes[references[i]] = values[i];
        m->continued[references[i]] = 0.0;
    }
    if (count && m->state->phase != STEPPING)
        m->state->is_built = 0;
    return OK;
}

/* --- derivatives ------------------------------------------------------------------------------ */

/* The variables whose derivatives are asked for are Reals that the model computes. */
static Status check_computed(Instance *m, const char *call, const uint32_t *references,
                             size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (check_reference(m, call, references[i]))
            return ERROR;
        const Variable *v = variables(m->table) + references[i];
        if (v->kind != A_REAL || (v->role != READ && v->role != REMEMBERED))
            return refuse(m, "%s: %s: is not a Real that is computed", call,
                          name_of(m, references[i]));
    }
    return OK;
}

Status get_derivatives(Instance *m, const char *call, const uint32_t *references, size_t count,
                       const int *orders, double *values)
{
    const Table *t = m->table;
    if (count && (!references || !orders || !values))
        return refuse(m, "%s: NULL where %zu values are asked for", call, count);
    if (allow(m, call, 1u << INITIALIZING | 1u << STEPPING | 1u << TERMINATED)
        || check_computed(m, call, references, count))
        return ERROR;
    for (size_t i = 0; i < count; i++)
        if (orders[i] != 1 && orders[i] != 2)
            return refuse(m, "%s: %s: order %d: must be 1 or 2", call, name_of(m, references[i]),
                          orders[i]);
    const double *derivatives = (const double *)(m->block + t->derivatives);
    const int64_t row = computed(t);
    if (!count)
        return OK;
    if (build(m, 0))
        return ERROR;
    if (rotor_differentiate(m->block, -1))
        return refuse(m, "internal error");
    for (size_t i = 0; i < count; i++)
        values[i] = derivatives[variables(t)[references[i]].at + (orders[i] - 1) * row];
    return OK;
}

Status get_directional(Instance *m, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                       size_t knowns, const double *along, double *values)
{
    static const char call[] = "getDirectionalDerivative";
    const Table *t = m->table;
    if ((unknowns && (!unknown || !values)) || (knowns && (!known || !along)))
        return refuse(m, "%s: NULL where values are given or asked for", call);
    if (allow(m, call, 1u << STEPPING | 1u << TERMINATED))
        return ERROR;
    if (!*(const int64_t *)(m->block + t->has_sensitivities_at))
        return refuse(m, "%s: solver.sensitivities is false; it has to be set before the "
                         "initialization", call);
    if (check_computed(m, call, unknown, unknowns))
        return ERROR;
    for (size_t i = 0; i < unknowns; i++)
        if (variables(t)[unknown[i]].role != READ)
            return refuse(m, "%s: %s: does not follow from the motion of the instant", call,
                          name_of(m, unknown[i]));
    for (size_t i = 0; i < knowns; i++) {
        if (check_input(m, call, known[i]))
            return ERROR;
        if (!isfinite(along[i]))
            return refuse(m, "%s: %s: the seed must be a finite number", call,
                          name_of(m, known[i]));
    }
    for (size_t i = 0; i < unknowns; i++)
        values[i] = 0.0;
    const double *derivatives = (const double *)(m->block + t->derivatives);
    for (size_t k = 0; k < knowns; k++) {
        const Variable *input = variables(t) + known[k];
        if (rotor_differentiate(m->block, input->role == LOAD ? 1 + input->at : 0))
            return refuse(m, "internal error");
        for (size_t i = 0; i < unknowns; i++)
            values[i] += along[k] * derivatives[variables(t)[unknown[i]].at];
    }
    return OK;
}
