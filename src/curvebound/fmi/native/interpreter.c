/* Where the process has no interpreter, one is started from the first of these that is usable: what
 * CURVEBOUND_PYTHON names, the Python inside the FMU, the Pythons of the system. One that is too old or
 * whose standard library cannot be found is passed over: starting it would end the process. */

#define _GNU_SOURCE
#include "interpreter.h"

#include "platform.h"
#include "python.h"

#include <locale.h>
#include <stdlib.h>
#include <string.h>

/* What an interpreter needs to start; without it Python ends the process. */
enum { ROOM = 48 << 20 };

static void *found_library; /* that of the interpreter that was found or started */

/* 11 for a library of Python 3.11, 0 for one of another major version or none at all. */
static int minor_version(const char *version)
{
    int minor = 0;
    if (strncmp(version, "3.", 2) == 0)
        for (version += 2; *version >= '0' && *version <= '9'; version++)
            minor = 10 * minor + (*version - '0');
    return minor;
}

static const char *version_of(void *library)
{
    const char *(*version)(void) = (const char *(*)(void))find_in(library, "Py_GetVersion");
    return version ? version() : "";
}

/* The prefix to which a library belongs: the nearest folder above it with the standard library. */
static char *prefix_of(void *library, int minor)
{
    char *path = folder_of(library);
    while (path && !has_standard_library(path, minor)) {
        char *slash = strrchr(path, '/');
        if (!slash || slash == path) {
            free(path);
            return NULL;
        }
        *slash = 0;
    }
    return path;
}

/* Start the interpreter of a loaded library. What belongs to the process is left as it is: signal
 * handlers, locale and environment (whose PYTHON... variables mean the tool's own Python, if any).
 * It is never finalised: that would take it from other FMUs, and can abort the process at exit. */
static void start(void *library, const char *prefix, const char *program)
{
    void (*set_program)(const wchar_t *) = (void (*)(const wchar_t *))find_in(library, "Py_SetProgramName");
    void (*set_home)(const wchar_t *) = (void (*)(const wchar_t *))find_in(library, "Py_SetPythonHome");
    void (*initialize)(int) = (void (*)(int))find_in(library, "Py_InitializeEx");
    void *(*let_go)(void) = (void *(*)(void))find_in(library, "PyEval_SaveThread");
    /* UTF-8 mode: paths may hold any character, whatever the locale */
    static const char *const flags[] = {"Py_UTF8Mode", "Py_IgnoreEnvironmentFlag"};
    for (size_t k = 0; k < sizeof flags / sizeof *flags; k++) {
        int *flag = find_in(library, flags[k]);
        if (flag)
            *flag = 1;
    }
    /* Python keeps both texts */
    if (set_program && is_file(program))
        set_program(wide(program));
    if (set_home)
        set_home(wide(prefix));
    const char *present = setlocale(LC_CTYPE, NULL);
    char *locale = present ? strdup(present) : NULL;
    initialize(0);
    if (locale)
        setlocale(LC_CTYPE, locale);
    free(locale);
    let_go();
}

/* Start the interpreter of a loaded library, given `prefix` and `program` or NULL, whose standard
 * library must be there; or add the reason why it does not do to `tried`. */
static bool start_if_usable(void *library, const char *path, const char *prefix, const char *program,
                            Text *tried)
{
    const int minor = minor_version(version_of(library));
    if (minor < OLDEST) {
        append(tried, "; %s is not of Python 3.%d or newer", path, OLDEST);
        return false;
    }
    if (!find_in(library, "Py_InitializeEx") || !find_in(library, "PyEval_SaveThread")) {
        append(tried, "; %s cannot be embedded", path);
        return false;
    }
    const bool fits = prefix && has_standard_library(prefix, minor);
    char *own_prefix = fits ? NULL : prefix_of(library, minor);
    char *own_program = own_prefix ? program_of(own_prefix, minor)
                      : fits && !program ? program_of(prefix, minor) : NULL;
    prefix = fits ? prefix : own_prefix;
    if (prefix) {
        make_visible(library, path);
        found_library = library;
        start(library, prefix, own_program ? own_program : program);
    } else {
        append(tried, "; %s has no standard library of Python 3.%d in a folder above it", path, minor);
    }
    free(own_prefix);
    free(own_program);
    return prefix != NULL;
}

static bool try_library(const char *path, const char *prefix, const char *program, Text *tried)
{
    Text why = {0};
    void *library = open_library(path, &why);
    if (!library)
        append(tried, "; %s", text_of(&why));
    free(why.text);
    bool usable = library && start_if_usable(library, path, prefix, program, tried);
    if (library && !usable)
        close_library(library);
    return usable;
}

static bool start_some_python(const char *resources, Text *tried)
{
    char *chosen = environment("CURVEBOUND_PYTHON");
    append(tried, "CURVEBOUND_PYTHON%s", chosen ? "" : " (not set)");
    bool found = chosen && try_python_at(chosen, try_library, tried);
    free(chosen);
    if (found)
        return true;
    char *own = formatted("%s/python", resources);
    bool there = own && is_file(own);
    append(tried, "; resources/python of the FMU%s", there ? "" : " (none)");
    found = there && try_python_at(own, try_library, tried);
    free(own);
    return found || try_pythons_of_system(try_library, tried);
}

/* The Python of a process that has one; started where that has not been done. */
static bool use_own(void *library, Text *why)
{
    const char *version = version_of(library);
    int (*initialized)(void) = (int (*)(void))find_in(library, "Py_IsInitialized");
    Text tried = {0};
    bool done = true;
    found_library = library;
    if (find_in(library, OTHER_PYTHON)) {
        append(why, "the process's Python is PyPy, which cannot run this FMU: load it in CPython 3.%d or "
                    "newer, or in a process without Python", OLDEST);
        done = false;
    } else if (!initialized()) {
        done = start_if_usable(library, "the process's own Python", NULL, NULL, &tried);
        if (!done)
            append(why, "no usable libpython%s", text_of(&tried));
    } else if (minor_version(version) < OLDEST) {
        append(why, "the process's Python (%s) is too old: load this FMU in Python 3.%d or newer", version,
               OLDEST);
        done = false;
    }
    free(tried.text);
    return done;
}

bool have_python(const char *resources, Text *why)
{
    void *own;
    bool done = false;
    lock_process();
    if (python_of_process(&own)) {
        done = use_own(own, why);
    } else if (!has_room(ROOM)) {
        append(why, "the process cannot have the %d MB of memory that a Python interpreter needs: raise "
                    "its limit (ulimit -v, or that of its container)", ROOM >> 20);
    } else {
        Text tried = {0};
        done = start_some_python(resources, &tried);
        if (!done)
            append(why, "no usable libpython was found. Tried: %s. Install Python 3.%d or newer (Debian: "
                        "libpython3.11), or set CURVEBOUND_PYTHON to a Python's program, folder or shared "
                        "library", text_of(&tried), OLDEST);
        free(tried.text);
    }
    if (done) {
        const char *lacking = find_functions(found_library);
        if (lacking) {
            append(why, "the process's Python (%s) lacks the function %s of CPython's stable ABI: load this "
                        "FMU in CPython 3.%d or newer", version_of(found_library), lacking, OLDEST);
            done = false;
        }
    }
    unlock_process();
    return done;
}
