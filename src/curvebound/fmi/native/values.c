/* Reading and setting variables. */

#include "logging.h"
#include "platform.h"
#include "slave.h"

bool usable(Instance *i, const char *function, const void *references, size_t n, const void *values)
{
    enum { MOST = 1000000 };
    if (n > MOST)
        refuse(i, "%s: nvr = %zu is more than any FMU has variables", function, n);
    else if (n > 0 && !(references && values))
        refuse(i, "%s: %s is NULL: pass arrays of nvr = %zu elements", function,
               references ? "value" : "vr", n);
    else
        return true;
    return false;
}

/* -- one value of each type, to and from Python -- */

#define from_Integer(x) py.PyLong_FromLong(x)
#define from_Boolean(x) py.PyBool_FromLong(x)
#define from_String(x) py.PyUnicode_FromString(x)

static bool to_Integer(void *object, fmi2Integer *value)
{
    long number = py.PyLong_AsLong(object);
    *value = (fmi2Integer)number;
    return !(number == -1 && py.PyErr_Occurred());
}

static bool to_Boolean(void *object, fmi2Boolean *value)
{
    *value = py.PyObject_IsTrue(object);
    return *value >= 0;
}

static bool to_String(void *object, fmi2String *value)
{
    *value = py.PyUnicode_AsUTF8AndSize(object, NULL);
    return *value != NULL;
}

/* Texts live as long as the list that holds them: until the next call. */
static void hold(Instance *i, void *list)
{
    py.Py_IncRef(list);
    py.Py_DecRef(i->strings);
    i->strings = list;
}

#define hold_Integer(i, list)
#define hold_Boolean(i, list)
#define hold_String(i, list) hold(i, list)

