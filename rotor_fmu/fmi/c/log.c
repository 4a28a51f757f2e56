/* Messages for the host: sentences with their numbers, by the categories it wants to hear of. */
#include "internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const CATEGORIES[CATEGORY_COUNT] = {"logAll",          "logStatusWarning",
                                                "logStatusDiscard", "logStatusError",
                                                "logStatusFatal",   "logStatusPending"};

/* Errors and warnings go to standard error too, since hosts drop them unless logging is on. */
static void log_message(Instance *m, Status status, char *message)
{
    static const char *const LEVELS[] = {"", "warning", "discard", "error"};
    char given[2 * LONGEST], *to = given;
    int category = (int)status;
    for (char *c = message; *c; c++) {
        if (*c == '%' || *c == '\n') /* hosts read it as a printf format */
            *c = ' ';
        if (*c == '#') /* FMI's escape character, before references to variables and itself */
            *to++ = *c;
        *to++ = *c;
    }
    *to = 0;
    if (status != OK)
        write_error(m->name, LEVELS[status], message);
    if (m->categories & 1u << category)
        m->skin->emit(m, status, CATEGORIES[category], given);
}

static void vlog_message(Instance *m, Status status, const char *format, va_list arguments)
{
    char message[LONGEST];
    vsnprintf(message, sizeof message, format, arguments);
    log_message(m, status, message);
}

Status refuse(Instance *m, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vlog_message(m, ERROR, format, arguments);
    va_end(arguments);
    return ERROR;
}

void warn_of(Instance *m, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vlog_message(m, WARNING, format, arguments);
    va_end(arguments);
}

void add(char *out, const char *more)
{
    size_t used = strlen(out);
    snprintf(out + used, LONGEST - used, "%s", more);
}

void add_number(char *out, double value, int digits)
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

void spell(char *out, const char *pattern, const double *numbers)
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

void log_text(Instance *m, Status status, const char *text)
{
    char message[LONGEST] = "";
    add(message, text);
    log_message(m, status, message);
}

Status log_sentence(Instance *m, Status status, const char *pattern, const double *numbers)
{
    char message[LONGEST];
    spell(message, pattern, numbers);
    log_message(m, status, message);
    return status;
}

void add_start(const Instance *m, char *message)
{
    if (m->state->start == 0.0 || !strstr(message, "t = "))
        return;
    add(message, " (t from the start, ");
    add_number(message, m->state->start, 15);
    add(message, " s)");
}

void warn(Instance *m, int code, const double *numbers)
{
    char message[LONGEST];
    if (code < 0 || code >= m->table->sentences || m->warned[code % WARNINGS])
        return;
    m->warned[code % WARNINGS] = 1;
    spell(message, sentence(m->table, code), numbers);
    add_start(m, message);
    log_message(m, WARNING, message);
}

Status read_categories(Instance *m, size_t count, const char *const *names, unsigned *chosen)
{
    unsigned read = count ? 0 : ~0u;
    for (size_t i = 0; i < count; i++) {
        const char *name = names && names[i] ? names[i] : "NULL";
        int k = 0;
        while (k < CATEGORY_COUNT && strcmp(name, CATEGORIES[k]))
            k++;
        if (k == CATEGORY_COUNT)
            return refuse(m, "setDebugLogging: %s: no category has that name", name);
        read |= k ? 1u << k : ~0u; /* the first is all of them */
    }
    *chosen = read;
    return OK;
}
