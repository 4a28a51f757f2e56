/* The run: it is built of the values that are set, and goes on from step to step. */
#include "internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "kernels.h"

/* What a master's time may be off by, in communication steps: its round-off, its idea of the end. */
static const double SLACK = 1e-6, SLACK_AT_STOP = 1e-3;
/* Spacings of the numbers near t, and seconds, that a step has to span. */
static const double RESOLVED = 4.0, SHORTEST = 1e-15;

Status check_parameter(Instance *m, const Variable *v, double value)
{
    const Table *t = m->table;
    char shown[LONGEST] = "";
    if (fabs(value) > t->largest)
        return refuse(m, "%s: must not exceed %g in size", text(t, v->name), t->largest);
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

static Status resolve_settings(Instance *m)
{
    const Table *t = m->table;
    double given[MOST_SETTINGS] = {0}, own[MOST_SETTINGS] = {0}, numbers[TOLD] = {0};
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
    for (int64_t slot = 0; slot < t->settings; slot++)
        if ((code = rotor_settings_warning(m->block, given, own, numbers, slot)) != 0)
            warn(m, code, numbers);
    return OK;
}

static void warn_beyond_tables(Instance *m)
{
    const Table *t = m->table;
    const Span *span = (const Span *)((const char *)t + t->first_span);
    double speed = in_block(m, t->omega_at);
    for (int64_t i = 0; i < t->spans; i++, span++) {
        double at = span->is_of_size ? fabs(speed) : speed;
        if (!(span->low <= at && at <= span->high))
            warn(m, (int)span->sentence, &speed);
    }
}

/* Look for what grows up to the present speed, and warn of it. */
static void survey(Instance *m, int is_start)
{
    double numbers[TOLD] = {0};
    int code = rotor_survey(m->block, in_block(m, m->table->omega_at), is_start);
    if (!code && is_start && (code = rotor_growth(m->block, numbers)) != 0)
        warn(m, code, numbers);
    if ((code = rotor_unstable(m->block, numbers)) != 0)
        warn(m, code, numbers);
    if ((code = rotor_hidden(m->block, numbers)) != 0)
        warn(m, code, numbers);
}

/* Hand the inputs over, but the drive. */
static void take_loads(Instance *m)
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

void forget_slopes(Instance *m)
{
    for (int64_t i = 0; i < m->table->inputs; i++) {
        m->slopes[i] = NAN;
        m->continued[i] = 0.0;
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

/* Take up parameters that were changed since the last step; the ledger counts what that does. */
static Status retune(Instance *m)
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

Status build(Instance *m)
{
    const Table *t = m->table;
    double drive = m->values[t->drive_at], speed = drive, rate = 0.0, numbers[TOLD] = {0};
    if (m->state->is_built)
        return OK;
    if (check_machine(m))
        return ERROR;
    memcpy(m->block, (const char *)t + t->first_block, (size_t)t->block);
    write_parameters(m, 0);
    m->state->is_retuned = 0;
    choose_contacts(m);
    *(double *)(m->block + t->time_of_host_at) = m->state->start;
    if (resolve_settings(m))
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
    warn_beyond_tables(m);
    survey(m, 1);
    m->state->is_built = 1;
    return OK;
}

/* Distance from x >= 0 to the next number. */
static double spacing_at(double x)
{
    uint64_t bits;
    double next;
    memcpy(&bits, &x, sizeof bits);
    bits++;
    memcpy(&next, &bits, sizeof next);
    return next - x;
}

static Status check_step(Instance *m, double current, double size)
{
    State *s = m->state;
    const char *early = s->failure; /* of the last step, if it ended early */
    double now = s->now, here = fabs(now), there = fabs(now + size), spacing;
    if (!(size > 0 && isfinite(size)))
        return refuse(m, "doStep over %g s: the step must be > 0 and finite", size);
    spacing = spacing_at(here > there ? here : there);
    if (size < RESOLVED * spacing || size < SHORTEST)
        return refuse(m,
                      "doStep over %g s: near t = %.15g s time is a multiple of %.2g s; the step "
                      "must be at least %.2g s",
                      size, now, spacing,
                      RESOLVED * spacing > SHORTEST ? RESOLVED * spacing : SHORTEST);
    if (!(fabs(current - now) <= (SLACK * size > 2 * spacing ? SLACK * size : 2 * spacing)))
        return refuse(m,
                      "doStep from %.15g s: the FMU stands at %.15g s; communication steps must "
                      "follow each other without gap or overlap%s%s",
                      current, now, *early ? "; the last one ended early: " : "", early);
    spacing = SLACK_AT_STOP * size > 2 * spacing ? SLACK_AT_STOP * size : 2 * spacing;
    if (s->has_stop && current + size > s->stop + spacing)
        return refuse(m, "doStep to %.15g s: past the stop time, %.15g s", current + size, s->stop);
    return OK;
}

/* Make the inputs what they have come to at the time reached, with the slopes that they go on with:
   a host that sets none of them anew goes on with the step that it began. */
static void continue_inputs(Instance *m)
{
    const Table *t = m->table;
    const double *loads = (const double *)(m->block + t->loads_at);
    m->values[t->drive_at] = in_block(m, t->is_free ? t->torque_at : t->omega_at);
    if (!t->is_free && isnan(m->slopes[t->drive_at]))
        m->slopes[t->drive_at] = in_block(m, t->alpha_at);
    for (int64_t i = 0; i < t->inputs; i++) {
        const Variable *v = variables(t) + i;
        if (v->role == LOAD)
            m->values[i] = loads[v->at];
        m->continued[i] = !isnan(m->slopes[i]);
    }
}

/* A step that took more iterations than it may, or came upon a limit or a contact: how far. */
static Status stop_early(Instance *m, const char *why, int is_limit)
{
    State *s = m->state;
    if (m->is_whole) {
        if (give_state(m, m->before))
            return ERROR;
    } else {
        s->now = s->start + in_block(m, m->table->time_at);
        if (is_limit)
            m->limit_at = s->now;
        continue_inputs(m);
        snprintf(s->failure, sizeof s->failure, "%s", why);
    }
    return log_text(m, DISCARD, why);
}

static Status fail(Instance *m, const char *why)
{
    snprintf(m->state->failure, sizeof m->state->failure, "%s", why);
    m->state->phase = FAILED;
    return refuse(m, "%s", m->state->failure);
}

static Status take_step(Instance *m, double current, double size)
{
    State *s = m->state;
    const Table *t = m->table;
    double numbers[TOLD] = {0}, speed;
    if (allow(m, "doStep", 1u << STEPPING) || check_step(m, current, size))
        return ERROR;
    if (m->is_whole && take_state(m, &m->before))
        return ERROR;
    if (s->is_retuned && retune(m))
        return ERROR;
    take_loads(m);
    /* told of before, whether the host went on from there or came there again by a state */
    if (fabs(s->now - m->limit_at) <= SLACK * size)
        *(int64_t *)(m->block + t->is_past_limit_at) = 1;
    int status = rotor_advance(m->block, current - s->start + size, m->values[t->drive_at],
                               m->slopes[t->drive_at]);
    int code = status;
    if (status && status != RAISED) /* for what it may have come to */
        rotor_survey(m->block, in_block(m, t->surveyed_at), 0);
    if (status != RAISED)
        code = rotor_outcome(m->block, status, numbers);
    if (code > 0) {
        char why[LONGEST] = "internal error in a step";
        if (code < t->sentences)
            spell(why, sentence(t, code), numbers);
        add_start(m, why);
        int is_early = status == UNFINISHED || (status > ENDED_EARLY && status != RAISED);
        int is_limit = status > ENDED_EARLY && status < CLOSED_EARLY;
        return is_early ? stop_early(m, why, is_limit) : fail(m, why);
    }
    forget_slopes(m);
    s->failure[0] = 0;
    if (code < 0)
        warn(m, -code, numbers);
    warn_beyond_tables(m);
    speed = fabs(in_block(m, t->omega_at));
    if (!(in_block(m, t->surveyed_from) <= speed && speed <= in_block(m, t->surveyed_to)))
        survey(m, 0);
    s->now = current + size;
    return OK;
}

Status advance_to(Instance *m, double current, double size)
{
    Arithmetic hosts = default_arithmetic(); /* times are added up here */
    Status status = take_step(m, current, size);
    give_back(hosts);
    return status;
}

Status set_slopes(Instance *m, const uint32_t *references, size_t count, const int *orders,
                  const double *values)
{
    const Table *t = m->table;
    const char call[] = "setRealInputDerivatives";
    if (count && (!references || !orders || !values))
        return refuse(m, "%s: NULL where %zu values are given", call, count);
    if (allow(m, call, 1u << INSTANTIATED | 1u << INITIALIZING | 1u << STEPPING))
        return ERROR;
    for (size_t i = 0; i < count; i++) {
        char shown[LONGEST] = "";
        if (check_input(m, call, references[i]))
            return ERROR;
        if (orders[i] != 1)
            return refuse(m, "%s: %s: order %d: must be 1", call, name_of(m, references[i]),
                          orders[i]);
        add_number(shown, values[i], 17);
        if (!isfinite(values[i]))
            return refuse(m, "%s: %s = %s: must be a finite number", call,
                          name_of(m, references[i]), shown);
    }
    for (size_t i = 0; i < count; i++) {
        m->slopes[references[i]] = values[i];
        m->continued[references[i]] = 0.0;
    }
    if (count && m->state->phase != STEPPING)
        m->state->is_built = 0;
    return OK;
}
