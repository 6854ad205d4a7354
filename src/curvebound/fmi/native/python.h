/* CPython as this library sees it: functions of the stable ABI (PEP 384, Python 3.10), looked up in the
 * process, and calls of methods. No header of Python's is needed: objects are `void *`. */
#ifndef CURVEBOUND_PYTHON_H
#define CURVEBOUND_PYTHON_H

#include <stdbool.h>
#include <stddef.h>

#define PYTHON_FUNCTIONS(F)                                                                            \
    F(int, Py_IsInitialized, (void))                                                                   \
    F(int, PyGILState_Ensure, (void))                                                                  \
    F(void, PyGILState_Release, (int))                                                                 \
    F(void, Py_IncRef, (void *))                                                                       \
    F(void, Py_DecRef, (void *))                                                                       \
    F(void *, PySys_GetObject, (const char *))                                                         \
    F(void *, PyImport_ImportModule, (const char *))                                                   \
    F(void *, PyModule_GetDict, (void *))                                                              \
    F(void *, PyDict_New, (void))                                                                      \
    F(int, PyDict_Next, (void *, ptrdiff_t *, void **, void **))                                       \
    F(int, PyDict_SetItemString, (void *, const char *, void *))                                       \
    F(int, PyDict_DelItem, (void *, void *))                                                           \
    F(void *, PyDict_GetItemString, (void *, const char *))                                            \
    F(const char *, PyCapsule_GetName, (void *))                                                       \
    F(void *, PyCapsule_GetPointer, (void *, const char *))                                            \
    F(void *, PyTuple_New, (ptrdiff_t))                                                                \
    F(ptrdiff_t, PyTuple_Size, (void *))                                                               \
    F(void *, PyTuple_GetItem, (void *, ptrdiff_t))                                                    \
    F(void *, PyLong_FromUnsignedLong, (unsigned long))                                                \
    F(void *, PyLong_FromLong, (long))                                                                 \
    F(long, PyLong_AsLong, (void *))                                                                   \
    F(void *, PyBool_FromLong, (long))                                                                 \
    F(void *, PyFloat_FromDouble, (double))                                                            \
    F(double, PyFloat_AsDouble, (void *))                                                              \
    F(void *, PyUnicode_FromString, (const char *))                                                    \
    F(const char *, PyUnicode_AsUTF8AndSize, (void *, ptrdiff_t *))                                    \
    F(void *, PyBytes_FromStringAndSize, (const char *, ptrdiff_t))                                    \
    F(int, PyBytes_AsStringAndSize, (void *, char **, ptrdiff_t *))                                    \
    F(void *, PyList_New, (ptrdiff_t))                                                                 \
    F(ptrdiff_t, PyList_Size, (void *))                                                                \
    F(void *, PyList_GetItem, (void *, ptrdiff_t))                                                     \
    F(int, PyList_SetItem, (void *, ptrdiff_t, void *))                                                \
    F(int, PyList_Insert, (void *, ptrdiff_t, void *))                                                 \
    F(int, PySequence_Contains, (void *, void *))                                                      \
    F(ptrdiff_t, PySequence_Index, (void *, void *))                                                   \
    F(int, PySequence_DelItem, (void *, ptrdiff_t))                                                    \
    F(void *, PyObject_GetAttrString, (void *, const char *))                                          \
    F(int, PyObject_IsTrue, (void *))                                                                  \
    F(void *, PyObject_Repr, (void *))                                                                 \
    F(void *, PyObject_Str, (void *))                                                                  \
    F(void *, PyObject_Call, (void *, void *, void *))                                                 \
    F(void *, PyObject_CallFunctionObjArgs, (void *, ...))                                             \
    F(void *, PyErr_Occurred, (void))                                                                  \
    F(void, PyErr_Clear, (void))                                                                       \
    F(void, PyErr_Fetch, (void **, void **, void **))                                                  \
    F(void, PyErr_NormalizeException, (void **, void **, void **))                                     \
    F(int, PyErr_GivenExceptionMatches, (void *, void *))                                              \
    F(void *, PyEval_GetFrame, (void))                                                                 \
    F(unsigned long, PyThread_get_thread_ident, (void))                                                \
    F(int, PyThreadState_SetAsyncExc, (unsigned long, void *))

typedef struct {
#define MEMBER(result, name, arguments) result(*name) arguments;
    PYTHON_FUNCTIONS(MEMBER)
#undef MEMBER
    void *none;
    void **exception; /* the class Exception */
} Python;

extern Python py;

/* Look the functions up; NULL, or the name of the first that is missing. */
const char *find_functions(void *library);

/* The text of a string, or of what str() makes of another object; newly allocated. NULL after an
 * exception, which is cleared. */
char *python_text(void *object);

/* Take the exception that is set: its representation, newly allocated, and in `interrupt` a new reference
 * to its class where it is no Exception (KeyboardInterrupt, SystemExit) but meant for the tool. */
char *take_exception(void **interrupt);

/* A method's result, a new reference, or NULL with an exception set; b and c may be NULL. */
void *call_method(void *object, const char *name, void *a, void *b, void *c);

#endif
