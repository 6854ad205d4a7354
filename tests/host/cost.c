/* cost BINARY STUB GUID URI: nanoseconds of a call through the forwarding library BINARY, whose wrapper
 * is a copy of STUB, and of the same call to STUB itself; the least of several rounds. */
#define _GNU_SOURCE
#include "fmi2.h"
#include <stdlib.h>
#include <time.h>

enum { CALLS = 200000, ROUNDS = 25 };

static void on_log(void *environment, fmi2String instance, fmi2Status status, fmi2String category,
                   fmi2String text, ...)
{
    (void)environment;
    printf("%s %d %s %s\n", instance, status, category, text);
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

/* An indirect call, as an importing tool makes it. */
#define MEASURE(best, call)                                                                            \
    double best = 1e9;                                                                                 \
    for (int round = 0; round < ROUNDS; round++) {                                                     \
        double begin = now();                                                                          \
        for (int k = 0; k < CALLS; k++)                                                                \
            if (call)                                                                                  \
                return 1;                                                                              \
        double each = (now() - begin) / CALLS;                                                         \
        best = each < best ? each : best;                                                              \
    }

int main(int argc, char **argv)
{
    Fmu f;
    fmi2CallbackFunctions callbacks = {on_log, calloc, free, NULL, NULL};
    fmi2ValueReference vr = 0;
    double value = 0.0;
    if (argc != 5 || !fmu_load(&f, argv[1]))
        return 2;
    void *stub = dlopen(argv[2], RTLD_NOW | RTLD_LOCAL);
    fmi2Status (*volatile get)(fmi2Component, const fmi2ValueReference *, size_t, double *) =
        (fmi2Status(*)(fmi2Component, const fmi2ValueReference *, size_t, double *))dlsym(stub, "fmi2GetReal");
    fmi2Status (*volatile step)(fmi2Component, double, double, int) =
        (fmi2Status(*)(fmi2Component, double, double, int))dlsym(stub, "fmi2DoStep");
    fmi2Component i = f.Instantiate("cost", 1, argv[3], argv[4], &callbacks, 0, 0);
    if (!i || f.SetupExperiment(i, 0, 0, 0, 0, 0) || f.EnterInitializationMode(i) ||
        f.ExitInitializationMode(i))
        return 1;
    MEASURE(direct_get, get(i, &vr, 1, &value))
    MEASURE(forwarded_get, f.GetReal(i, &vr, 1, &value))
    MEASURE(direct_step, step(i, 0.0, 0.1, 1))
    MEASURE(forwarded_step, f.DoStep(i, 0.0, 0.1, 1))
    MEASURE(forwarded_set, f.SetReal(i, &vr, 1, &value))
    printf("fmi2GetReal %.1f ns, fmi2SetReal %.1f ns, fmi2DoStep %.1f ns\n", forwarded_get - direct_get,
           forwarded_set - direct_get, forwarded_step - direct_step);
    return 0;
}
