/* The functions of FMI 3.0 that a C master calls, of a library that is loaded. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

struct fmi3 {
    void *(*instantiate)(const char *, const char *, const char *, bool, bool, bool, bool,
                         const uint32_t *, size_t, void *, void *, void *);
    int (*enter)(void *, bool, double, double, bool, double);
    int (*leave)(void *);
    int (*choose)(void *, const uint32_t *, size_t, const int32_t *, size_t);
    int (*set)(void *, const uint32_t *, size_t, const double *, size_t);
    int (*get)(void *, const uint32_t *, size_t, double *, size_t);
    int (*step)(void *, double, double, bool, bool *, bool *, bool *, double *);
    void (*release)(void *);
};

static void *fmi3_function(void *library, const char *name)
{
    void *found = library ? dlsym(library, name) : NULL;
    if (!found)
        _exit(2);
    return found;
}

/* Ends the process with status 2 where the library, or one of the functions, is not there. */
static struct fmi3 load_fmi3(const char *path)
{
    void *library = dlopen(path, RTLD_NOW);
    return (struct fmi3){
        .instantiate = fmi3_function(library, "fmi3InstantiateCoSimulation"),
        .enter = fmi3_function(library, "fmi3EnterInitializationMode"),
        .leave = fmi3_function(library, "fmi3ExitInitializationMode"),
        .choose = fmi3_function(library, "fmi3SetInt32"),
        .set = fmi3_function(library, "fmi3SetFloat64"),
        .get = fmi3_function(library, "fmi3GetFloat64"),
        .step = fmi3_function(library, "fmi3DoStep"),
        .release = fmi3_function(library, "fmi3FreeInstance"),
    };
}
