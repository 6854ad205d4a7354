/* A co-simulation FMU (FMI 2.0) in C: what the FMUs built from Python are measured against.
 *
 * Compiled with -DPLANT_BEAD or -DPLANT_PENDULUM. Value references are the positions in the table of
 * variables; a communication step is divided evenly into the fewest internal Runge-Kutta steps that
 * are not larger than solver.step; outputs are computed when first read after a step.
 */
#include "fmi2.h"
#include "physics.h"

#include <string.h>

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define REAL(identifier, name, causality, unit, start) identifier,
enum {
#if defined PLANT_BEAD
#include "bead_variables.h"
#elif defined PLANT_PENDULUM
#include "pendulum_variables.h"
#else
#error "choose a plant: -DPLANT_BEAD or -DPLANT_PENDULUM"
#endif
    VARIABLE_COUNT
};
#undef REAL

#if defined PLANT_BEAD
#include "plant_bead.h"
#else
#include "plant_pendulum.h"
#endif

#define REAL(identifier, name, causality, unit, start) start,
static const double starts[VARIABLE_COUNT] = {
#include VARIABLES
};
#undef REAL

typedef struct {
    double r[VARIABLE_COUNT];
    plant plant;
    double start_time, time;
    int observed; /* whether the outputs in r belong to the present state */
    fmi2CallbackFunctions callbacks;
    char name[128];
} instance;

static fmi2Status fail(instance *c, const char *message)
{
    if (c->callbacks.logger)
        c->callbacks.logger(c->callbacks.componentEnvironment, c->name, fmi2Error, "error", "%s",
                            message);
    return fmi2Error;
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                     fmi2String resources,
                                     const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                     fmi2Boolean logging)
{
    (void)resources, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || !callbacks || !guid || strcmp(guid, GUID) != 0)
        return NULL;
    instance *c = callbacks->allocateMemory(1, sizeof *c);
    if (!c)
        return NULL;
    memset(c, 0, sizeof *c);
    c->callbacks = *callbacks;
    strncpy(c->name, name ? name : "", sizeof c->name - 1);
    memcpy(c->r, starts, sizeof starts);
    return c;
}

EXPORT void fmi2FreeInstance(fmi2Component component)
{
    instance *c = component;

    if (c)
        c->callbacks.freeMemory(c);
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n,
                                      const fmi2String categories[])
{
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean has_tolerance,
                                      fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop,
                                      fmi2Real stop)
{
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    ((instance *)component)->start_time = start;
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component)
{
    instance *c = component;
    const char *message = plant_start(&c->plant, c->r);

    if (!message && !(c->r[solver_step] > 0.0))
        message = "solver.step must be above zero";
    c->time = c->start_time;
    c->observed = 0;
    return message ? fail(c, message) : fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component component)
{
    memcpy(((instance *)component)->r, starts, sizeof starts);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                              fmi2Real value[])
{
    instance *c = component;

    if (!c->observed) {
        plant_observe(&c->plant, c->r);
        c->observed = 1;
    }
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= VARIABLE_COUNT)
            return fail(c, "unknown value reference of a Real");
        value[i] = c->r[vr[i]];
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                              const fmi2Real value[])
{
    instance *c = component;

    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= VARIABLE_COUNT)
            return fail(c, "unknown value reference of a Real");
        if (!isfinite(value[i]))
            return fail(c, "a Real must be finite");
        c->r[vr[i]] = value[i];
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real point, fmi2Real duration,
                             fmi2Boolean no_going_back)
{
    instance *c = component;

    (void)no_going_back;
    if (!(duration > 0.0))
        return fail(c, "the communication step must be above zero");
    if (fabs(point - c->time) > 1e-9 * (1.0 + fabs(point)))
        return fail(c, "the communication point is not the FMU's present time");

    const double ratio = duration / c->r[solver_step];
    const long count = ratio <= 1.0 ? 1 : (long)ceil(ratio * (1.0 - 1e-12));
    const plant before = c->plant;

    plant_step(&c->plant, c->r, duration, count);
    if (!plant_is_finite(&c->plant)) {
        c->plant = before;
        return fail(c, "the state left the finite numbers; choose a smaller solver.step");
    }
    c->time = point + duration;
    c->observed = 0;
    return fmi2OK;
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    return fail(c, "fmi2CancelStep: steps are synchronous");
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
{
    (void)c, (void)kind;
    *value = fmi2OK;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real *value)
{
    (void)kind;
    *value = ((instance *)c)->time;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value)
{
    (void)c, (void)kind, (void)value;
    return fmi2Discard;
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)c, (void)kind;
    *value = 0;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind kind, fmi2String *value)
{
    (void)c, (void)kind;
    *value = "";
    return fmi2Discard;
}

/* -- What this FMU does not have; the standard wants the symbols all the same -------------------- */

#define LACKS(name, ...)                                                                           \
    EXPORT fmi2Status name(fmi2Component c, __VA_ARGS__) { return fail(c, #name ": not supported"); }

#define REFERENCES const fmi2ValueReference *vr, size_t n
#pragma GCC diagnostic ignored "-Wunused-parameter"

/* No variables of these types: nothing to get or set is no error */
#define EMPTY(name, type)                                                                          \
    EXPORT fmi2Status name(fmi2Component c, REFERENCES, type *value)                               \
    {                                                                                              \
        return n == 0 ? fmi2OK : fail(c, #name ": there is no such variable");                     \
    }

EMPTY(fmi2GetInteger, fmi2Integer)
EMPTY(fmi2GetBoolean, fmi2Boolean)
EMPTY(fmi2GetString, fmi2String)
EMPTY(fmi2SetInteger, const fmi2Integer)
EMPTY(fmi2SetBoolean, const fmi2Boolean)
EMPTY(fmi2SetString, const fmi2String)
LACKS(fmi2SetRealInputDerivatives, REFERENCES, const fmi2Integer *order, const fmi2Real *value)
LACKS(fmi2GetRealOutputDerivatives, REFERENCES, const fmi2Integer *order, fmi2Real *value)
LACKS(fmi2GetFMUstate, fmi2FMUstate *s)
LACKS(fmi2SetFMUstate, fmi2FMUstate s)
LACKS(fmi2FreeFMUstate, fmi2FMUstate *s)
LACKS(fmi2SerializedFMUstateSize, fmi2FMUstate s, size_t *size)
LACKS(fmi2SerializeFMUstate, fmi2FMUstate s, fmi2Byte *bytes, size_t size)
LACKS(fmi2DeSerializeFMUstate, const fmi2Byte *bytes, size_t size, fmi2FMUstate *s)
LACKS(fmi2GetDirectionalDerivative, const fmi2ValueReference *unknown, size_t unknowns,
      const fmi2ValueReference *known, size_t knowns, const fmi2Real *seed, fmi2Real *value)
