/* Somebody else's FMU: x'' = -k x by explicit Euler steps of 1 ms, plain C, FMI 2.0 for co-simulation.
 * FAULT chooses what is wrong with it. Value references: 0 x, 1 v, 2 k, 3 x_start, 4 u. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NONE, EQUATION, START, STATE, CRASH, RANDOM, RESET, HANG, NOT_A_NUMBER };

typedef struct {
    double value[5];
    double time;
} Instance;

static void defaults(Instance *i)
{
    memset(i, 0, sizeof *i);
    i->value[2] = FAULT == START ? 2.0 : 1.0;
    i->value[3] = 1.0;
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *uri, const void *callbacks,
                      int visible, int logging)
{
    (void)name, (void)type, (void)uri, (void)callbacks, (void)visible, (void)logging;
    if (strcmp(guid, "{oscillator}") != 0)
        return NULL;
    Instance *i = malloc(sizeof *i);
    defaults(i);
    return i;
}

void fmi2FreeInstance(void *c) { free(c); }

int fmi2SetupExperiment(void *c, int given, double tolerance, double start, int stops, double stop)
{
    (void)given, (void)tolerance, (void)stops, (void)stop;
    ((Instance *)c)->time = start;
    return 0;
}

int fmi2EnterInitializationMode(void *c) { (void)c; return 0; }

int fmi2ExitInitializationMode(void *c)
{
    Instance *i = c;
    i->value[0] = i->value[3];
    return 0;
}

int fmi2Terminate(void *c) { (void)c; return 0; }

int fmi2Reset(void *c)
{
    Instance *i = c;
    double v = i->value[1];
    defaults(i);
    if (FAULT == RESET)
        i->value[1] = v;
    return 0;
}

int fmi2GetReal(void *c, const unsigned *vr, size_t n, double *values)
{
    for (size_t k = 0; k < n; k++)
        values[k] = ((Instance *)c)->value[vr[k]];
    return 0;
}

int fmi2SetReal(void *c, const unsigned *vr, size_t n, const double *values)
{
    for (size_t k = 0; k < n; k++)
        ((Instance *)c)->value[vr[k]] = values[k];
    return 0;
}

int fmi2DoStep(void *c, double time, double size, int keep)
{
    Instance *i = c;
    double *value = i->value;
    (void)keep;
    int steps = (int)(size / 1e-3 + 0.5);
    for (int k = 0; k < steps; k++) {
        double x = value[0], v = value[1];
        value[0] = x + 1e-3 * v;
        value[1] = v + 1e-3 * (value[4] - (FAULT == EQUATION ? 1.01 : 1.0) * value[2] * x);
    }
    i->time = time + size;
    if (i->time > 0.5 && FAULT == CRASH)
        abort();
    while (i->time > 0.5 && FAULT == HANG)
        sleep(1);
    if (FAULT == RANDOM)
        value[0] += 1e-9 * getpid();
    if (i->time > 0.5 && FAULT == NOT_A_NUMBER)
        value[0] = 0.0 / (size - size);
    return 0;
}

int fmi2GetFMUstate(void *c, void **state)
{
    if (!*state)
        *state = malloc(sizeof(Instance));
    memcpy(*state, c, sizeof(Instance));
    return 0;
}

int fmi2SetFMUstate(void *c, void *state)
{
    double v = ((Instance *)c)->value[1];
    memcpy(c, state, sizeof(Instance));
    if (FAULT == STATE)
        ((Instance *)c)->value[1] = v;
    return 0;
}

int fmi2FreeFMUstate(void *c, void **state)
{
    (void)c;
    free(*state);
    *state = NULL;
    return 0;
}

int fmi2SerializedFMUstateSize(void *c, void *state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(Instance);
    return 0;
}

int fmi2SerializeFMUstate(void *c, void *state, char *bytes, size_t size)
{
    (void)c;
    memcpy(bytes, state, size);
    return 0;
}

int fmi2DeSerializeFMUstate(void *c, const char *bytes, size_t size, void **state)
{
    (void)c;
    if (!*state)
        *state = malloc(sizeof(Instance));
    memcpy(*state, bytes, size);
    return 0;
}

/* what this FMU does not offer */
#define NOT_THERE(name)                                                                                \
    int fmi2##name(void);                                                                              \
    int fmi2##name(void) { return 3; }

NOT_THERE(SetDebugLogging)
NOT_THERE(GetInteger)
NOT_THERE(GetBoolean)
NOT_THERE(GetString)
NOT_THERE(SetInteger)
NOT_THERE(SetBoolean)
NOT_THERE(SetString)
NOT_THERE(GetDirectionalDerivative)
NOT_THERE(SetRealInputDerivatives)
NOT_THERE(GetRealOutputDerivatives)
NOT_THERE(CancelStep)
NOT_THERE(GetStatus)
NOT_THERE(GetRealStatus)
NOT_THERE(GetIntegerStatus)
NOT_THERE(GetBooleanStatus)
NOT_THERE(GetStringStatus)
