/* See instance.h. Where the standard leaves a choice: a call that is refused changes nothing, so
   that the host may go on after it; values that a host may set can be read in every phase. */
#include "instance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kernels.h"
#include "table.h"

enum { LONGEST = 704, TOLD = 16, MOST_SETTINGS = 64, ALIGNMENT = 64 };
/* What a master's time may be off by, in communication steps: its round-off, its idea of the end. */
static const double SLACK = 1e-6, SLACK_AT_STOP = 1e-3;
static const double RESOLVED = 100.0; /* spacings of the numbers near t that a step has to span */
static const double HUGE_VALUE = 1e30; /* beyond it, products of such numbers overflow */
static const char RECOVER[] = "reset the FMU, or set a state from before";
const char *const CATEGORIES[CATEGORY_COUNT] = {"logAll",          "logStatusWarning",
                                                "logStatusDiscard", "logStatusError",
                                                "logStatusFatal",   "logStatusPending"};

static const char *text(const Table *t, int64_t at)
{
    return (const char *)t + at;
}
static const Variable *variables(const Table *t)
{
    return (const Variable *)((const char *)t + t->first_variable);
}
static const char *name_of(const Instance *m, uint32_t reference)
{
    return text(m->table, variables(m->table)[reference].name);
}
static const char *sentence(const Table *t, int64_t code)
{
    return text(t, ((const int64_t *)((const char *)t + t->first_sentence))[code]);
}

/* --- what the host is told ------------------------------------------------------------------ */

/* Errors and warnings go to standard error too, since hosts drop them unless logging is on. */
static void told(Instance *m, Status status, char *message)
{
    const char *level = status == WARNING ? "warning" : "error";
    int category = status == WARNING ? 1 : 3;
    for (char *c = message; *c; c++)
        if (*c == '%' || *c == '\n') /* hosts read it as a printf format */
            *c = ' ';
    fprintf(stderr, "%s: %s: %s\n", m->name, level, message);
    fflush(stderr);
    if (m->tell && m->categories & (1u | 1u << category))
        m->tell(m, status, CATEGORIES[category], message);
}

Status refuse(Instance *m, const char *format, ...)
{
    char message[LONGEST];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    told(m, ERROR, message);
    return ERROR;
}

static void add(char *out, const char *more)
{
    size_t used = strlen(out);
    snprintf(out + used, LONGEST - used, "%s", more);
}

