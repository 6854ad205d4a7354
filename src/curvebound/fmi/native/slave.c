#define _GNU_SOURCE
#include "slave.h"

#include "folders.h"
#include "logging.h"
#include "platform.h"

#include <stdlib.h>
#include <string.h>

/* -- the module and its class -- */

static char *module_name(const char *resources)
{
    char *path = formatted("%s/slavemodule.txt", resources);
    char *name = path ? read_text(path) : NULL;
    free(path);
    if (name)
        name[strcspn(name, "\r\n")] = 0;
    return name;
}

bool has_module(const char *resources)
{
    char *name = module_name(resources);
    char *path = name && *name ? formatted("%s/%s.py", resources, name) : NULL;
    bool found = path && is_file(path);
    free(name);
    free(path);
    return found;
}

/* How many classes a class descends from, if it is a slave's: PythonFMU takes the one with the most. */
static ptrdiff_t depth_of(void *type)
{
    void *bases = py.PyObject_GetAttrString(type, "__mro__");
    ptrdiff_t depth = bases ? py.PyTuple_Size(bases) : 0;
    bool is_slave = false;
    for (ptrdiff_t k = 0; k < depth && !is_slave; k++) {
        void *name = py.PyObject_GetAttrString(py.PyTuple_GetItem(bases, k), "__name__");
        char *text = python_text(name);
        is_slave = text && strcmp(text, "Fmi2Slave") == 0;
        free(text);
        py.Py_DecRef(name);
    }
    py.Py_DecRef(bases);
    py.PyErr_Clear(); /* what has no __mro__ is no class */
    return is_slave ? depth : 0;
}

/* The FMU's class, a new reference; NULL with an exception set, or without where there is none. */
static void *find_class(const char *module)
{
    void *loaded = py.PyImport_ImportModule(module), *found = NULL, *value;
    void *all = loaded ? py.PyModule_GetDict(loaded) : NULL;
    ptrdiff_t deepest = 0;
    for (ptrdiff_t place = 0; all && py.PyDict_Next(all, &place, NULL, &value);) {
        ptrdiff_t depth = depth_of(value);
        if (depth > deepest) {
            deepest = depth;
            found = value;
        }
    }
    py.Py_IncRef(found);
    py.Py_DecRef(loaded);
    return found;
}

/* -- the object -- */

static void drop(Slave *slave)
{
    void *all[] = {slave->direct.engine, slave->object,   slave->do_step,
                   slave->get_real,      slave->set_real, slave->queue};
    for (int k = SLOPES; k <= CHANGES; k++)
        py.Py_DecRef(slave->of_derivatives[k]);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        py.Py_DecRef(all[k]);
    *slave = (Slave){0};
}

/* A fresh object of the instance's class; false with an exception set. */
static bool make(Instance *i, Slave *slave)
{
    const struct {
        const char *name;
        void *value;
    } options[] = {
        {"instance_name", py.PyUnicode_FromString(i->name)},
        {"resources", py.PyUnicode_FromString(i->resources)},
        {"visible", py.PyBool_FromLong(i->visible)},
    };
    void *keywords = py.PyDict_New(), *none = py.PyTuple_New(0);
    bool complete = keywords && none;
    for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
        complete = complete && options[k].value &&
                   py.PyDict_SetItemString(keywords, options[k].name, options[k].value) == 0;
        py.Py_DecRef(options[k].value);
    }
    *slave = (Slave){0};
    if (complete)
        slave->object = py.PyObject_Call(i->type, none, keywords);
    py.Py_DecRef(keywords);
    py.Py_DecRef(none);
    complete = slave->object &&
               (slave->do_step = py.PyObject_GetAttrString(slave->object, "do_step")) &&
               (slave->get_real = py.PyObject_GetAttrString(slave->object, "get_real")) &&
               (slave->set_real = py.PyObject_GetAttrString(slave->object, "set_real")) &&
               (slave->queue = call_method(slave->object, "_get_log_queue", NULL, NULL, NULL)) &&
               py.PyList_Size(slave->queue) >= 0;
    if (!complete) {
        drop(slave);
        return false;
    }
    const char *const names[] = {"set_real_input_derivatives", "get_real_output_derivatives",
                                 "get_directional_derivative"};
    for (int k = SLOPES; k <= CHANGES; k++) {
        slave->of_derivatives[k] = py.PyObject_GetAttrString(slave->object, names[k]);
        py.PyErr_Clear();
    }
    find_direct(&slave->direct, slave->object);
    return true;
}

bool open_slave(Instance *i, Text *why)
{
    void *interrupt = NULL;
    char *module = module_name(i->resources);
    int gil = py.PyGILState_Ensure();
    i->folder = module ? enter_folder(i->resources) : NULL;
    i->type = i->folder ? find_class(module) : NULL;
    bool made = i->type && make(i, &i->slave);
    if (!made) {
        if (py.PyErr_Occurred()) {
            char *text = take_exception(&interrupt);
            append(why, "the Python code raised an exception: %s", text ? text : "unknown");
            free(text);
        } else {
            append(why, "module %s has no class that derives from PythonFMU's Fmi2Slave",
                   module ? module : "");
        }
        py.Py_DecRef(i->type);
        leave_folder(i->folder);
    }
    py.PyGILState_Release(gil);
    free(module);
    if (made)
        leave_python(i, "fmi2Instantiate", py.PyGILState_Ensure(), false); /* messages so far */
    return made;
}

