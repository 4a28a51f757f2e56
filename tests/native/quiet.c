/* quiet LIBRARY RESOURCES TOKEN EARLY STEP STEPS SPEED RATE OUTPUT: an FMU of FMI 3.0 whose steps may
   take no memory and call no system. EARLY: whether a step may return early; RATE: of the speed, a
   step. Counts what is allocated or freed by the steps between two `write`s; with "guard" behind
   OUTPUT the kernel ends the process at any other call. Prints the count, and the output at the end,
   bit for bit. */
#define _GNU_SOURCE
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include "fmi3.h"

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);
extern void __libc_free(void *);
static volatile long calls;

/* In the place of the C library's, for the library loaded too. */
void *malloc(size_t size)
{
    calls++;
    return __libc_malloc(size);
}
void *calloc(size_t count, size_t size)
{
    calls++;
    return __libc_calloc(count, size);
}
void *realloc(void *at, size_t size)
{
    calls++;
    return __libc_realloc(at, size);
}
void free(void *at)
{
    calls++;
    __libc_free(at);
}

/* From here on the kernel lets `write` and the end of the process pass alone. */
static int guard(void)
{
    struct sock_filter only[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, 0),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_write, 1, 0),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
    };
    struct sock_fprog program = {sizeof only / sizeof *only, only};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) || prctl(PR_SET_SECCOMP, 2, &program);
}

int main(int argc, char **argv)
{
    if (argc < 10)
        return 2;
    struct fmi3 fmu = load_fmi3(argv[1]);
    double h = atof(argv[5]), speed = atof(argv[7]), rate = atof(argv[8]), value = 0.0, last;
    long steps = atol(argv[6]);
    uint32_t drive = 0, output = (uint32_t)atoi(argv[9]);
    bool event, ended, early;
    void *m
        = fmu.instantiate("quiet", argv[3], argv[2], 0, 0, 0, atoi(argv[4]), NULL, 0, NULL, NULL,
                          NULL);
    if (!m || fmu.set(m, &drive, 1, &speed, 1) || fmu.enter(m, 0, 0.0, 0.0, 0, 0.0) || fmu.leave(m))
        return 3;
    if (argc > 10 && guard())
        return 4;
    long before = calls;
    write(1, "begin\n", 6);
    for (long i = 0; i < steps; i++) {
        double now = speed + rate * (double)i;
        if (fmu.set(m, &drive, 1, &now, 1)
            || fmu.step(m, (double)i * h, h, 1, &event, &ended, &early, &last)
            || fmu.get(m, &output, 1, &value, 1))
            _exit(5);
    }
    write(1, "end\n", 4);
    long taken = calls - before;
    uint64_t bits;
    char line[64];
    memcpy(&bits, &value, sizeof bits);
    int size = snprintf(line, sizeof line, "%ld %016llx\n", taken, (unsigned long long)bits);
    write(1, line, (size_t)size);
    _exit(0);
}