static void add_number(char *out, double value, int digits)
{
    char shown[40];
    if (isfinite(value))
        snprintf(shown, sizeof shown, "%.*g", digits, value);
    else
        strcpy(shown, isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
    add(out, shown);
}

/* Of texts between '?' or '|' and the next of these or '}' the one of this number, from 0. */
static void add_choice(char *out, const char *texts, int number)
{
    char plain[2] = {0, 0};
    for (; number > 0 && *texts != '}'; number--)
        for (texts++; *texts != '|' && *texts != '}';)
            texts++;
    while (*texts != '}' && *++texts != '|' && *texts != '}') {
        plain[0] = *texts;
        add(out, plain);
    }
}

/* A sentence of the table with its numbers: {g}, {.4g}, {d} for an integer, and {?one|other}. */
static void spell(char *out, const char *pattern, const double *numbers)
{
    out[0] = 0;
    for (const char *c = pattern; *c; c++) {
        const char *end = *c == '{' ? strchr(c, '}') : NULL;
        char plain[2] = {*c, 0};
        if (end && c[1] == '?') {
            add_choice(out, c + 1, (int)*numbers++);
            c = end;
        } else if (end) {
            add_number(out, *numbers++, c[1] == 'd' ? 17 : c[1] == '.' ? atoi(c + 2) : 6);
            c = end;
        } else {
            add(out, plain);
        }
    }
}

static Status say(Instance *m, Status status, const char *pattern, const double *numbers)
{
    char message[LONGEST];
    spell(message, pattern, numbers);
    told(m, status, message);
    return status;
}

static void warn(Instance *m, int code, const double *numbers)
{
    if (code < 0 || code >= m->table->sentences)
        return;
    if (!m->warned[code % WARNINGS])
        say(m, WARNING, sentence(m->table, code), numbers);
    m->warned[code % WARNINGS] = 1;
}

static double in_block(const Instance *m, int64_t place)
{
    return *(const double *)(m->block + place);
}

static void warn_beyond_tables(Instance *m)
{
    const Table *t = m->table;
    const Span *span = (const Span *)((const char *)t + t->first_span);
    double speed = in_block(m, t->omega_at);
    for (int64_t i = 0; i < t->spans; i++, span++)
        if (!(span->low <= speed && speed <= span->high))
            warn(m, (int)span->sentence, &speed);
}

/* Look for what grows up to the present speed, and warn of it. */
static void survey(Instance *m, int is_start)
{
    double numbers[TOLD] = {0};
    int code = rotor_survey(m->block, in_block(m, m->table->omega_at), is_start);
    if (!code && is_start && (code = rotor_growth(m->block, numbers)) != 0)
        warn(m, code, numbers);
    if ((code = rotor_hidden(m->block, numbers)) != 0)
        warn(m, code, numbers);
}

Status choose_categories(Instance *m, int is_on, size_t count, const char *const *names)
{
    unsigned chosen = count ? 0 : ~0u;
    for (size_t i = 0; i < count; i++) {
        int found = -1;
        for (int k = 0; k < CATEGORY_COUNT && names && names[i]; k++)
            if (!strcmp(names[i], CATEGORIES[k]))
                found = k;
        if (found < 0)
            return refuse(m, "setDebugLogging: no category of that name");
        chosen |= 1u << found;
    }
    m->categories = is_on ? m->categories | chosen : m->categories & ~chosen;
    return OK;
}

/* --- life ----------------------------------------------------------------------------------- */

void begin_anew(Instance *m)
{
    const Table *t = m->table;
    memset(m->state, 0, state_size(m));
    memcpy(m->state->guid, t->guid, sizeof t->guid);
    for (int64_t i = 0; i < t->observed_at; i++)
        m->values[i] = variables(t)[i].start;
    memset(m->warned, 0, sizeof m->warned);
}

static Instance *refused(Instance *m, const char *message)
{
    refuse(m, "%s", message);
    destroy(m);
    return NULL;
}

Instance *create(const char *name, const char *guid, const char *resources, int is_logging,
                 Tell tell, void *host, void *environment)
{
    char why[LONGEST] = "out of memory";
    const char *called = name && *name ? name : "rotor";
    Instance *m = calloc(1, sizeof *m);
    if (!m || !(m->name = malloc(strlen(called) + 1))) {
        free(m);
        return NULL;
    }
    strcpy(m->name, called);
    m->tell = tell;
    m->host = host;
    m->environment = environment;
    m->categories = is_logging ? ~0u : 0u;
    m->file = read_table(resources, why, sizeof why);
    const Table *t = m->table = m->file;
    if (!t)
        return refused(m, why);
    if (!guid || strncmp(guid, t->guid, sizeof t->guid))
        return refused(m, "instantiate: the GUID is not this FMU's");
    m->state = calloc(1, state_size(m));
    m->memory = malloc((size_t)t->block + ALIGNMENT);
    if (!m->state || !m->memory)
        return refused(m, "out of memory");
    m->values = (double *)(m->state + 1);
    m->block = (uint8_t *)(((uintptr_t)m->memory + ALIGNMENT - 1) & ~(uintptr_t)(ALIGNMENT - 1));
    begin_anew(m);
    return m;
}

void destroy(Instance *m)
{
    if (!m)
        return;
    free(m->state);
    free(m->memory);
    free(m->file);
    free(m->name);
    free(m);
}

static Status allow(Instance *m, const char *call, unsigned phases)
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

Status set_up(Instance *m, double start, int has_stop, double stop, int has_tolerance,
              double tolerance)
{
    State *s = m->state;
    if (allow(m, "setupExperiment", 1u << INSTANTIATED))
        return ERROR;
    if (!isfinite(start))
        return refuse(m, "setupExperiment: start time = %g: must be finite", start);
    if (has_stop && !(stop >= start))
        return refuse(m,
                      "setupExperiment: stop time = %g s: must not lie before the start time, "
                      "%g s",
                      stop, start);
    if (has_tolerance && !(tolerance > 0 && tolerance <= 1))
        return refuse(m, "setupExperiment: tolerance = %g: must be > 0 and at most 1", tolerance);
    s->start = s->now = start;
    s->has_stop = has_stop != 0;
    s->stop = has_stop ? stop : 0.0;
    s->has_tolerance = has_tolerance != 0;
    s->tolerance = has_tolerance ? tolerance : 0.0;
    return OK;
}

/* --- the run -------------------------------------------------------------------------------- */

static Status check_machine(Instance *m)
{
    const Table *t = m->table;
    const Need *need = (const Need *)((const char *)t + t->first_need);
    for (int64_t i = 0; i < t->observed_at; i++) {
        const Variable *v = variables(t) + i;
        double value = m->values[i];
        char shown[LONGEST] = "";
        if (v->role == REDUCTION && value != v->start)
            return refuse(m,
                          "%s = %g: this FMU has %g; build one with --reduction %g",
                          text(t, v->name), value, v->start, value);
        if (v->role != MACHINE || value == v->start)
            continue;
        if (fabs(value) > HUGE_VALUE)
            return refuse(m, "%s: must not exceed 1e+30 in size", text(t, v->name));
        if (value > v->least || (!v->strict && value == v->least))
            continue;
        add_number(shown, value, 6);
        return refuse(m, "%s = %s%s: %s", text(t, v->name), shown, text(t, v->unit),
                      text(t, v->rule));
    }
    for (int64_t i = 0; i < t->needs; i++, need++)
        if (m->values[need->variable] > 0 && m->values[need->other] == 0)
            return say(m, ERROR, text(t, need->sentence), &m->values[need->variable]);
    return OK;
}

static Status settle(Instance *m)
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
    int code = rotor_settle(m->block, given, numbers);
    if (code >= t->sentences)
        return refuse(m, "internal error in the solver's settings");
    if (code)
        return say(m, ERROR, sentence(t, code), numbers);
    for (int64_t i = 0; i < t->observed_at; i++) {
        const Variable *v = variables(t) + i;
        if (v->role == SETTING && v->kind == A_REAL && m->values[i] != v->unset
            && m->values[i] > v->high)
            return refuse(m, "%s = %g: must be at most %g", text(t, v->name), m->values[i],
                          v->high);
    }
    for (int64_t slot = 0; slot < t->settings; slot++)
        if ((code = rotor_doubt(m->block, given, own, numbers, slot)) != 0)
            warn(m, code, numbers);
    return OK;
}

