/* real_time LIBRARY RESOURCES TOKEN STEP STEPS RUNS CLOCK MODE,VALUE LOW,HIGH,RATE
             [SENSOR,MAGNET,FORCE ...]: an FMU for real time of FMI 3.0.
   Its speed, its first variable, goes up and down from LOW to HIGH [rad/s] at RATE [rad/s2].
   MODE,VALUE: an integer that is set before. For each axis of magnetic bearings the references of the
   displacements at the sensor and in the magnet, and of the force, which a controller in the loop
   sets. Measures every communication step by CLOCK, `wall` or `cpu`, in each of RUNS equal runs, and
   takes the least of them, step for step. Prints the median, the quantiles 0.99, 0.999, 0.9999 and
   the longest, then the mean [us]. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

#include "fmi3.h"

enum { MOST = 8 };
/* The controller of examples/magnetic_bearing, without its filter and its integral part. */
static const double KP = 12000.0, KD = 16.0, BIAS = 3.0, K = 5.5e-6, GAP = 5e-4;

static double now(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int order(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double force(double s, double rate, double d)
{
    double i = -(KP * s + KD * rate);
    i = i > BIAS ? BIAS : i < -BIAS ? -BIAS : i;
    double a = (BIAS + i) / (GAP - d), b = (BIAS - i) / (GAP + d);
    return K * (a * a - b * b);
}

int main(int argc, char **argv)
{
    if (argc < 10)
        return 2;
    struct fmi3 fmu = load_fmi3(argv[1]);
    double h = atof(argv[4]), low, high, rate, values[2 * MOST], forces[MOST + 1];
    long steps = atol(argv[5]);
    clockid_t clock = strcmp(argv[7], "cpu") ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
    uint32_t mode, seen[2 * MOST], driven[MOST + 1] = {0};
    int32_t chosen;
    size_t axes = (size_t)(argc - 10);
    bool event, ended, early;
    double last;
    if (axes > MOST || sscanf(argv[8], "%u,%d", &mode, &chosen) != 2
        || sscanf(argv[9], "%lf,%lf,%lf", &low, &high, &rate) != 3)
        return 2;
    for (size_t i = 0; i < axes; i++)
        if (sscanf(argv[10 + i], "%u,%u,%u", &seen[2 * i], &seen[2 * i + 1], &driven[1 + i]) != 3)
            return 2;
    float *taken = malloc((size_t)steps * sizeof *taken);
    if (!taken)
        return 4;
    for (long n = 0; n < steps; n++)
        taken[n] = 1e30f;
    mlockall(MCL_CURRENT);
    for (int run = 0; run < atoi(argv[6]); run++) {
        double speed = low, change = rate * h, before[MOST] = {0};
        forces[0] = low;
        void *m
            = fmu.instantiate("real_time", argv[3], argv[2], 0, 0, 0, 1, NULL, 0, NULL, NULL, NULL);
        if (!m || fmu.choose(m, &mode, 1, &chosen, 1) || fmu.set(m, driven, 1, forces, 1)
            || fmu.enter(m, 0, 0.0, 0.0, 0, 0.0) || fmu.leave(m))
            return 3;
        for (long n = 0; n < steps; n++) {
            double begun = now(clock);
            forces[0] = speed;
            if (axes && fmu.get(m, seen, 2 * axes, values, 2 * axes))
                return 5;
            for (size_t i = 0; i < axes; i++) {
                double rate_of_change = (values[2 * i] - before[i]) / h;
                forces[1 + i] = force(values[2 * i], rate_of_change, values[2 * i + 1]);
                before[i] = values[2 * i];
            }
            if (fmu.set(m, driven, 1 + axes, forces, 1 + axes)
                || fmu.step(m, (double)n * h, h, 1, &event, &ended, &early, &last))
                return 6;
            float time = (float)((now(clock) - begun) * 1e6);
            taken[n] = time < taken[n] ? time : taken[n];
            speed += change;
            if ((change > 0 && speed > high) || (change < 0 && speed < low))
                change = -change;
        }
        fmu.release(m);
    }
    double sum = 0.0;
    for (long n = 0; n < steps; n++)
        sum += taken[n];
    qsort(taken, (size_t)steps, sizeof *taken, order);
    const double at[] = {0.5, 0.99, 0.999, 0.9999};
    for (int i = 0; i < 4; i++)
        printf("%.9g ", taken[(long)(at[i] * (double)(steps - 1))]);
    printf("%.9g %.9g\n", taken[steps - 1], sum / (double)steps);
    return 0;
}
