#include "direct.h"

#include "python.h"

#include <string.h>

/* A function of direct.py by its name, if it has the result and arguments that are expected: Cython puts
 * it into a capsule that is named by them. */
static void *function_of(void *functions, const char *name, const char *result, const char *arguments)
{
    void *capsule = py.PyDict_GetItemString(functions, name);
    const char *type = capsule ? py.PyCapsule_GetName(capsule) : NULL;
    if (!type || strncmp(type, result, strlen(result)) != 0)
        return NULL;
    size_t length = strlen(type), end = strlen(arguments);
    if (length < end || strcmp(type + length - end, arguments) != 0)
        return NULL;
    return py.PyCapsule_GetPointer(capsule, type);
}

#define FIND(name, result, arguments)                                                                  \
    (*(void **)&direct->name = function_of(functions, "direct__" #name, result " (struct ",            \
                                           "DerivativeEngine *, " arguments ")"))

void find_direct(Direct *direct, void *slave)
{
    void *functions = py.PyObject_GetAttrString(slave, "direct");
    if (functions && functions != py.none && FIND(do_step, "int", "double, double") &&
        FIND(get_real, "double", "PY_LONG_LONG") && FIND(set_real, "int", "PY_LONG_LONG, double") &&
        FIND(set_slope, "int", "PY_LONG_LONG, PY_LONG_LONG, double") &&
        FIND(get_rate, "double", "PY_LONG_LONG, PY_LONG_LONG"))
        direct->engine = py.PyObject_GetAttrString(slave, "engine");
    py.Py_DecRef(functions); /* they live as long as the engine's module */
    py.PyErr_Clear();
}

/* Whether a function that returns numbers has raised: it has returned this, then. */
static bool raised(double value)
{
    return value == -3.3e-301 && py.PyErr_Occurred();
}

bool get_reals(const Direct *direct, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    for (size_t k = 0; k < n; k++) {
        value[k] = direct->get_real(direct->engine, vr[k]);
        if (raised(value[k]))
            return false;
    }
    return true;
}

bool set_reals(const Direct *direct, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
    for (size_t k = 0; k < n; k++)
        if (direct->set_real(direct->engine, vr[k], value[k]) == -1)
            return false;
    return true;
}

bool set_slopes(const Direct *direct, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                const fmi2Real value[])
{
    for (size_t k = 0; k < n; k++)
        if (direct->set_slope(direct->engine, vr[k], order[k], value[k]) == -1)
            return false;
    return true;
}

bool get_rates(const Direct *direct, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
               fmi2Real value[])
{
    for (size_t k = 0; k < n; k++) {
        value[k] = direct->get_rate(direct->engine, vr[k], order[k]);
        if (raised(value[k]))
            return false;
    }
    return true;
}
