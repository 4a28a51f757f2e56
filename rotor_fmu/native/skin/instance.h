/* One instance of the FMU as every version of FMI has it: which call is allowed when, with which
   variables and values, and what each does. All that a machine is stands in the table, a file of
   the FMU's resources that `native/table.py` writes; numbers of 8 bytes, little-endian. */
#ifndef ROTOR_INSTANCE_H
#define ROTOR_INSTANCE_H
#include <stddef.h>
#include <stdint.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef enum { OK, WARNING, DISCARD, ERROR, FATAL } Status; /* FMI's numbers */
typedef enum { A_REAL, AN_INTEGER, A_BOOLEAN, NO_KIND } Kind; /* of the last there are no variables */
typedef enum { INSTANTIATED, INITIALIZING, STEPPING, FAILED, TERMINATED } Phase;

/* What a variable is to the run; the places that parameters of the machine take are `Write`s. */
typedef enum {
    DRIVE,          /* the speed or the torque */
    LOAD,           /* at: which part of which force */
    RATE,           /* of the speed over the first step */
    HOLD,           /* 1: the speed is held between two values */
    START_SPEED,    /* of a rotor that a torque drives */
    MACHINE,        /* a parameter of the machine, whose value `least` and `strict` limit */
    SETTING,        /* at: which of the solver's parameters; `unset` leaves it to the preset */
    REDUCTION,      /* modes kept of the shaft: chosen when the FMU is built */
    READ,           /* at: which of what the model computes */
    INSTANT,        /* the same, an instant */
    TIME            /* the independent variable of FMI 3.0, the last of all */
} Role;

typedef struct {
    int64_t name, unit, rule; /* texts: places in the table's file */
    int64_t kind, role, at, strict;
    double start, low, high, unset, shift, least;
} Variable;

typedef struct {
    int64_t variable, place, integer;
} Write; /* a parameter's place in the block */

typedef struct {
    int64_t variable, other, sentence;
} Need; /* variable > 0 asks for the other to be true */

typedef struct {
    int64_t sentence; /* its code */
    double low, high;
} Span; /* speeds beyond which a sentence warns */

typedef struct {
    char magic[8], core[16], guid[40];
    int64_t bytes, variables, observed_at, drive_at, is_free;
    int64_t settings, tolerance_at, writes, needs, sentences;
    int64_t block, state_bytes;                       /* sizes of the block, and of the run in it */
    int64_t is_free_at, continues_at, loads_at, observed; /* places in the block */
    int64_t spans, omega_at; /* how many, and the place of the speed in the block */
    int64_t surveyed_at, surveyed_to; /* places of speeds: see rotor_survey */
    int64_t first_variable, first_write, first_need, first_sentence, first_span, first_block;
    /* in the file */
} Table;

typedef struct {
    char guid[40];
    uint64_t bytes, checksum;
    int64_t phase, is_built, has_tolerance, has_stop, has_slope;
    double start, stop, now, tolerance, slope;
    char failure[704];
} State; /* followed by the values of what can be set, and by the run */

enum { WARNINGS = 512 };
typedef struct Instance Instance;
typedef void (*Tell)(Instance *, Status, const char *category, const char *message);
struct Instance {
    const Table *table;
    State *state;
    double *values;
    uint8_t *block; /* of the kernels, aligned; its first bytes are the run */
    uint8_t warned[WARNINGS]; /* by the code of the sentence */
    unsigned categories; /* which of CATEGORIES the host wants to hear of */
    char *name;
    Tell tell;
    void *host, *environment; /* of the host's logger */
    void *memory, *file;
};

enum { CATEGORY_COUNT = 6 };
extern const char *const CATEGORIES[CATEGORY_COUNT];

/* NULL, with the reason told, for what cannot be instantiated. `host` is called through `tell`. */
Instance *create(const char *name, const char *guid, const char *resources, int is_logging,
                 Tell tell, void *host, void *environment);
void destroy(Instance *);
void begin_anew(Instance *);
Status choose_categories(Instance *, int is_on, size_t count, const char *const *names);
Status refuse(Instance *, const char *format, ...);

Status set_up(Instance *, double start, int has_stop, double stop, int has_tolerance,
              double tolerance);
Status enter(Instance *);
Status leave_initialization(Instance *);
Status terminate(Instance *);
Status march(Instance *, double current, double size);
Status set_slope(Instance *, uint32_t reference, int order, double value);

/* Values of one kind; `name` is the kind's in the host's version of FMI. `put` and `item` turn an
   entry of the host's array into a double and back. */
typedef void (*Put)(void *values, size_t i, double value);
typedef double (*Item)(const void *values, size_t i);
Status get_values(Instance *, Kind, const char *name, const uint32_t *references, size_t count,
                  void *values, Put);
Status set_values(Instance *, Kind, const char *name, const uint32_t *references, size_t count,
                  const void *values, Item);

size_t state_size(const Instance *);
void free_state(void **state);
Status take_state(Instance *, void **state);
Status give_state(Instance *, const void *state);
Status write_state(Instance *, const void *state, void *bytes, size_t size);
Status read_state(Instance *, const void *bytes, size_t size, void **state);
#endif
