/* The Python interpreter of the process: found, or started where there is none. */
#ifndef CURVEBOUND_INTERPRETER_H
#define CURVEBOUND_INTERPRETER_H

#include "text.h"

enum { OLDEST = 10, NEWEST = 14 }; /* minor versions of Python 3 */

/* Make sure that the process has a running Python and that its functions are known (python.h); says why
 * not. `resources` is the FMU's folder of that name, which may hold a Python. */
bool have_python(const char *resources, Text *why);

#endif