fmi2Status renew_slave(Instance *i)
{
    Slave fresh;
    int gil;
    if (!enter_python(i, "fmi2Reset", &gil))
        return fmi2Error;
    bool made = make(i, &fresh);
    if (made) {
        Slave old = i->slave;
        i->slave = fresh;
        drop(&old);
    }
    return leave_python(i, "fmi2Reset", gil, !made);
}

void close_slave(Instance *i)
{
    if (!py.Py_IsInitialized()) /* the interpreter has ended, and its objects with it */
        return;
    int gil = py.PyGILState_Ensure();
    drop(&i->slave);
    py.Py_DecRef(i->type);
    py.Py_DecRef(i->strings);
    leave_folder(i->folder);
    py.PyGILState_Release(gil);
}

/* -- calls -- */

bool enter_python(Instance *i, const char *function, int *gil)
{
    if (!py.Py_IsInitialized()) {
        refuse(i, "%s: the Python interpreter of the process has ended", function);
        return false;
    }
    *gil = py.PyGILState_Ensure();
    return true;
}

/* An attribute as text; newly allocated. */
static char *attribute_text(void *object, const char *name)
{
    void *value = py.PyObject_GetAttrString(object, name);
    char *text = python_text(value);
    py.Py_DecRef(value);
    return text;
}

/* Log the messages that the Python code has left in its queue. */
static void RARE log_queue(Instance *i)
{
    for (;;) {
        int gil = py.PyGILState_Ensure();
        void *item = py.PyList_Size(i->slave.queue) > 0 ? py.PyList_GetItem(i->slave.queue, 0) : NULL;
        if (!item) {
            py.PyGILState_Release(gil);
            return;
        }
        py.Py_IncRef(item);
        py.PySequence_DelItem(i->slave.queue, 0);
        void *number = py.PyObject_GetAttrString(item, "status");
        long status = number ? py.PyLong_AsLong(number) : fmi2Error;
        char *category = attribute_text(item, "category"), *text = attribute_text(item, "msg");
        py.Py_DecRef(number);
        py.Py_DecRef(item);
        py.PyErr_Clear();
        py.PyGILState_Release(gil);
        if (status < fmi2OK || status > fmi2Error) /* nothing here is fatal: see finish() */
            status = fmi2Error;
        if ((fmi2Status)status > i->worst)
            i->worst = (fmi2Status)status;
        report(i, (fmi2Status)status, category ? category : "", text ? text : "");
        free(category);
        free(text);
    }
}

/* Pass an interrupt on to the tool's own Python code, which called the FMU: it is raised there when the
 * call has returned. Where no such code is, the message has to do. */
static void RARE pass_on(void *interrupt)
{
    int gil = py.PyGILState_Ensure();
    if (py.PyEval_GetFrame())
        py.PyThreadState_SetAsyncExc(py.PyThread_get_thread_ident(), interrupt);
    py.Py_DecRef(interrupt);
    py.PyGILState_Release(gil);
}

static fmi2Status RARE leave_with_messages(Instance *i, const char *function, int gil, bool raised)
{
    void *interrupt = NULL;
    char *text = raised ? take_exception(&interrupt) : NULL;
    py.PyGILState_Release(gil);
    log_queue(i);
    if (raised)
        refuse(i, interrupt ? "%s: interrupted by %s: the instance is as it was before the call"
                            : "%s: the Python code raised an exception: %s",
               function, text ? text : "unknown");
    free(text);
    if (interrupt) {
        i->interrupted = true;
        pass_on(interrupt);
    }
    return raised || i->worst >= fmi2Error ? fmi2Error : fmi2OK;
}

fmi2Status leave_python(Instance *i, const char *function, int gil, bool raised)
{
    if (raised || py.PyList_Size(i->slave.queue) > 0)
        return leave_with_messages(i, function, gil, raised);
    py.PyGILState_Release(gil);
    return fmi2OK;
}

void *list_of_references(const fmi2ValueReference vr[], size_t n)
{
    void *list = py.PyList_New((ptrdiff_t)n);
    for (size_t k = 0; list && k < n; k++) {
        void *number = py.PyLong_FromUnsignedLong(vr[k]);
        if (!number) {
            py.Py_DecRef(list);
            return NULL;
        }
        py.PyList_SetItem(list, (ptrdiff_t)k, number);
    }
    return list;
}

void *list_of_reals(const fmi2Real value[], size_t n)
{
    void *list = py.PyList_New((ptrdiff_t)n);
    for (size_t k = 0; list && k < n; k++) {
        void *number = py.PyFloat_FromDouble(value[k]);
        if (!number) {
            py.Py_DecRef(list);
            return NULL;
        }
        py.PyList_SetItem(list, (ptrdiff_t)k, number);
    }
    return list;
}

bool take_reals(void *list, size_t n, fmi2Real value[])
{
    for (size_t k = 0; k < n; k++) {
        void *number = py.PyList_GetItem(list, (ptrdiff_t)k);
        value[k] = number ? py.PyFloat_AsDouble(number) : -1.0;
        if (value[k] == -1.0 && py.PyErr_Occurred())
            return false;
    }
    return true;
}
