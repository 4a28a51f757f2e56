/* The FMU as a WebAssembly component: FMI 3.0's functions as `fmi3.wit` has them, in the component
   model's canonical ABI. Text and lists are an address and a count; what is more than one number is
   returned by the address of a struct, which C lays out as that ABI does. */
#include "fmi3.c" /* which this file exports in another form */

#include <stdlib.h>
#include <string.h>

#define CO_SIMULATION "fmi:fmi3/co-simulation@3.0.0"
#define EXPORTED(NAME) __attribute__((export_name(NAME)))
#define IMPORTED(MODULE, NAME) __attribute__((import_module(MODULE), import_name(NAME)))
#define METHOD(LABEL) EXPORTED(CO_SIMULATION "#[method]co-simulation-instance." LABEL)

/* What a handle of the host stands for, and the name that goes with its messages. */
typedef struct {
    fmi3Instance instance;
    size_t length;
    char name[];
} Held;
typedef struct {
    const char *at;
    size_t length;
} Text;
typedef struct {
    uint32_t reference, order;
} Request;
typedef struct {
    uint8_t is_error;
    union {
        struct {
            const void *at;
            size_t count;
        } list;
        uint8_t status;
    } of;
} ListResult;
typedef struct {
    uint8_t is_error;
    union {
        struct {
            double reached;
            bool needs_event, terminates, is_early;
        } step;
        uint64_t count;
        uint8_t status;
    } of;
} Result; /* of numbers of 8 bytes */
typedef struct {
    uint8_t is_there;
    int32_t handle;
} Option;

IMPORTED("fmi:fmi3/callbacks@3.0.0", "log-message")
void log_message(const char *name, size_t name_length, int status, const char *category,
                 size_t category_length, const char *message, size_t message_length);
IMPORTED("[export]" CO_SIMULATION, "[resource-new]co-simulation-instance")
int32_t new_handle(Held *);

/* --- memory of a call: what the host hands over, and what it is handed, until the next call ---- */

typedef struct Chunk {
    struct Chunk *next;
} Chunk;
enum { HEAD = 16 }; /* of a chunk, which keeps what follows aligned */
static Chunk *chunks;
static bool is_called; /* what is in `chunks` is of a call that has begun */

static void free_chunks(void)
{
    while (chunks) {
        Chunk *next = chunks->next;
        free(chunks);
        chunks = next;
    }
}

static void *room(size_t count, size_t size)
{
    Chunk *chunk = count <= (SIZE_MAX - HEAD) / size ? malloc(HEAD + count * size) : NULL;
    if (!chunk)
        __builtin_trap();
    chunk->next = chunks;
    chunks = chunk;
    return (char *)chunk + HEAD;
}

EXPORTED("cabi_realloc") void *cabi_realloc(void *old, size_t used, size_t, size_t size)
{
    if (is_called)
        free_chunks();
    is_called = false;
    void *result = room(size, 1);
    if (used)
        memcpy(result, old, used < size ? used : size);
    return result;
}

static void begin(void)
{
    if (is_called)
        free_chunks(); /* nothing was handed over since the last call */
    is_called = true;
}

static const char *spelt(const char *text, size_t length)
{
    char *result = room(length + 1, 1);
    memcpy(result, text, length);
    result[length] = 0;
    return result;
}

static const ListResult *listed(Status status, const void *at, size_t count)
{
    static ListResult result;
    result.is_error = status > WARNING;
    if (result.is_error) {
        result.of.status = (uint8_t)status;
    } else {
        result.of.list.at = at;
        result.of.list.count = count;
    }
    return &result;
}

static const Result *failed(Status status)
{
    static Result result;
    result.is_error = 1;
    result.of.status = (uint8_t)status;
    return &result;
}

/* --- the life of an instance ------------------------------------------------------------------- */

static void pass_on(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                    fmi3String message)
{
    const Held *held = environment;
    log_message(held->name, held->length, status, category, strlen(category), message,
                strlen(message));
}

EXPORTED("fmi:fmi3/common@3.0.0#get-version") const Text *get_version(void)
{
    static Text result;
    result.at = fmi3GetVersion();
    result.length = strlen(result.at);
    return &result;
}