#define LISTS(name)                                                                                    \
    static void *list_of_##name(const fmi2##name value[], size_t n)                                    \
    {                                                                                                  \
        void *list = py.PyList_New((ptrdiff_t)n);                                                      \
        for (size_t k = 0; list && k < n; k++) {                                                       \
            void *object = from_##name(value[k]);                                                      \
            if (!object) {                                                                             \
                py.Py_DecRef(list);                                                                    \
                return NULL;                                                                           \
            }                                                                                          \
            py.PyList_SetItem(list, (ptrdiff_t)k, object);                                             \
        }                                                                                              \
        return list;                                                                                   \
    }                                                                                                  \
                                                                                                       \
    static bool take_##name(Instance *i, void *list, size_t n, fmi2##name value[])                     \
    {                                                                                                  \
        for (size_t k = 0; k < n; k++) {                                                               \
            void *object = py.PyList_GetItem(list, (ptrdiff_t)k);                                      \
            if (!object || !to_##name(object, &value[k]))                                              \
                return false;                                                                          \
        }                                                                                              \
        (void)i;                                                                                       \
        hold_##name(i, list);                                                                          \
        return true;                                                                                   \
    }

LISTS(Integer)
LISTS(Boolean)
LISTS(String)

#define list_of_Real list_of_reals
#define take_Real(i, list, n, value) take_reals(list, n, value)

/* -- by methods of the slave, with lists -- */

#define get_Real(i, vr) py.PyObject_CallFunctionObjArgs(i->slave.get_real, vr, NULL)
#define get_Integer(i, vr) call_method(i->slave.object, "get_integer", vr, NULL, NULL)
#define get_Boolean(i, vr) call_method(i->slave.object, "get_boolean", vr, NULL, NULL)
#define get_String(i, vr) call_method(i->slave.object, "get_string", vr, NULL, NULL)
#define set_Real(i, vr, values) py.PyObject_CallFunctionObjArgs(i->slave.set_real, vr, values, NULL)
#define set_Integer(i, vr, values) call_method(i->slave.object, "set_integer", vr, values, NULL)
#define set_Boolean(i, vr, values) call_method(i->slave.object, "set_boolean", vr, values, NULL)
#define set_String(i, vr, values) call_method(i->slave.object, "set_string", vr, values, NULL)

#define BY_METHODS(name)                                                                               \
    static bool read_##name(Instance *i, const fmi2ValueReference vr[], size_t n, fmi2##name value[])  \
    {                                                                                                  \
        void *references = list_of_references(vr, n), *values = NULL;                                  \
        if (references)                                                                                \
            values = get_##name(i, references);                                                        \
        bool taken = values && take_##name(i, values, n, value);                                       \
        py.Py_DecRef(references);                                                                      \
        py.Py_DecRef(values);                                                                          \
        return taken;                                                                                  \
    }                                                                                                  \
                                                                                                       \
    static bool write_##name(Instance *i, const fmi2ValueReference vr[], size_t n,                     \
                             const fmi2##name value[])                                                 \
    {                                                                                                  \
        void *references = list_of_references(vr, n), *values = list_of_##name(value, n);              \
        void *result = references && values ? set_##name(i, references, values) : NULL;                \
        py.Py_DecRef(references);                                                                      \
        py.Py_DecRef(values);                                                                          \
        py.Py_DecRef(result);                                                                          \
        return result != NULL;                                                                         \
    }

BY_METHODS(Real)
BY_METHODS(Integer)
BY_METHODS(Boolean)
BY_METHODS(String)

/* -- calls -- */

#define direct_Real(i) (i->slave.direct.engine != NULL)
#define direct_Integer(i) false
#define direct_Boolean(i) false
#define direct_String(i) false

#define passable_Real(i, n, value) true
#define passable_Integer(i, n, value) true
#define passable_Boolean(i, n, value) true

static bool passable_String(Instance *i, size_t n, const fmi2String *value)
{
    for (size_t k = 0; k < n; k++)
        if (!value[k] || !is_utf8(value[k])) {
            refuse(i, "fmi2SetString: value[%zu] is NULL or not UTF-8", k);
            return false;
        }
    return true;
}

#define GETTER(name)                                                                                   \
    EXPORT fmi2Status fmi2Get##name(fmi2Component c, const fmi2ValueReference vr[], size_t n,          \
                                    fmi2##name value[])                                                \
    {                                                                                                  \
        Slot *slot = begin(c, "fmi2Get" #name, GETTING);                                               \
        int gil;                                                                                       \
        if (!slot)                                                                                     \
            return fmi2Error;                                                                          \
        Instance *i = slot->object;                                                                    \
        if (!usable(i, "fmi2Get" #name, vr, n, value))                                                 \
            return done(slot, fmi2Error);                                                              \
        if (n == 0)                                                                                    \
            return done(slot, fmi2OK);                                                                 \
        if (!enter_python(i, "fmi2Get" #name, &gil))                                                   \
            return done(slot, fmi2Error);                                                              \
        bool taken = direct_##name(i) ? get_reals(&i->slave.direct, vr, n, (void *)value)              \
                                      : read_##name(i, vr, n, value);                                  \
        return done(slot, leave_python(i, "fmi2Get" #name, gil, !taken));                              \
    }

#define SETTER(name)                                                                                   \
    EXPORT fmi2Status fmi2Set##name(fmi2Component c, const fmi2ValueReference vr[], size_t n,          \
                                    const fmi2##name value[])                                          \
    {                                                                                                  \
        Slot *slot = begin(c, "fmi2Set" #name, SETTING);                                               \
        int gil;                                                                                       \
        if (!slot)                                                                                     \
            return fmi2Error;                                                                          \
        Instance *i = slot->object;                                                                    \
        if (!usable(i, "fmi2Set" #name, vr, n, value) || !passable_##name(i, n, value))                \
            return done(slot, fmi2Error);                                                              \
        if (n == 0)                                                                                    \
            return done(slot, fmi2OK);                                                                 \
        if (!enter_python(i, "fmi2Set" #name, &gil))                                                   \
            return done(slot, fmi2Error);                                                              \
        bool taken = direct_##name(i) ? set_reals(&i->slave.direct, vr, n, (const void *)value)        \
                                      : write_##name(i, vr, n, value);                                 \
        return finish(slot, leave_python(i, "fmi2Set" #name, gil, !taken));                            \
    }

GETTER(Real)
GETTER(Integer)
GETTER(Boolean)
GETTER(String)
SETTER(Real)
SETTER(Integer)
SETTER(Boolean)
SETTER(String)
