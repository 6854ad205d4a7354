/* Resource locations: file:/x, file:///x, file://localhost/x, or a plain absolute path. */

#define _GNU_SOURCE
#include "fmu.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

static int hex(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* What is behind the part of a URI that says where it is. */
static const char *without_scheme(const char *uri)
{
    uri += strlen("file:");
    if (strncmp(uri, "//", 2) != 0)
        return uri;
    if (strncasecmp(uri, "//localhost/", 12) == 0)
        return uri + 11;
#ifdef _WIN32
    if (uri[2] != '/') /* //server/folder */
        return uri;
#endif
    return uri + 2;
}

#ifdef _WIN32
static bool is_absolute(const char *path)
{
    bool letter = (*path >= 'a' && *path <= 'z') || (*path >= 'A' && *path <= 'Z');
    return (letter && path[1] == ':' && (path[2] == '/' || path[2] == '\\')) ||
           strncmp(path, "//", 2) == 0 || strncmp(path, "\\\\", 2) == 0;
}
#else
static bool is_absolute(const char *path)
{
    return *path == '/';
}
#endif

char *path_of(const char *uri)
{
    const bool is_uri = strncasecmp(uri, "file:", 5) == 0;
    if (is_uri)
        uri = without_scheme(uri);
#ifdef _WIN32
    if (is_uri && *uri == '/' && is_absolute(uri + 1)) /* file:///C:/x */
        uri++;
#endif
    if (!is_absolute(uri))
        return NULL;
    char *path = malloc(strlen(uri) + 1), *end = path;
    while (path && *uri) {
        int high = is_uri && *uri == '%' ? hex(uri[1]) : -1, low = high >= 0 ? hex(uri[2]) : -1;
        *end = low >= 0 ? (char)(high << 4 | low) : *uri;
        uri += low >= 0 ? 3 : 1;
        if (!*end++) { /* %00 */
            free(path);
            return NULL;
        }
    }
    if (path) {
        while (end > path + 1 && (end[-1] == '/' || (sizeof(wchar_t) == 2 && end[-1] == '\\')))
            end--;
        *end = 0;
    }
    return path;
}