EXPORTED(CO_SIMULATION "#[static]co-simulation-instance.instantiate-co-simulation")
const Option *instantiate(const char *name, size_t length, const char *token, size_t token_length,
                          const char *, size_t, bool visible, bool is_logging, bool has_events,
                          bool may_return_early, const uint32_t *needed, size_t count)
{
    static Option result;
    begin();
    Held *held = malloc(sizeof *held + length + 1);
    if (!held)
        __builtin_trap();
    memcpy(held->name, name, length);
    held->name[length] = 0;
    held->length = length;
    held->instance = fmi3InstantiateCoSimulation(held->name, spelt(token, token_length), NULL,
                                                 visible, is_logging, has_events, may_return_early,
                                                 needed, count, held, pass_on, NULL);
    result.is_there = held->instance != NULL;
    if (result.is_there)
        result.handle = new_handle(held);
    else
        free(held);
    return &result;
}
EXPORTED(CO_SIMULATION "#[dtor]co-simulation-instance") void drop_instance(Held *held)
{
    fmi3FreeInstance(held->instance);
    free(held);
}
METHOD("set-debug-logging")
int set_debug_logging(Held *held, bool is_on, const Text *categories, size_t count)
{
    begin();
    fmi3String *names = room(count, sizeof *names);
    for (size_t i = 0; i < count; i++)
        names[i] = spelt(categories[i].at, categories[i].length);
    return fmi3SetDebugLogging(held->instance, is_on, count, names);
}
METHOD("enter-initialization-mode")
int enter_initialization_mode(Held *held, bool has_tolerance, double tolerance, double start,
                              bool has_stop, double stop)
{
    return fmi3EnterInitializationMode(held->instance, has_tolerance, tolerance, start, has_stop,
                                       stop);
}
METHOD("do-step") const Result *do_step(Held *held, double current, double size, bool no_set)
{
    static Result result;
    Status status = fmi3DoStep(held->instance, current, size, no_set, &result.of.step.needs_event,
                               &result.of.step.terminates, &result.of.step.is_early,
                               &result.of.step.reached);
    result.is_error = 0;
    return status > WARNING ? failed(status) : &result;
}
#define PLAIN(LABEL, NAME)                                                                       \
    METHOD(LABEL) int call##NAME(Held *held)                                                     \
    {                                                                                            \
        return fmi3##NAME(held->instance);                                                       \
    }
PLAIN("exit-initialization-mode", ExitInitializationMode)
PLAIN("terminate", Terminate)
PLAIN("reset", Reset)
PLAIN("enter-event-mode", EnterEventMode)
PLAIN("enter-step-mode", EnterStepMode)
PLAIN("enter-configuration-mode", EnterConfigurationMode)
PLAIN("exit-configuration-mode", ExitConfigurationMode)
PLAIN("evaluate-discrete-states", EvaluateDiscreteStates)

/* --- values ------------------------------------------------------------------------------------ */

