/* What differs between operating systems: platform_posix.c, platform_windows.c. Paths are UTF-8. */
#ifndef CURVEBOUND_PLATFORM_H
#define CURVEBOUND_PLATFORM_H

#include "text.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
typedef struct {
    void *word;
} Lock; /* an SRWLOCK */
#define UNLOCKED {0}
#else
#include <pthread.h>
#define EXPORT __attribute__((visibility("default")))
typedef pthread_mutex_t Lock;
#define UNLOCKED PTHREAD_MUTEX_INITIALIZER
#endif

void lock(Lock *lock);
void unlock(Lock *lock);

/* One lock for all copies of this library in the process. */
void lock_process(void);
void unlock_process(void);

/* The present thread: different from 0 and from any other that runs. */
#ifdef _WIN32
uintptr_t this_thread(void);
#else
static inline uintptr_t this_thread(void)
{
    return (uintptr_t)pthread_self();
}
#endif

/* Let a moment pass, of which MOMENTS are about ten seconds. */
#ifdef _WIN32
enum { MOMENTS = 5000 };
#else
enum { MOMENTS = 100000 };
#endif
void wait_a_moment(void);

/* Whether the process can still have so much memory. */
bool has_room(size_t bytes);

/* The path of this library without its last `levels` parts, newly allocated; NULL when unknown. */
char *own_path(int levels);

bool is_file(const char *path);

/* Up to 64 kB of a file, newly allocated; NULL when there is none. */
char *read_text(const char *path);

/* A variable of the environment, newly allocated; NULL when it is not set, or empty. */
char *environment(const char *name);

/* A shared library; the first function adds to `why` what is wrong when it returns NULL. */
void *open_library(const char *path, Text *why);
void close_library(void *library);
void *find_in(void *library, const char *name);

/* The folder above a library that it found in; newly allocated, NULL when unknown. */
char *folder_of(void *library);

/* Make the symbols of a Python library visible to extension modules, and keep it for ever. */
void make_visible(void *library, const char *path);

/* A name that PyPy exports. It has some of CPython's as well, so that the two cannot share a process. */
#define OTHER_PYTHON "PyPy_GetVersion"

/* The library of this process that holds a Python, or PyPy; false where there is none. */
bool python_of_process(void **library);

/* Whether the standard library of Python 3.`minor` is under `prefix`. */
bool has_standard_library(const char *prefix, int minor);

/* Where Pythons are looked for: pythons_posix.c, pythons_windows.c. A program or prefix may be NULL. */
typedef bool Attempt(const char *library, const char *prefix, const char *program, Text *tried);

/* Whether the standard library of Python 3.`minor` is under `prefix`. */
bool has_standard_library(const char *prefix, int minor);

/* The program of the Python 3.`minor` under `prefix`, newly allocated. */
char *program_of(const char *prefix, int minor);

/* Let `attempt` try the Python at a path: a library, a program or the folder above them. */
bool try_python_at(const char *path, Attempt *attempt, Text *tried);

/* Let `attempt` try the system's Pythons, best first, until it takes one; adds to `tried` what they are. */
bool try_pythons_of_system(Attempt *attempt, Text *tried);

#endif
