/* The FMU around this library: what is particular to one is read from its files. */
#ifndef CURVEBOUND_FMU_H
#define CURVEBOUND_FMU_H

#include "text.h"

/* Its GUID; empty when no file says it, NULL when there is no memory. */
const char *guid_of_fmu(void);

/* Its folder, with "/resources" after it; newly allocated, NULL when unknown. */
char *resources_of_fmu(void);

/* The path that a URI of a local file, or an absolute path, means; newly allocated, NULL when it names no
 * folder of this machine. */
char *path_of(const char *uri);

#endif
