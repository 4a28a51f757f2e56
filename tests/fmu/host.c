/* A plain FMI 2.0 co-simulation master: host LIBRARY RESOURCES GUID STEPS STEP OUTPUT [VR VALUE]...
   Sets the Reals given, marches, prints time and the Real whose reference is OUTPUT each step.
   Exit status: 0, or 1 with the name of the call that failed. */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

typedef void *Component;
typedef struct {
    void (*logger)(void *, const char *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *step_finished;
    void *environment;
} Callbacks;

static void logger(void *environment, const char *name, const char *category, int status,
                   const char *message, ...)
{
    va_list arguments;
    (void)environment;
    (void)category;
    fprintf(stderr, "log %s %d: ", name, status);
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static void *library;

static void *entry(const char *name)
{
    void *found = dlsym(library, name);
    if (!found) {
        fprintf(stderr, "%s is missing\n", name);
        exit(2);
    }
    return found;
}

#define CALL(name, type, ...)                                     \
    do {                                                          \
        int status_ = ((int(*) type)entry(#name))(__VA_ARGS__);   \
        if (status_ > 1) {                                        \
            printf("%s %d\n", #name, status_);                    \
            failed = 1;                                           \
            goto end;                                             \
        }                                                         \
    } while (0)

int main(int argc, char **argv)
{
    Callbacks callbacks = {NULL, calloc, free, NULL, NULL};
    int failed = 0;
    if (argc < 7)
        return 2;
    callbacks.logger = (void (*)(void *, const char *, const char *, int, const char *,
                                 const char *, ...))logger;
    library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        return 2;
    }
    Component fmu = ((Component(*)(const char *, int, const char *, const char *,
                                   const Callbacks *, int, int))entry("fmi2Instantiate"))(
        "rotor", 1, argv[3], argv[2], &callbacks, 0, 1);
    if (!fmu) {
        printf("fmi2Instantiate\n");
        return 1;
    }
    int steps = atoi(argv[4]);
    double h = atof(argv[5]);
    CALL(fmi2SetupExperiment, (Component, int, double, double, int, double), fmu, 0, 0.0, 0.0, 0,
         0.0);
    CALL(fmi2EnterInitializationMode, (Component), fmu);
    for (int i = 7; i + 1 < argc; i += 2) {
        unsigned vr = (unsigned)atoi(argv[i]);
        double value = atof(argv[i + 1]);
        CALL(fmi2SetReal, (Component, const unsigned *, size_t, const double *), fmu, &vr, 1,
             &value);
    }
    CALL(fmi2ExitInitializationMode, (Component), fmu);
    for (int i = 0; i < steps; i++) {
        unsigned vr = (unsigned)atoi(argv[6]);
        double value;
        CALL(fmi2DoStep, (Component, double, double, int), fmu, i * h, h, 1);
        CALL(fmi2GetReal, (Component, const unsigned *, size_t, double *), fmu, &vr, 1, &value);
        printf("%.17g %.17g\n", (i + 1) * h, value);
    }
    CALL(fmi2Terminate, (Component), fmu);
end:
    ((void (*)(Component))entry("fmi2FreeInstance"))(fmu);
    dlclose(library);
    fflush(stdout);
    return failed;
}
