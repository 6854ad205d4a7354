/* The three functions about derivatives. A slave that has a method for one offers it; PythonFMU's slaves
 * have none.
 *
 *     set_real_input_derivatives(vrs, orders, values) -> None
 *     get_real_output_derivatives(vrs, orders) -> list of floats
 *     get_directional_derivative(unknowns, knowns, seed) -> list of floats
 */

#include "logging.h"
#include "platform.h"
#include "slave.h"

static void *list_of_orders(const fmi2Integer order[], size_t n)
{
    void *list = py.PyList_New((ptrdiff_t)n);
    for (size_t k = 0; list && k < n; k++) {
        void *number = py.PyLong_FromLong(order[k]);
        if (!number) {
            py.Py_DecRef(list);
            return NULL;
        }
        py.PyList_SetItem(list, (ptrdiff_t)k, number);
    }
    return list;
}

/* Call a method with lists, which are given up, and take `n` numbers from its result, if any. */
static fmi2Status call(Instance *i, const char *function, int gil, OfDerivatives method, void *lists[3],
                       int count, size_t n, fmi2Real value[])
{
    void *result = NULL;
    bool complete = true;
    for (int k = 0; k < count; k++)
        complete = complete && lists[k];
    if (complete)
        result = py.PyObject_CallFunctionObjArgs(i->slave.of_derivatives[method], lists[0], lists[1],
                                                 lists[2], NULL);
    bool taken = result && (!value || take_reals(result, n, value));
    for (int k = 0; k < count; k++)
        py.Py_DecRef(lists[k]);
    py.Py_DecRef(result);
    return leave_python(i, function, gil, !taken);
}

/* Begin a call; NULL, with a message, where it ends before the slave is asked. */
static Slot *begin_call(fmi2Component c, const char *function, int phases, OfDerivatives method,
                        bool complete, int *gil)
{
    Slot *slot = begin(c, function, phases);
    if (!slot)
        return NULL;
    Instance *i = slot->object;
    if (!complete)
        refuse(i, "%s: an argument is NULL, or there are more than a million", function);
    else if (!i->slave.of_derivatives[method])
        refuse(i, "%s: not offered by this FMU, as its modelDescription.xml says", function);
    else if (enter_python(i, function, gil))
        return slot;
    release(slot);
    return NULL;
}

static bool given(size_t n, const void *a, const void *b, const void *c)
{
    return n == 0 || (n <= 1000000 && a && b && c);
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                              const fmi2Integer order[], const fmi2Real value[])
{
    const char *const function = "fmi2SetRealInputDerivatives";
    int gil;
    Slot *slot = begin_call(c, function, SETTING, SLOPES, given(n, vr, order, value), &gil);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    if (i->slave.direct.engine)
        return finish(slot, leave_python(i, function, gil,
                                         !set_slopes(&i->slave.direct, vr, n, order, value)));
    void *lists[] = {list_of_references(vr, n), list_of_orders(order, n), list_of_reals(value, n)};
    return finish(slot, call(i, function, gil, SLOPES, lists, 3, 0, NULL));
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                               const fmi2Integer order[], fmi2Real value[])
{
    const char *const function = "fmi2GetRealOutputDerivatives";
    int gil;
    Slot *slot = begin_call(c, function, GETTING, RATES, given(n, vr, order, value), &gil);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    if (i->slave.direct.engine)
        return done(slot, leave_python(i, function, gil, !get_rates(&i->slave.direct, vr, n, order, value)));
    void *lists[] = {list_of_references(vr, n), list_of_orders(order, n), NULL};
    return done(slot, call(i, function, gil, RATES, lists, 2, n, value));
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
                                               size_t n_unknowns, const fmi2ValueReference knowns[],
                                               size_t n_knowns, const fmi2Real seed[], fmi2Real result[])
{
    const char *const function = "fmi2GetDirectionalDerivative";
    bool complete = given(n_unknowns, unknowns, unknowns, result) && given(n_knowns, knowns, knowns, seed);
    int gil;
    Slot *slot = begin_call(c, function, GETTING, CHANGES, complete, &gil);
    if (!slot)
        return fmi2Error;
    void *lists[] = {list_of_references(unknowns, n_unknowns), list_of_references(knowns, n_knowns),
                     list_of_reals(seed, n_knowns)};
    return done(slot, call(slot->object, function, gil, CHANGES, lists, 3, n_unknowns, result));
}
