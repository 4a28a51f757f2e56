/* A simulation: its setup, its steps, its end. */
#include "internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "kernels.h"

/* What a master's time may be off by, in communication steps: its round-off, its idea of the end. */
static const double SLACK = 1e-6, SLACK_AT_STOP = 1e-3;
/* Spacings of the numbers near t, and seconds, that a step has to span. */
static const double RESOLVED = 4.0, SHORTEST = 1e-15;

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
    if (has_stop && !isgreaterequal(stop, start)) /* of a NaN it does not trap */
        return refuse(m, "%s: stop time = %g s: must not lie before the start time, %g s", call,
                      stop, start);
    const Variable *rule = setting(m->table, m->table->tolerance_at);
    if (has_tolerance && !(isgreater(tolerance, 0) && tolerance <= rule->most))
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
    if (allow(m, "exitInitializationMode", 1u << INITIALIZING) || build(m, 1)
        || (m->is_whole && take_state(m, &m->before))) /* steps then need no memory */
        return ERROR;
    m->state->phase = STEPPING;
    return OK;
}

Status terminate(Instance *m)
{
    if (allow(m, "terminate", 1u << STEPPING | 1u << FAILED))
        return ERROR;
    m->state->phase = TERMINATED;
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
    log_text(m, m->returns_early ? OK : DISCARD, why);
    return DISCARD;
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
    double numbers[MESSAGE_NUMBERS] = {0}, speed;
    if (allow(m, "doStep", 1u << STEPPING) || check_step(m, current, size))
        return ERROR;
    if (m->is_whole && take_state(m, &m->before))
        return ERROR;
    if (s->is_retuned && retune(m))
        return ERROR;
    take_loads(m);
    /* reported before, whether the host went on from there or came there again by a state */
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
    warn_beyond_ranges(m);
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
