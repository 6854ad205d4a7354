/* The Python object behind an instance: an Fmi2Slave as PythonFMU defines it. */
#ifndef CURVEBOUND_SLAVE_H
#define CURVEBOUND_SLAVE_H

#include "instance.h"
#include "python.h"

/* Whether a folder holds the module that slavemodule.txt names. */
bool has_module(const char *resources);

/* Import the FMU's main module, find its class and make the first object; says why not. */
bool open_slave(Instance *i, Text *why);

/* Make the object anew; the old one stays where that fails. */
fmi2Status renew_slave(Instance *i);

/* Give up all that open_slave() has made. */
void close_slave(Instance *i);

/* Begin work in Python; false, with a message, where the interpreter has ended. */
bool enter_python(Instance *i, const char *function, int *gil);

/* End it: log the messages that wait and, where `raised`, the exception that is set. fmi2Error after an
 * exception or an error message, else fmi2OK. */
fmi2Status leave_python(Instance *i, const char *function, int gil, bool raised);

/* Lists of Python's for what arrays hold; NULL with an exception set. */
void *list_of_references(const fmi2ValueReference vr[], size_t n);
void *list_of_reals(const fmi2Real value[], size_t n);

/* Take the numbers out of a list; false with an exception set. */
bool take_reals(void *list, size_t n, fmi2Real value[]);

#endif