static void take_loads(Instance *m)
{
    double *loads = (double *)(m->block + m->table->loads_at);
    for (int64_t i = 0; i < m->table->observed_at; i++) {
        const Variable *v = variables(m->table) + i;
        if (v->role == LOAD)
            loads[v->at] = m->values[i];
        else if (v->role > LOAD)
            break;
    }
}

/* The run from the values that are set now. */
static Status build(Instance *m)
{
    const Table *t = m->table;
    const Write *write = (const Write *)((const char *)t + t->first_write);
    double drive = m->values[t->drive_at], speed = drive, rate = 0.0, numbers[TOLD] = {0};
    if (m->state->is_built)
        return OK;
    if (check_machine(m))
        return ERROR;
    memcpy(m->block, (const char *)t + t->first_block, (size_t)t->block);
    for (int64_t i = 0; i < t->writes; i++, write++) {
        double value = m->values[write->variable];
        if (write->integer)
            *(int64_t *)(m->block + write->place) = (int64_t)value;
        else
            *(double *)(m->block + write->place) = value;
    }
    if (settle(m))
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
    int code = rotor_start(m->block, speed, drive, rate);
    if (code && code != BROKEN)
        code = rotor_no_rest(m->block, code, numbers);
    if (code >= t->sentences)
        return refuse(m, "internal error at the start");
    if (code)
        return say(m, ERROR, sentence(t, code), numbers);
    warn_beyond_tables(m);
    survey(m, 1);
    m->state->is_built = 1;
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
    double now = s->now, here = fabs(now), there = fabs(now + size), spacing;
    if (!(size > 0 && isfinite(size)))
        return refuse(m, "doStep over %g s: the step must be > 0 and finite", size);
    spacing = spacing_at(here > there ? here : there);
    if (size < RESOLVED * spacing)
        return refuse(m,
                      "doStep over %g s: near t = %.15g s time is a multiple of %.2g s; the step "
                      "must be at least %.2g s",
                      size, now, spacing, RESOLVED * spacing);
    if (!(fabs(current - now) <= (SLACK * size > 2 * spacing ? SLACK * size : 2 * spacing)))
        return refuse(m,
                      "doStep from %.15g s: the FMU stands at %.15g s; communication steps must "
                      "follow each other without gap or overlap",
                      current, now);
    spacing = SLACK_AT_STOP * size > 2 * spacing ? SLACK_AT_STOP * size : 2 * spacing;
    if (s->has_stop && current + size > s->stop + spacing)
        return refuse(m,
                      "doStep to %.15g s: past the stop time, %.15g s, that was given to "
                      "setupExperiment",
                      current + size, s->stop);
    return OK;
}

