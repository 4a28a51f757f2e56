/* master LIBRARY RESOURCES GUID BLOCK WHAT INPUTS FIRST_OUTPUT OUTPUTS: the native FMU from C, its
   Reals alone. BLOCK: a run's block at its start (`Simulation`), for the kernels by themselves.
   WHAT is
       start       us of CPU from before fmi2Instantiate to behind a first step
       steps       us of CPU of a communication step of 0.1 ms: all inputs set, all outputs read
       kernels     the same of rotor_advance alone
       rundown     the run-down through FMI, in communication steps of 40 ms
       bare        the same by rotor_advance alone
   The last two print the CPU time of the loop [s]. */
#include <dlfcn.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST = 256, STEPS = 5000, STARTS = 20, COMMUNICATIONS = 1000, ALIGNMENT = 64 };
static const double H = 1e-4, LONG_H = 0.04, SPEED = 400.0, RATE = -10.0;


static void *library;
static void *(*instantiate)(const char *, int, const char *, const char *, const void *, int, int);
static int (*enter)(void *), (*leave)(void *);
static int (*step)(void *, double, double, int);
static int (*set)(void *, const unsigned *, size_t, const double *);
static int (*get)(void *, const unsigned *, size_t, double *);
static void (*release)(void *);
static int (*advance)(uint8_t *, double, double, double);
static unsigned inputs[MOST], outputs[MOST];
static size_t input_count, output_count;
static double values[MOST], seen[MOST];

static void *find(const char *name)
{
    void *found = dlsym(library, name);
    if (!found)
        exit(2);
    return found;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *ready(char **argv)
{
    void *m = instantiate("master", 1, argv[3], argv[2], NULL, 0, 0);
    if (!m || enter(m) || leave(m))
        exit(3);
    return m;
}

static void communicate(void *m, double t, double h, double speed)
{
    values[0] = speed;
    if (set(m, inputs, input_count, values) || step(m, t, h, 1)
        || get(m, outputs, output_count, seen))
        exit(4);
}

static uint8_t *block_of(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        exit(5);
    fseek(file, 0, SEEK_END);
    size_t size = (size_t)ftell(file);
    uint8_t *block = aligned_alloc(ALIGNMENT, (size / ALIGNMENT + 1) * ALIGNMENT);
    rewind(file);
    if (!block || fread(block, 1, size, file) != size)
        exit(5);
    fclose(file);
    return block;
}

int main(int argc, char **argv)
{
    if (argc != 9 || !(library = dlopen(argv[1], RTLD_NOW)))
        return 2;
    instantiate = find("fmi2Instantiate");
    enter = find("fmi2EnterInitializationMode");
    leave = find("fmi2ExitInitializationMode");
    step = find("fmi2DoStep");
    set = find("fmi2SetReal");
    get = find("fmi2GetReal");
    release = find("fmi2FreeInstance");
    advance = find("rotor_advance");
    const char *what = argv[5];
    input_count = (size_t)atoi(argv[6]);
    output_count = (size_t)atoi(argv[8]);
    for (size_t i = 0; i < input_count; i++)
        inputs[i] = (unsigned)i;
    for (size_t i = 0; i < output_count; i++)
        outputs[i] = (unsigned)atoi(argv[7]) + (unsigned)i;
    double begun = now();
    if (!strcmp(what, "start")) {
        for (int i = 0; i < STARTS; i++) {
            void *m = ready(argv);
            communicate(m, 0.0, H, SPEED);
            release(m);
        }
        printf("%.9g\n", (now() - begun) / STARTS * 1e6);
    } else if (!strcmp(what, "steps")) {
        void *m = ready(argv);
        begun = now();
        for (int i = 0; i < STEPS; i++)
            communicate(m, i * H, H, SPEED);
        printf("%.9g\n", (now() - begun) / STEPS * 1e6);
        release(m);
    } else if (!strcmp(what, "kernels")) {
        uint8_t *block = block_of(argv[4]);
        begun = now();
        for (int i = 0; i < STEPS; i++)
            if (advance(block, i * H + H, SPEED, NAN))
                return 6;
        printf("%.9g\n", (now() - begun) / STEPS * 1e6);
        free(block);
    } else if (!strcmp(what, "rundown")) {
        void *m = ready(argv);
        begun = now();
        for (int i = 0; i < COMMUNICATIONS; i++)
            communicate(m, i * LONG_H, LONG_H, SPEED + RATE * (i * LONG_H));
        printf("%.9g\n", now() - begun);
        release(m);
    } else {
        uint8_t *block = block_of(argv[4]);
        begun = now();
        for (int i = 0; i < COMMUNICATIONS; i++)
            if (advance(block, i * LONG_H + LONG_H, SPEED + RATE * (i * LONG_H), NAN))
                return 6;
        printf("%.9g\n", now() - begun);
        free(block);
    }
    return 0;
}
