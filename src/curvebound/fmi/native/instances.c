/* From fmi2Instantiate to fmi2FreeInstance: making and freeing instances, and their phases. */

#define _GNU_SOURCE
#include "fmu.h"
#include "interpreter.h"
#include "logging.h"
#include "platform.h"
#include "slave.h"
#include "states.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *name_of(Phase phase)
{
    switch (phase) {
    case INSTANTIATED: return "before fmi2EnterInitializationMode";
    case INITIALIZING: return "in initialization mode";
    case STEPPING: return "between communication steps";
    case DISCARDED: return "after a discarded step";
    case FAILED: return "after an error: only reading, fmi2SetFMUstate, fmi2Reset and "
                        "fmi2FreeInstance can follow";
    case TERMINATED: return "after fmi2Terminate";
    }
    return "";
}

Slot *begin(fmi2Component c, const char *function, int allowed)
{
    Slot *slot = acquire(INSTANCE, c);
    if (!slot)
        return NULL;
    Instance *i = slot->object;
    i->worst = fmi2OK;
    i->interrupted = false;
    if (!(i->now.phase & allowed)) {
        refuse(i, "%s is not allowed %s", function, name_of(i->now.phase));
        release(slot);
        return NULL;
    }
    return slot;
}

static void free_instance(Instance *i)
{
    free_categories(i->categories, i->n_categories);
    free(i->name);
    free(i->resources);
    free(i);
}

/* Find and make all that an instance needs; says why not. `asked` and `uri` are what the tool gave. */
static bool set_up(Instance *i, fmi2Type type, fmi2String asked, fmi2String uri, Text *why)
{
    const char *guid = guid_of_fmu();
    if (!i->name || !*i->name)
        append(why, "instanceName is NULL, empty or not UTF-8: pass a name");
    else if (type != fmi2CoSimulation)
        append(why, "fmuType = %d: this FMU supports co-simulation only (fmi2CoSimulation = 1)", type);
    else if (!guid)
        append(why, "out of memory");
    else if (!asked || (*guid && strcmp(asked, guid) != 0))
        append(why, "fmuGUID = %s is not that of this FMU, %s: read it from its modelDescription.xml",
               asked ? asked : "NULL", guid);
    else if (!i->resources || !is_utf8(i->resources))
        append(why, "fmuResourceLocation = %s names no folder of this machine: pass file:///... in UTF-8",
               uri ? uri : "NULL");
    else if (!has_module(i->resources))
        append(why, "fmuResourceLocation = %s (%s) is not the resources folder of this FMU",
               uri ? uri : "NULL", i->resources);
    else if (have_python(i->resources, why) && open_slave(i, why)) {
        if ((i->handle = issue(INSTANCE, i, NULL)))
            return true;
        close_slave(i);
        append(why, "out of memory");
    }
    return false;
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String asked, fmi2String uri,
                                     const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                                     fmi2Boolean logging)
{
    Text why = {0};
    Instance *i = functions ? calloc(1, sizeof *i) : NULL;
    if (!i) /* nobody to tell */
        return NULL;
    i->host = *functions;
    i->visible = visible;
    i->logging = logging;
    i->now.phase = INSTANTIATED;
    i->name = name && is_utf8(name) ? strdup(name) : NULL;
    /* some tools pass no location: the resources are beside this library */
    i->resources = uri && *uri ? path_of(uri) : resources_of_fmu();
    bool done = set_up(i, type, asked, uri, &why);
    if (!done) {
        log_to(&i->host, i->name ? i->name : "", fmi2Error, "logStatusError", text_of(&why));
        free_instance(i);
    }
    free(why.text);
    return done ? i->handle : NULL;
}

EXPORT void fmi2FreeInstance(fmi2Component c)
{
    Slot *slot = begin(c, "fmi2FreeInstance", ANY), *state;
    if (!slot)
        return;
    Instance *i = slot->object;
    for (uint32_t place = 0; (state = next_state_of(c, &place));)
        drop_state(state);
    close_slave(i);
    retire(slot);
    free_instance(i);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                      fmi2Real start_time, fmi2Boolean stop_defined, fmi2Real stop)
{
    Slot *slot = begin(c, "fmi2SetupExperiment", INSTANTIATED);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    if (!isfinite(start_time))
        return finish(slot, refuse(i, "startTime = %g: pass a finite time", start_time));
    if (stop_defined && !(isfinite(stop) && stop >= start_time))
        return finish(slot, refuse(i, "stopTime = %g: pass a finite time not before startTime = %g", stop,
                                   start_time));
    i->now.time = start_time;
    i->now.stop_defined = stop_defined;
    i->now.stop = stop;
    int gil;
    if (!enter_python(i, "fmi2SetupExperiment", &gil))
        return finish(slot, fmi2Error);
    void *times[] = {py.PyFloat_FromDouble(start_time), stop_defined ? py.PyFloat_FromDouble(stop) : py.none,
                     tolerance_defined ? py.PyFloat_FromDouble(tolerance) : py.none};
    void *result = NULL;
    if (times[0] && times[1] && times[2])
        result = call_method(i->slave.object, "setup_experiment", times[0], times[1], times[2]);
    for (int k = 0; k < 3; k++)
        if (times[k] != py.none)
            py.Py_DecRef(times[k]);
    py.Py_DecRef(result);
    return finish(slot, leave_python(i, "fmi2SetupExperiment", gil, !result));
}

/* The three functions that lead from one phase to the next. */
static fmi2Status move_on(fmi2Component c, const char *function, const char *method, int allowed,
                          Phase next)
{
    Slot *slot = begin(c, function, allowed);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    int gil;
    if (next == TERMINATED && !py.Py_IsInitialized()) { /* the process ends: nothing remains to be done */
        i->now.phase = next;
        return done(slot, fmi2OK);
    }
    if (!enter_python(i, function, &gil))
        return finish(slot, fmi2Error);
    void *result = call_method(i->slave.object, method, NULL, NULL, NULL);
    py.Py_DecRef(result);
    fmi2Status status = leave_python(i, function, gil, !result);
    if (status < fmi2Error)
        i->now.phase = next;
    return finish(slot, status);
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return move_on(c, "fmi2EnterInitializationMode", "enter_initialization_mode", INSTANTIATED,
                   INITIALIZING);
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return move_on(c, "fmi2ExitInitializationMode", "exit_initialization_mode", INITIALIZING, STEPPING);
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    return move_on(c, "fmi2Terminate", "terminate", STEPPING | DISCARDED, TERMINATED);
}

EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    Slot *slot = begin(c, "fmi2Reset", ANY);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    fmi2Status status = renew_slave(i);
    if (status < fmi2Error)
        i->now = (Progress){.phase = INSTANTIATED, .step_status = fmi2OK};
    return finish(slot, status);
}
