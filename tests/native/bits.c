/* bits LIBRARY RESOURCES GUID FIRST BEHIND_LAST: a run with contact; the values of all variables from
   FIRST on after every step, bit for bit. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

enum { STEPS = 150 };

int main(int argc, char **argv)
{
    void *library = argc > 5 ? OPEN(argv[1]) : NULL;
    if (!library)
        return 2;
    void *(*instantiate)(const char *, int, const char *, const char *, const void *, int, int) =
        FIND(library, "fmi2Instantiate");
    int (*enter)(void *) = FIND(library, "fmi2EnterInitializationMode");
    int (*leave)(void *) = FIND(library, "fmi2ExitInitializationMode");
    int (*step)(void *, double, double, int) = FIND(library, "fmi2DoStep");
    int (*set)(void *, const unsigned *, size_t, const double *) = FIND(library, "fmi2SetReal");
    int (*get)(void *, const unsigned *, size_t, double *) = FIND(library, "fmi2GetReal");
    unsigned from = (unsigned)atoi(argv[4]), to = (unsigned)atoi(argv[5]), drive = 0;
    void *m = instantiate("bits", 1, argv[3], argv[2], NULL, 0, 0);
    if (!m || enter(m) || leave(m))
        return 3;
    for (int i = 0; i < STEPS; i++) {
        double speed = 400.0 - 10.0 * i, value;
        unsigned long long bits;
        if (set(m, &drive, 1, &speed) || step(m, i * 0.008, 0.008, 1))
            return 4;
        for (unsigned vr = from; vr < to; vr++) {
            if (get(m, &vr, 1, &value))
                return 5;
            memcpy(&bits, &value, sizeof bits);
            printf("%016llx ", bits);
        }
        printf("\n");
    }
    return 0;
}
