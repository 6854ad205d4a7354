/* cost BINARY STUB GUID URI: nanoseconds of a call of the FMU's BINARY in a process whose Python is STUB,
 * which does nothing, less those of as many calls into the stub as it makes: the binary's own share. The
 * least of several rounds. */
#define _GNU_SOURCE
#include "fmi2.h"
#include <stdlib.h>
#include <time.h>

enum { CALLS = 2000, ROUNDS = 2000 };

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

static void *(*volatile stub_function)(void);

/* As many calls into the stub; 0. */
static int bare(int calls)
{
    while (calls--)
        stub_function();
    return 0;
}

int main(int argc, char **argv)
{
    Fmu f;
    fmi2CallbackFunctions callbacks = {on_log, calloc, free, NULL, NULL};
    fmi2ValueReference vr = 0;
    double value = 0.0;
    void *stub = argc == 5 ? dlopen(argv[2], RTLD_NOW | RTLD_GLOBAL) : NULL;
    if (!stub || !fmu_load(&f, argv[1]))
        return 2;
    stub_function = (void *(*)(void))dlsym(stub, "PyList_New");
    fmi2Component i = f.Instantiate("cost", 1, argv[3], argv[4], &callbacks, 0, 0);
    if (!i || f.SetupExperiment(i, 0, 0, 0, 0, 0) || f.EnterInitializationMode(i) ||
        f.ExitInitializationMode(i))
        return 1;
    MEASURE(get, f.GetReal(i, &vr, 1, &value))
    MEASURE(bare_get, bare(12))
    MEASURE(set, f.SetReal(i, &vr, 1, &value))
    MEASURE(bare_set, bare(13))
    MEASURE(step, f.DoStep(i, 0.0, 0.1, 1))
    MEASURE(bare_step, bare(11))
    printf("fmi2GetReal %.1f ns, fmi2SetReal %.1f ns, fmi2DoStep %.1f ns\n", get - bare_get, set - bare_set,
           step - bare_step);
    return 0;
}
