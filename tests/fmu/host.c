/* A plain FMI 2.0 co-simulation master: host LIBRARY RESOURCES GUID < COMMANDS
   Each line of the commands is one call of the FMU:
       instantiate | setup T | enter | exit | real VR VALUE | integer VR VALUE | step T H | get VR |
       reset | terminate | free
   and is answered by a line: the command, the status (0 OK .. 4 fatal), of `get` the value; before
   it come the lines `log STATUS MESSAGE` that the FMU sent. Exit status: 1 if any call failed. */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void *Component;
typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *step_finished;
    void *environment;
} Callbacks;
typedef Component (*Instantiate)(const char *, int, const char *, const char *, const Callbacks *,
                                 int, int);
typedef int (*Plain)(Component);
typedef int (*Setup)(Component, int, double, double, int, double);
typedef int (*Step)(Component, double, double, int);
typedef int (*SetReal)(Component, const unsigned *, size_t, const double *);
typedef int (*SetInteger)(Component, const unsigned *, size_t, const int *);
typedef int (*GetReal)(Component, const unsigned *, size_t, double *);

static void *library;

static void logger(void *environment, const char *name, int status, const char *category,
                   const char *message, ...)
{
    char text[2000];
    va_list arguments;
    (void)environment;
    (void)name;
    (void)category;
    va_start(arguments, message);
    vsnprintf(text, sizeof text, message, arguments); /* as the standard says: a printf format */
    va_end(arguments);
    for (char *c = text; *c; c++)
        if (*c == '\n')
            *c = ' ';
    printf("log %d %s\n", status, text);
}

static void *entry(const char *name)
{
    void *found = dlsym(library, name);
    if (!found) {
        fprintf(stderr, "%s is missing\n", name);
        exit(2);
    }
    return found;
}

static int plain(const char *name, Component fmu)
{
    return ((Plain)entry(name))(fmu);
}

/* Carries out a call and returns its status; -1 for an unknown command. */
static int call(const char *name, const char *first, const char *second, Component fmu,
                double *value)
{
    unsigned vr = (unsigned)atoi(first);
    double a = atof(first), b = atof(second);
    int number = atoi(second);
    if (!strcmp(name, "setup"))
        return ((Setup)entry("fmi2SetupExperiment"))(fmu, 0, 0.0, a, 0, 0.0);
    if (!strcmp(name, "enter"))
        return plain("fmi2EnterInitializationMode", fmu);
    if (!strcmp(name, "exit"))
        return plain("fmi2ExitInitializationMode", fmu);
    if (!strcmp(name, "real"))
        return ((SetReal)entry("fmi2SetReal"))(fmu, &vr, 1, &b);
    if (!strcmp(name, "integer"))
        return ((SetInteger)entry("fmi2SetInteger"))(fmu, &vr, 1, &number);
    if (!strcmp(name, "step"))
        return ((Step)entry("fmi2DoStep"))(fmu, a, b, 1);
    if (!strcmp(name, "get"))
        return ((GetReal)entry("fmi2GetReal"))(fmu, &vr, 1, value);
    if (!strcmp(name, "reset"))
        return plain("fmi2Reset", fmu);
    if (!strcmp(name, "terminate"))
        return plain("fmi2Terminate", fmu);
    return -1;
}

int main(int argc, char **argv)
{
    Callbacks callbacks = {logger, calloc, free, NULL, NULL};
    Component fmu = NULL;
    int failed = 0;
    char line[256];
    if (argc < 4)
        return 2;
    library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        return 2;
    }
    while (fgets(line, sizeof line, stdin)) {
        char name[32] = "", first[64] = "", second[64] = "";
        int status = 0;
        double value = 0.0;
        sscanf(line, "%31s %63s %63s", name, first, second);
        if (!strcmp(name, "instantiate")) {
            fmu = ((Instantiate)entry("fmi2Instantiate"))("rotor", 1, argv[3], argv[2], &callbacks,
                                                          0, 1);
            status = fmu ? 0 : 4;
        } else if (!strcmp(name, "free")) {
            if (fmu)
                ((void (*)(Component))entry("fmi2FreeInstance"))(fmu);
            fmu = NULL;
        } else if (fmu) {
            status = call(name, first, second, fmu, &value);
        } else {
            status = 3; /* nothing to call */
        }
        failed = failed || status > 1 || status < 0;
        if (!strcmp(name, "get") && status == 0)
            printf("%s %d %.17g\n", name, status, value);
        else
            printf("%s %d\n", name, status);
        fflush(stdout);
    }
    dlclose(library);
    return failed;
}