/* Of Strings there are none, so that their lists, which are laid out otherwise, stay empty. */
#define VALUES_OF(LABEL, NAME)                                                                   \
    METHOD("get-" LABEL) const ListResult *read##NAME(Held *held, const uint32_t *vr, size_t n)  \
    {                                                                                            \
        begin();                                                                                 \
        fmi3##NAME *values = room(n, sizeof *values);                                            \
        return listed(fmi3Get##NAME(held->instance, vr, n, values, n), values, n);               \
    }                                                                                            \
    METHOD("set-" LABEL)                                                                         \
    int write##NAME(Held *held, const uint32_t *vr, size_t n, const void *values, size_t count)  \
    {                                                                                            \
        begin();                                                                                 \
        return fmi3Set##NAME(held->instance, vr, n, values, count);                              \
    }
VALUES_OF("float32", Float32)
VALUES_OF("float64", Float64)
VALUES_OF("int8", Int8)
VALUES_OF("int16", Int16)
VALUES_OF("int32", Int32)
VALUES_OF("int64", Int64)
VALUES_OF("uint8", UInt8)
VALUES_OF("uint16", UInt16)
VALUES_OF("uint32", UInt32)
VALUES_OF("uint64", UInt64)
VALUES_OF("boolean", Boolean)
VALUES_OF("string", String)

METHOD("get-binary") const ListResult *read_binary(Held *held, const uint32_t *vr, size_t n)
{
    begin();
    fmi3Binary *values = room(n, sizeof *values);
    return listed(fmi3GetBinary(held->instance, vr, n, NULL, values, n), values, n);
}
METHOD("set-binary")
int write_binary(Held *held, const uint32_t *vr, size_t n, const void *values, size_t count)
{
    begin();
    return fmi3SetBinary(held->instance, vr, n, NULL, values, count);
}
METHOD("get-clock") const ListResult *read_clock(Held *held, const uint32_t *vr, size_t n)
{
    begin();
    fmi3Clock *values = room(n, sizeof *values);
    return listed(fmi3GetClock(held->instance, vr, n, values), values, n);
}
METHOD("set-clock")
int write_clock(Held *held, const uint32_t *vr, size_t n, const fmi3Clock *values, size_t)
{
    begin();
    return fmi3SetClock(held->instance, vr, n, values);
}

/* --- state, as bytes at once -------------------------------------------------------------------- */

METHOD("get-fmu-state") const ListResult *get_state(Held *held)
{
    begin();
    fmi3FMUState state = NULL;
    size_t size = 0;
    void *bytes = NULL;
    Status status = fmi3GetFMUState(held->instance, &state);
    if (!status)
        status = fmi3SerializedFMUStateSize(held->instance, state, &size);
    if (!status)
        status = fmi3SerializeFMUState(held->instance, state, bytes = room(size, 1), size);
    fmi3FreeFMUState(held->instance, &state);
    return listed(status, bytes, size);
}
METHOD("set-fmu-state") int set_state(Held *held, const uint8_t *bytes, size_t size)
{
    begin();
    fmi3FMUState state = NULL;
    Status status = fmi3DeserializeFMUState(held->instance, bytes, size, &state);
    if (!status)
        status = fmi3SetFMUState(held->instance, state);
    fmi3FreeFMUState(held->instance, &state);
    return status;
}

/* --- derivatives -------------------------------------------------------------------------------- */

/* The references and orders of requests, an array each. */
static const uint32_t *references_of(const Request *requests, size_t count, int32_t **orders)
{
    uint32_t *result = room(count, sizeof *result);
    *orders = room(count, sizeof **orders);
    for (size_t i = 0; i < count; i++) {
        result[i] = requests[i].reference;
        (*orders)[i] = (int32_t)requests[i].order;
    }
    return result;
}

METHOD("get-output-derivatives")
const ListResult *get_output_derivatives(Held *held, const Request *requests, size_t count)
{
    begin();
    int32_t *orders;
    const uint32_t *references = references_of(requests, count, &orders);
    double *values = room(count, sizeof *values);
    return listed(fmi3GetOutputDerivatives(held->instance, references, count, orders, values, count),
                  values, count);
}
METHOD("set-input-derivatives")
int set_input_derivatives(Held *held, const Request *requests, size_t count, const double *values,
                          size_t given)
{
    begin();
    int32_t *orders;
    const uint32_t *references = references_of(requests, count, &orders);
    if (given != count)
        return refuse(held->instance, "setInputDerivatives: %zu values for %zu variables", given,
                      count);
    return set_slopes(held->instance, references, count, orders, values);
}
METHOD("get-directional-derivative")
const ListResult *get_directional_derivative(Held *held, const uint32_t *unknown, size_t unknowns,
                                             const uint32_t *known, size_t knowns,
                                             const double *seed, size_t seeds)
{
    begin();
    double *values = room(unknowns, sizeof *values);
    Status status = fmi3GetDirectionalDerivative(held->instance, unknown, unknowns, known, knowns,
                                                 seed, seeds, values, unknowns);
    return listed(status, values, unknowns);
}

/* --- what an FMU may leave out, and this one does: every call is refused ------------------------ */

#define LISTS(...) __VA_ARGS__
#define NO_RESULT(LABEL, NAME, RESULT, REFUSED, TAKEN, ...)                                      \
    METHOD(LABEL) RESULT refuse##NAME(Held *held, TAKEN)                                         \
    {                                                                                            \
        begin();                                                                                 \
        return REFUSED(fmi3##NAME(held->instance, __VA_ARGS__));                                 \
    }
#define ONE_LIST LISTS(const void *, size_t)
#define TWO_LISTS LISTS(const void *, size_t, const void *, size_t)
#define THREE_LISTS LISTS(const void *, size_t, const void *, size_t, const void *, size_t)
#define AS_LIST(STATUS) listed(STATUS, NULL, 0)
#define LIST const ListResult *
NO_RESULT("get-variable-dependencies", GetVariableDependencies, LIST, AS_LIST, uint32_t, 0, 0, 0, 0,
          0, 0)
NO_RESULT("get-number-of-variable-dependencies", GetNumberOfVariableDependencies, const Result *,
          failed, uint32_t, 0, 0)
NO_RESULT("get-adjoint-derivative", GetAdjointDerivative, LIST, AS_LIST, THREE_LISTS, 0, 0, 0, 0, 0,
          0, 0, 0)
NO_RESULT("get-interval-decimal", GetIntervalDecimal, LIST, AS_LIST, ONE_LIST, 0, 0, 0, 0)
NO_RESULT("get-interval-fraction", GetIntervalFraction, LIST, AS_LIST, ONE_LIST, 0, 0, 0, 0, 0)
NO_RESULT("get-shift-decimal", GetShiftDecimal, LIST, AS_LIST, ONE_LIST, 0, 0, 0)
NO_RESULT("get-shift-fraction", GetShiftFraction, LIST, AS_LIST, ONE_LIST, 0, 0, 0, 0)
NO_RESULT("set-interval-decimal", SetIntervalDecimal, int, , TWO_LISTS, 0, 0, 0)
NO_RESULT("set-interval-fraction", SetIntervalFraction, int, , TWO_LISTS, 0, 0, 0, 0)
NO_RESULT("set-shift-decimal", SetShiftDecimal, int, , TWO_LISTS, 0, 0, 0)
NO_RESULT("set-shift-fraction", SetShiftFraction, int, , TWO_LISTS, 0, 0, 0, 0)

METHOD("update-discrete-states") const Result *update_discrete_states(Held *held)
{
    return failed(fmi3UpdateDiscreteStates(held->instance, 0, 0, 0, 0, 0, 0));
}
