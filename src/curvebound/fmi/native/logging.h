/* Messages to the importing tool. */
#ifndef CURVEBOUND_LOGGING_H
#define CURVEBOUND_LOGGING_H

#include "instance.h"

/* Hand a message to a tool's logger, so that nothing in it acts as a format. */
void log_to(const fmi2CallbackFunctions *host, const char *name, fmi2Status status, const char *category,
            const char *text);

/* A message of an instance. Errors and warnings always reach the tool, other messages as
 * fmi2SetDebugLogging says. */
void report(Instance *i, fmi2Status status, const char *category, const char *text);

/* An error message of this library's own; returns fmi2Error. */
fmi2Status refuse(Instance *i, const char *format, ...) FORMAT(2, 3);

void free_categories(char **categories, size_t n);

#endif
