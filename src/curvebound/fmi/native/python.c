#define _GNU_SOURCE
#include "python.h"

#include "platform.h"

#include <stdlib.h>
#include <string.h>

Python py;

const char *find_functions(void *library)
{
#define FIND(result, name, arguments)                                                                  \
    if (!(py.name = (result(*) arguments)find_in(library, #name)))                                     \
        return #name;
    PYTHON_FUNCTIONS(FIND)
#undef FIND
    if (!(py.none = find_in(library, "_Py_NoneStruct")))
        return "_Py_NoneStruct";
    if (!(py.exception = find_in(library, "PyExc_Exception")))
        return "PyExc_Exception";
    return NULL;
}

char *RARE python_text(void *object)
{
    void *said = object ? py.PyObject_Str(object) : NULL;
    const char *text = said ? py.PyUnicode_AsUTF8AndSize(said, NULL) : NULL;
    char *copy = text ? strdup(text) : NULL;
    py.Py_DecRef(said);
    if (!text)
        py.PyErr_Clear();
    return copy;
}

char *RARE take_exception(void **interrupt)
{
    void *type = NULL, *value = NULL, *traceback = NULL;
    py.PyErr_Fetch(&type, &value, &traceback);
    py.PyErr_NormalizeException(&type, &value, &traceback);
    void *said = value ? py.PyObject_Repr(value) : NULL;
    char *text = said ? python_text(said) : NULL;
    py.PyErr_Clear();
    py.Py_DecRef(said);
    py.Py_DecRef(value);
    py.Py_DecRef(traceback);
    *interrupt = type && !py.PyErr_GivenExceptionMatches(type, *py.exception) ? type : NULL;
    if (!*interrupt)
        py.Py_DecRef(type);
    return text;
}

void *call_method(void *object, const char *name, void *a, void *b, void *c)
{
    void *method = py.PyObject_GetAttrString(object, name), *result = NULL;
    if (method)
        result = py.PyObject_CallFunctionObjArgs(method, a, b, c, NULL);
    py.Py_DecRef(method);
    return result;
}
