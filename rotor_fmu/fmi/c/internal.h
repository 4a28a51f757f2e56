/* What the files of an instance share, and no version of FMI needs to know. */
#ifndef ROTOR_INTERNAL_H
#define ROTOR_INTERNAL_H
#include "instance.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden)
#endif

#define TABLE_FILE "machine.table"
enum { LONGEST = 704, MESSAGE_NUMBERS = 16 }; /* characters of a message, numbers of a sentence */
enum { MOST_SETTINGS = 64 };       /* that the solver takes */

/* Room for a run, and what is to be freed, NULL for none; NULL where memory is out. */
uint8_t *new_block(size_t size, void **memory);
void free_block(void *memory);

/* The table in the folder of an FMU's resources, to be freed; NULL with the reason in `why`. */
Table *read_table(const char *resources, char *why, size_t room);
void write_error(const char *name, const char *level, const char *message);
/* What is wrong with a table in memory, or NULL. */
const char *check_table(const void *table, size_t size);
/* Of all but the 8 bytes at a place; size and place are multiples of 8. */
uint64_t checksum(const void *content, size_t size, size_t but);

static inline const char *text(const Table *t, int64_t at)
{
    return (const char *)t + at;
}
static inline const Variable *variables(const Table *t)
{
    return (const Variable *)((const char *)t + t->first_variable);
}
static inline const char *name_of(const Instance *m, uint32_t reference)
{
    return text(m->table, variables(m->table)[reference].name);
}
static inline const char *sentence(const Table *t, int64_t code)
{
    return text(t, ((const int64_t *)((const char *)t + t->first_sentence))[code]);
}
static inline double in_block(const Instance *m, int64_t place)
{
    return *(const double *)(m->block + place);
}
/* How many numbers the model computes. */
static inline int64_t computed(const Table *t)
{
    const Variable *last = variables(t) + t->variables - 1;
    return t->variables - t->observed_at - (last->role == TIME);
}

/* To a text of LONGEST characters. */
void add(char *out, const char *more);
void add_number(char *out, double value, int digits);
/* A sentence of the table with its numbers: {g}, {.4g}, {d} for an integer, and {?one|other}. */
void spell(char *out, const char *pattern, const double *numbers);
/* Tell a message as it is, or a sentence, whose status is returned. */
void log_text(Instance *, Status, const char *message);
Status log_sentence(Instance *, Status, const char *pattern, const double *numbers);
void warn_of(Instance *, const char *format, ...);
/* Say from when the time in a message of the model counts. */
void add_start(const Instance *, char *message);
/* Warn with a sentence of this code, once in a run. */
void warn(Instance *, int code, const double *numbers);

/* OK in these phases, each a bit; else the call is refused. */
Status allow(Instance *, const char *call, unsigned phases);
/* Bytes of a state without its run. */
size_t head_size(const Instance *);
/* None of the inputs' slopes are known. */
void forget_slopes(Instance *);

/* The run from the values that are set now, if there is none; with its warnings, and in any case,
   where it starts: the values of one that a host asks for before may change. */
Status build(Instance *, int is_start);
/* OK where a parameter of the machine may have this value. */
Status check_parameter(Instance *, const Variable *, double value);
/* Hand the inputs over, but the drive. */
void take_loads(Instance *);
/* A host that allows no early return wants none at contacts, whatever the parameter says. */
void choose_contacts(Instance *);
/* Take up parameters that were changed since the last step; the ledger counts what that does. */
Status retune(Instance *);
/* Look for what grows up to the present speed, and warn of it. */
void survey(Instance *, int is_start);
void warn_beyond_ranges(Instance *);
#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#endif
