/* The run of the values that are set: how it is built, and takes up values that have changed. */
#include "internal.h"

#include <math.h>
#include <string.h>

#include "kernels.h"

Status check_parameter(Instance *m, const Variable *v, double value)
{
    const Table *t = m->table;
    char shown[LONGEST] = "";
    if ((value > v->least || (!v->strict && value == v->least)) && value <= v->most)
        return OK;
    add_number(shown, value, 6);
    return refuse(m, "%s = %s%s: %s", text(t, v->name), shown, text(t, v->unit), text(t, v->rule));
}

static Status check_machine(Instance *m)
{
    const Table *t = m->table;
    const Need *need = (const Need *)((const char *)t + t->first_need);
    for (int64_t i = 0; i < t->observed_at; i++) {
        const Variable *v = variables(t) + i;
        double value = m->values[i];
        if (v->role == REDUCED && value != v->start)
            return refuse(m,
                          "%s = %g: this FMU has %g; build one with --reduction %g",
                          text(t, v->name), value, v->start, value);
        if (v->role != MACHINE || value == v->start)
            continue;
        if (check_parameter(m, v, value))
            return ERROR;
    }
    for (int64_t i = 0; i < t->needs; i++, need++)
        if (m->values[need->variable] > 0 && m->values[need->other] == 0)
            return log_sentence(m, ERROR, text(t, need->sentence), &m->values[need->variable]);
    return OK;
}

static Status resolve_settings(Instance *m, int is_start)
{
    const Table *t = m->table;
    double given[MOST_SETTINGS] = {0}, own[MOST_SETTINGS] = {0}, numbers[MESSAGE_NUMBERS] = {0};
    for (int64_t i = 0; i < t->observed_at; i++) {
        const Variable *v = variables(t) + i;
        if (v->role == SETTING)
            own[v->at] = m->values[i] == v->unset ? NAN : m->values[i] - v->shift;
    }
    memcpy(given, own, sizeof given);
    if (m->state->has_tolerance && isnan(given[t->tolerance_at]))
        given[t->tolerance_at] = m->state->tolerance;
    int code = rotor_resolve_settings(m->block, given, numbers);
    if (code >= t->sentences)
        return refuse(m, "internal error in the solver's settings");
    if (code)
        return log_sentence(m, ERROR, sentence(t, code), numbers);
    for (int64_t slot = 0; is_start && slot < t->settings; slot++)
        if ((code = rotor_settings_warning(m->block, given, own, numbers, slot)) != 0)
            warn(m, code, numbers);
    return OK;
}

/* A variable over its start value; 1 for none. */
static double share_of_start(const Instance *m, int64_t variable)
{
    return variable < 0 ? 1.0 : m->values[variable] / variables(m->table)[variable].start;
}

void warn_beyond_ranges(Instance *m)
{
    const Table *t = m->table;
    const Span *span = (const Span *)((const char *)t + t->first_span);
    double speed = in_block(m, t->omega_at);
    for (int64_t i = 0; i < t->spans; i++, span++) {
        double numbers[] = {speed, span->high, span->reynolds};
        double at = span->of < 0 ? speed : m->values[span->of];
        double wider = share_of_start(m, span->clearance);
        /* Re = density w R c / viscosity, critical at a number over sqrt(c / R) */
        numbers[1] *= share_of_start(m, span->viscosity) / (wider * sqrt(wider));
        numbers[2] /= sqrt(wider);
        if (span->is_of_size)
            at = fabs(at);
        if (!(span->low <= at && at <= numbers[1]))
            warn(m, (int)span->sentence, numbers);
    }
}

void survey(Instance *m, int is_start)
{
    double numbers[MESSAGE_NUMBERS] = {0};
    int code = rotor_survey(m->block, in_block(m, m->table->omega_at), is_start);
    if (!code && is_start && (code = rotor_growth(m->block, numbers)) != 0)
        warn(m, code, numbers);
    if ((code = rotor_unstable(m->block, numbers)) != 0)
        warn(m, code, numbers);
    if ((code = rotor_hidden(m->block, numbers)) != 0)
        warn(m, code, numbers);
}

void take_loads(Instance *m)
{
    double *loads = (double *)(m->block + m->table->loads_at);
    double *rates = (double *)(m->block + m->table->rates_at);
    for (int64_t i = 0; i < m->table->inputs; i++) {
        const Variable *v = variables(m->table) + i;
        if (v->role != LOAD)
            continue;
        loads[v->at] = m->values[i];
        rates[v->at] = isnan(m->slopes[i]) ? 0.0 : m->slopes[i];
    }
}

/* Put the machine's parameters into the block, or those alone that may change during a run. */
static void write_parameters(Instance *m, int are_tunable)
{
    const Table *t = m->table;
    const Write *write = (const Write *)((const char *)t + t->first_write);
    for (int64_t i = 0; i < t->writes; i++, write++) {
        double value = m->values[write->variable];
        if (are_tunable && !variables(t)[write->variable].at)
            continue;
        if (write->integer)
            *(int64_t *)(m->block + write->place) = (int64_t)value;
        else
            *(double *)(m->block + write->place) = value;
    }
}

Status retune(Instance *m)
{
    int code = rotor_retune(m->block, 0);
    write_parameters(m, 1);
    if (code || rotor_retune(m->block, 1))
        return refuse(m, "internal error");
    m->state->is_retuned = 0;
    survey(m, 0);
    return OK;
}

void choose_contacts(Instance *m)
{
    const Table *t = m->table;
    double asked = 0.0;
    const Write *write = (const Write *)((const char *)t + t->first_write);
    for (int64_t i = 0; i < t->writes; i++, write++)
        if (write->place == t->stops_at_contact_at)
            asked = m->values[write->variable];
    *(int64_t *)(m->block + t->stops_at_contact_at) = asked != 0.0 && !m->is_whole;
}

Status build(Instance *m, int is_start)
{
    const Table *t = m->table;
    double drive = m->values[t->drive_at], speed = drive, rate = 0.0, numbers[MESSAGE_NUMBERS] = {0};
    if (m->state->is_built && !is_start)
        return OK;
    m->state->is_built = 0;
    if (check_machine(m))
        return ERROR;
    memcpy(m->block, (const char *)t + t->first_block, (size_t)t->block);
    write_parameters(m, 0);
    m->state->is_retuned = 0;
    choose_contacts(m);
    *(double *)(m->block + t->time_of_host_at) = m->state->start;
    if (resolve_settings(m, is_start))
        return ERROR;
    *(int64_t *)(m->block + t->is_free_at) = t->is_free;
    for (int64_t i = 0; i < t->observed_at; i++) {
        const Variable *v = variables(t) + i;
        if (v->role == RATE)
            rate = m->values[i];
        if (v->role == START_SPEED)
            speed = m->values[i];
        if (v->role == HOLD)
            *(int64_t *)(m->block + t->continues_at) = m->values[i] == 0;
    }
    take_loads(m);
    if (!isnan(m->slopes[t->drive_at]))
        rate = m->slopes[t->drive_at];
    int code = rotor_start(m->block, speed, drive, rate);
    if (code && code != RAISED)
        code = rotor_no_rest(m->block, code, numbers);
    if (code >= t->sentences)
        return refuse(m, "internal error at the start");
    if (code)
        return log_sentence(m, ERROR, sentence(t, code), numbers);
    if (is_start) {
        warn_beyond_ranges(m);
        survey(m, 1);
    }
    m->state->is_built = 1;
    return OK;
}
