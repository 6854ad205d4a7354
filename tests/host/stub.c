/* Stands in for CPython: every function returns at once, an object where one is due. What a call of the
 * FMU's binary on top of it costs is the binary's own share. */
#include <stddef.h>

static void *object = &object;
static const void *bases[] = {"Fmi2Slave"};

#define RETURN(type, name, value)                                                                      \
    type name(void);                                                                                   \
    type name(void)                                                                                    \
    {                                                                                                  \
        return value;                                                                                  \
    }
#define OBJECT(name) RETURN(void *, name, &object)
#define NUMBER(name, value) RETURN(ptrdiff_t, name, value)
#define NOTHING(name) NUMBER(name, 0)

void *_Py_NoneStruct, *PyExc_Exception;

RETURN(const char *, Py_GetVersion, "3.11.0 (a stub)")
RETURN(const char *, PyUnicode_AsUTF8AndSize, (const char *)bases[0])
RETURN(double, PyFloat_AsDouble, 1.0)

int PyDict_Next(void *dict, ptrdiff_t *place, void **key, void **value);
int PyDict_Next(void *dict, ptrdiff_t *place, void **key, void **value)
{
    (void)dict, (void)key;
    *value = &object;
    return (*place)++ == 0;
}

NUMBER(Py_IsInitialized, 1)
NUMBER(PyTuple_Size, 1)
NUMBER(PyObject_IsTrue, 1)
NOTHING(PyGILState_Ensure)
NOTHING(PyGILState_Release)
NOTHING(Py_IncRef)
NOTHING(Py_DecRef)
NOTHING(PyDict_SetItemString)
NOTHING(PyDict_GetItemString)
NOTHING(PyCapsule_GetName)
NOTHING(PyCapsule_GetPointer)
NOTHING(PyDict_DelItem)
NOTHING(PyLong_AsLong)
NOTHING(PyBytes_AsStringAndSize)
NOTHING(PyList_Size)
NOTHING(PyList_SetItem)
NOTHING(PyList_Insert)
NOTHING(PySequence_Contains)
NOTHING(PySequence_Index)
NOTHING(PySequence_DelItem)
NOTHING(PyErr_Occurred)
NOTHING(PyErr_Clear)
NOTHING(PyErr_Fetch)
NOTHING(PyErr_NormalizeException)
NOTHING(PyErr_GivenExceptionMatches)
NOTHING(PyEval_GetFrame)
NOTHING(PyThread_get_thread_ident)
NOTHING(PyThreadState_SetAsyncExc)
OBJECT(PySys_GetObject)
OBJECT(PyImport_ImportModule)
OBJECT(PyModule_GetDict)
OBJECT(PyDict_New)
OBJECT(PyTuple_New)
OBJECT(PyTuple_GetItem)
OBJECT(PyLong_FromUnsignedLong)
OBJECT(PyLong_FromLong)
OBJECT(PyBool_FromLong)
OBJECT(PyFloat_FromDouble)
OBJECT(PyUnicode_FromString)
OBJECT(PyBytes_FromStringAndSize)
OBJECT(PyList_New)
OBJECT(PyList_GetItem)
OBJECT(PyObject_GetAttrString)
OBJECT(PyObject_Repr)
OBJECT(PyObject_Str)
OBJECT(PyObject_Call)
OBJECT(PyObject_CallFunctionObjArgs)
