/* One instance of the FMU as every version of FMI has it: which call is allowed when, with which
   variables and values, and what each does. All that a machine is stands in the table, a file of
   the FMU's resources that `fmi/machine_table.py` writes; numbers of 8 bytes, little-endian. */
#ifndef ROTOR_INSTANCE_H
#define ROTOR_INSTANCE_H
#include <stddef.h>
#include <stdint.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* Other libraries of a process have functions of the same names. */
#ifdef __GNUC__
#pragma GCC visibility push(hidden)
#endif

enum { OK, WARNING, DISCARD, ERROR, FATAL }; /* FMI's numbers */
typedef int Status;
/* Of a variable, or what a host asks for: of no kind there are no variables. */
typedef enum { A_REAL, AN_INTEGER, A_BOOLEAN, AN_ENUMERATION, NO_KIND, ANY_KIND } Kind;
typedef enum { INSTANTIATED, INITIALIZING, STEPPING, FAILED, TERMINATED } Phase;

/* What a variable is to the run; the places that parameters of the machine take are `Write`s. */
typedef enum {
    DRIVE,          /* the speed or the torque */
    LOAD,           /* at: which part of which force */
    RATE,           /* of the speed over the first step */
    HOLD,           /* 1: the speed is held between two values */
    START_SPEED,    /* of a rotor that a torque drives */
    MACHINE,        /* a parameter of the machine, whose value `least`, `strict`, `most` limit; at:
                       1 where it may change during a run */
    SETTING,        /* at: which of the solver's parameters; `unset` leaves it to the preset */
    REDUCED,        /* modes kept of the shaft: chosen when the FMU is built */
    READ,           /* at: which of what the model computes of the motion now */
    REMEMBERED,     /* the same, of what has been */
    INSTANT,        /* the same, an instant */
    TIME,           /* the independent variable of FMI 3.0, the last of all */
    ROLES
} Role;

typedef struct {
    int64_t name, unit, rule; /* texts: places in the table's file */
    int64_t kind, role, at, strict;
    double start, low, high, unset, shift, least, most;
} Variable;

typedef struct {
    int64_t variable, place, integer;
} Write; /* a parameter's place in the block */

typedef struct {
    int64_t variable, other, sentence;
} Need; /* variable > 0 asks for the other to be true */

typedef struct {
    int64_t sentence, is_of_size; /* its code; whether of the speed in either sense */
    int64_t of, viscosity, clearance; /* variables, -1 for none */
    double low, high, reynolds;
} Span; /* speeds, or values of a parameter, beyond which a sentence warns; of a film that is laminar
           up to `high`: what it has at the start values, its critical Reynolds number too */

typedef struct {
    char magic[8], sources[16], guid[40];
    double largest;    /* of what is set, in size */
    uint64_t checksum; /* of all of the file but itself */
    int64_t bytes, variables, observed_at, inputs, drive_at, is_free; /* the inputs come first */
    int64_t settings, tolerance_at, writes, needs, sentences, spans;
    /* sizes of the block, and of the run in it without and with the tangents of sensitivities */
    int64_t block, state_bytes, tangent_bytes;
    /* places in the block: of flags, loads and their rates, what is observed and its derivatives,
       time, the host's time at the start, speed, its rate, torque, and the speeds of rotor_survey */
    int64_t is_free_at, continues_at, stops_at_contact_at, has_sensitivities_at, is_past_limit_at;
    int64_t loads_at, rates_at, observed, derivatives;
    int64_t time_at, time_of_host_at, omega_at, alpha_at, torque_at;
    int64_t surveyed_at, surveyed_from, surveyed_to;
    /* places in the file */
    int64_t first_variable, first_write, first_need, first_sentence, first_span, first_block;
} Table;

typedef struct {
    char guid[40];
    uint64_t bytes, checksum;
    int64_t phase, is_built, is_retuned, has_tolerance, has_stop;
    double start, stop, now, tolerance;
    char failure[704];
} State; /* followed by the values of what can be set, `slopes` and `continued`, and the run */

enum { WARNINGS = 512 };
typedef struct Instance Instance;
/* A version of FMI: how messages reach its hosts, and what it calls the kinds of variables. */
typedef struct {
    void (*emit)(Instance *, Status, const char *category, const char *message);
    const char *kinds[NO_KIND];
} Skin;
struct Instance {
    const Table *table;
    State *state;
    double *values, *slopes; /* NaN where the host has given none for the next step */
    double *continued; /* 1 where a slope is that of a step that ended early */
    void *before;            /* the state before a step that has to be done whole or not at all */
    int is_whole;
    int returns_early; /* whether a step that ends early is a success of its call */
    double limit_at; /* time at which a step ended at a limit, NaN before */
    uint8_t *block; /* of the kernels, aligned; its first bytes are the run */
    uint8_t warned[WARNINGS]; /* by the code of the sentence */
    unsigned categories; /* which of CATEGORIES the host wants to hear of */
    char *name;
    const Skin *skin;
    void *host, *environment; /* of the host's logger */
    void *memory, *file;
};

enum { CATEGORY_COUNT = 6 };
extern const char *const CATEGORIES[CATEGORY_COUNT];

#define OTHER_KIND "instantiate: the FMU is for co-simulation alone"
/* NULL, with the reason logged, for what cannot be instantiated: `unfit` is one that the skin has,
   or NULL. `host` is called by the skin. */
Instance *create(const char *name, const char *guid, const char *resources, int is_logging,
                 const Skin *skin, void *host, void *environment, const char *unfit);
/* The same with the table in memory, which has to outlive the instance. */
Instance *create_of_table(const char *name, const void *table, size_t size, int is_logging,
                          const Skin *skin, void *host, void *environment);
void destroy(Instance *);
void begin_anew(Instance *);
/* All of them where no names are given. */
Status read_categories(Instance *, size_t count, const char *const *names, unsigned *chosen);
Status refuse(Instance *, const char *format, ...);

Status set_up(Instance *, const char *call, double start, int has_stop, double stop,
              int has_tolerance, double tolerance);
Status enter(Instance *);
Status leave_initialization(Instance *);
Status terminate(Instance *);
/* DISCARD where the step has ended early: at state->now, or, is_whole, where it began. */
Status advance_to(Instance *, double current, double size);
Status set_slopes(Instance *, const uint32_t *references, size_t count, const int *orders,
                  const double *values);

/* Values of one kind; `name` is that of the call. `put` and `item` turn an entry of the host's array
   into a double and back. */
typedef void (*Put)(void *values, size_t i, double value);
typedef double (*Item)(const void *values, size_t i);
Status get_values(Instance *, Kind, const char *name, const uint32_t *references, size_t count,
                  void *values, Put);
Status set_values(Instance *, Kind, const char *name, const uint32_t *references, size_t count,
                  const void *values, Item);

/* First and second derivatives of Reals that the model computes, at the time reached. */
Status get_derivatives(Instance *, const char *call, const uint32_t *references, size_t count,
                       const int *orders, double *values);
/* How Reals change with the inputs `known` over the last step, along a direction. */
Status get_directional(Instance *, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                       size_t knowns, const double *along, double *values);

void free_state(void **state);
Status take_state(Instance *, void **state);
Status give_state(Instance *, const void *state);
Status state_size(Instance *, const void *state, size_t *size);
Status write_state(Instance *, const void *state, void *bytes, size_t size);
Status read_state(Instance *, const void *bytes, size_t size, void **state);
#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#endif
