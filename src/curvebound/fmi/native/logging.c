#define _GNU_SOURCE
#include "logging.h"

#include "platform.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A well-behaved logger treats the text as a printf format, a simple one prints it as it is: a text
 * without % suits both, any other goes through "%s". */
void log_to(const fmi2CallbackFunctions *host, const char *name, fmi2Status status, const char *category,
            const char *text)
{
    if (!host->logger)
        return;
    if (strchr(text, '%'))
        host->logger(host->componentEnvironment, name, status, category, "%s", text);
    else
        host->logger(host->componentEnvironment, name, status, category, text);
}

void report(Instance *i, fmi2Status status, const char *category, const char *text)
{
    if (status == fmi2OK || status == fmi2Pending) {
        bool wanted = i->logging && i->n_categories == 0;
        for (size_t k = 0; i->logging && k < i->n_categories; k++)
            wanted = wanted || strcmp(i->categories[k], category) == 0;
        if (!wanted)
            return;
    }
    if (i->calling_host) /* a logger that calls this instance is not called in turn */
        return;
    i->calling_host = true;
    log_to(&i->host, i->name, status, category, text);
    i->calling_host = false;
}

fmi2Status RARE refuse(Instance *i, const char *format, ...)
{
    char line[1024];
    va_list list;
    va_start(list, format);
    vsnprintf(line, sizeof line, format, list);
    va_end(list);
    report(i, fmi2Error, "logStatusError", line);
    return fmi2Error;
}

void free_categories(char **categories, size_t n)
{
    for (size_t k = 0; categories && k < n; k++)
        free(categories[k]);
    free(categories);
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n,
                                      const fmi2String categories[])
{
    Slot *slot = begin(c, "fmi2SetDebugLogging", ANY);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    bool complete = n == 0 || (categories && n <= 1000);
    char **copies = complete && n ? calloc(n, sizeof *copies) : NULL;
    for (size_t k = 0; complete && k < n; k++)
        complete = copies && categories[k] && (copies[k] = strdup(categories[k]));
    if (!complete) {
        free_categories(copies, n);
        return done(slot, refuse(i, "fmi2SetDebugLogging: categories or one of its nCategories = %zu "
                                    "elements is NULL", n));
    }
    free_categories(i->categories, i->n_categories);
    i->categories = copies;
    i->n_categories = n;
    i->logging = on;
    return done(slot, fmi2OK);
}