Status march(Instance *m, double current, double size)
{
    State *s = m->state;
    const Table *t = m->table;
    double numbers[TOLD] = {0};
    if (allow(m, "doStep", 1u << STEPPING) || check_step(m, current, size))
        return ERROR;
    take_loads(m);
    int code = rotor_advance(m->block, current - s->start + size, m->values[t->drive_at],
                             s->has_slope ? s->slope : NAN);
    if (code && code != BROKEN) /* for what it may have come to */
        rotor_survey(m->block, in_block(m, t->surveyed_at), 0);
    if (code != BROKEN)
        code = rotor_outcome(m->block, code, numbers);
    s->has_slope = 0;
    if (code > 0) {
        char why[LONGEST] = "internal error in a step";
        if (code < t->sentences)
            spell(why, sentence(t, code), numbers);
        if (s->start != 0.0) {
            add(why, " (t from the start, ");
            add_number(why, s->start, 15);
            add(why, " s)");
        }
        snprintf(s->failure, sizeof s->failure, "%s", why);
        s->phase = FAILED;
        return refuse(m, "%s", s->failure);
    }
    if (code < 0)
        warn(m, -code, numbers);
    warn_beyond_tables(m);
    if (fabs(in_block(m, t->omega_at)) > in_block(m, t->surveyed_to))
        survey(m, 0);
    s->now = current + size;
    return OK;
}

Status set_slope(Instance *m, uint32_t reference, int order, double value)
{
    const Table *t = m->table;
    if (allow(m, "setRealInputDerivatives", 1u << STEPPING))
        return ERROR;
    if (t->is_free || reference != (uint32_t)t->drive_at || order != 1)
        return refuse(m, "setRealInputDerivatives: only the first derivative of the speed is used");
    if (!isfinite(value))
        return refuse(m, "setRealInputDerivatives: must be a finite number");
    m->state->has_slope = 1;
    m->state->slope = value;
    return OK;
}

/* --- values --------------------------------------------------------------------------------- */

static const char *const KINDS[] = {"Real", "Integer", "Boolean"};

/* Integers and Booleans can be read as Reals too, as some masters do with every output. */
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
        if (variables(t)[references[i]].kind != (int64_t)kind && (kind != A_REAL || is_set))
            return refuse(m, "%s%s: %s: is of type %s", call, name, name_of(m, references[i]),
                          KINDS[variables(t)[references[i]].kind]);
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

/* --- state ---------------------------------------------------------------------------------- */

size_t state_size(const Instance *m)
{
    const Table *t = m->table;
    return sizeof(State) + (size_t)t->observed_at * sizeof(double) + (size_t)t->state_bytes;
}

void free_state(void **state)
{
    if (!state)
        return;
    free(*state);
    *state = NULL;
}

static uint64_t checksum(const void *state, size_t size)
{
    const unsigned char *from = state;
    uint64_t sum = 0xcbf29ce484222325u, word;
    for (size_t at = 0; at + 8 <= size; at += 8) {
        if (at == offsetof(State, checksum))
            continue;
        memcpy(&word, from + at, 8);
        sum = (sum ^ word) * 0x9e3779b97f4a7c15u;
        sum ^= sum >> 29;
    }
    return sum;
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
    if (!*state && !(*state = malloc(size)))
        return refuse(m, "getFMUstate: out of memory");
    memcpy(*state, m->state, size);
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
        if (rotor_look(m->block))
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
    uint64_t sum = checksum(state, state_size(m));
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
    if (checksum(copy, size) != head.checksum) {
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
