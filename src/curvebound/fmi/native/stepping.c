/* Communication steps, and inquiries about the last one. */

#include "logging.h"
#include "platform.h"
#include "slave.h"

#include <math.h>

/* By how much a time may be off: what adding up steps costs, or rounding to microseconds or to single
 * precision where that is little beside the step. The slave's code does the same (Engine.do_step). */
static double slack(double step, double time)
{
    double rounding = 1e-6 + 2.4e-7 * fabs(time), adding = 1e-6 * step + 1e-12 * fabs(time);
    rounding = rounding < 0.01 * step ? rounding : 0.01 * step;
    return rounding > adding ? rounding : adding;
}

/* What the slave's method answers: 1 for a step made, 0, or -1 with an exception set. */
static int call_do_step(void *method, double time, double step)
{
    void *now = py.PyFloat_FromDouble(time), *size = py.PyFloat_FromDouble(step), *result = NULL;
    if (now && size)
        result = py.PyObject_CallFunctionObjArgs(method, now, size, NULL);
    int answer = result ? py.PyObject_IsTrue(result) : -1;
    py.Py_DecRef(now);
    py.Py_DecRef(size);
    py.Py_DecRef(result);
    return answer;
}

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_rollback)
{
    Slot *slot = begin(c, "fmi2DoStep", STEPPING);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    int gil;
    (void)no_rollback;
    if (i->now.stop_defined && time + step > i->now.stop + slack(step, i->now.stop)) {
        i->now.step_status = fmi2Error;
        return finish(slot, refuse(i, "a step of %.17g s at %.17g s ends after stopTime = %.17g s: "
                                      "shorten it, or define a later stopTime", step, time, i->now.stop));
    }
    if (!enter_python(i, "fmi2DoStep", &gil))
        return finish(slot, i->now.step_status = fmi2Error);
    const Direct *direct = &i->slave.direct;
    int answer = direct->engine ? direct->do_step(direct->engine, time, step)
                                : call_do_step(i->slave.do_step, time, step);
    bool completed = answer == 1;
    fmi2Status status = leave_python(i, "fmi2DoStep", gil, answer == -1);
    if (status < fmi2Error && !completed)
        status = fmi2Discard;
    i->now.step_status = status;
    if (status < fmi2Discard)
        i->now.time = time + step;
    else if (status == fmi2Discard)
        i->now.phase = DISCARDED;
    return finish(slot, status);
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    Slot *slot = begin(c, "fmi2CancelStep", ANY);
    if (!slot)
        return fmi2Error;
    return done(slot, refuse(slot->object, "fmi2CancelStep: no step is ever pending in this FMU"));
}

/* Begin an inquiry; NULL when it is refused. */
static Slot *begin_inquiry(fmi2Component c, const char *function, bool kind_fits, fmi2StatusKind kind,
                           const void *value)
{
    Slot *slot = begin(c, function, AFTER_A_STEP);
    if (slot && (!kind_fits || !value)) {
        if (kind_fits)
            refuse(slot->object, "%s: value is NULL", function);
        else
            refuse(slot->object, "%s: there is no such status of kind %d", function, (int)kind);
        release(slot);
        return NULL;
    }
    return slot;
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    Slot *slot = begin_inquiry(c, "fmi2GetStatus", kind == fmi2DoStepStatus, kind, value);
    if (!slot)
        return fmi2Error;
    *value = ((Instance *)slot->object)->now.step_status;
    return done(slot, fmi2OK);
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    Slot *slot = begin_inquiry(c, "fmi2GetRealStatus", kind == fmi2LastSuccessfulTime, kind, value);
    if (!slot)
        return fmi2Error;
    *value = ((Instance *)slot->object)->now.time;
    return done(slot, fmi2OK);
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    begin_inquiry(c, "fmi2GetIntegerStatus", false, kind, value); /* FMI 2.0 defines none */
    return fmi2Error;
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    Slot *slot = begin_inquiry(c, "fmi2GetBooleanStatus", kind == fmi2Terminated, kind, value);
    if (!slot)
        return fmi2Error;
    *value = ((Instance *)slot->object)->now.phase == DISCARDED; /* how a PythonFMU slave says it is over */
    return done(slot, fmi2OK);
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    Slot *slot = begin_inquiry(c, "fmi2GetStringStatus", kind == fmi2PendingStatus, kind, value);
    if (!slot)
        return fmi2Error;
    *value = "";
    return done(slot, fmi2OK);
}

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}
