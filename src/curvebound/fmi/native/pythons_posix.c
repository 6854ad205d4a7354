/* Where Pythons are found on Linux: the python3 on PATH is asked for its library, then the loader for
 * the usual names. */

#define _GNU_SOURCE
#include "interpreter.h"
#include "platform.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Asks a Python for its program, its prefix and its shared libraries, one a line. */
static const char ASK[] =
    "import sys, sysconfig, os\n"
    "g = sysconfig.get_config_var\n"
    "print(sys.executable)\n"
    "print(sys.base_prefix)\n"
    "for d in (g('LIBDIR'), os.path.join(sys.base_prefix, 'lib')):\n"
    "    for n in (g('INSTSONAME'), g('LDLIBRARY')):\n"
    "        p = d and n and ('.so' in n or '.dylib' in n) and os.path.join(d, n)\n"
    "        if p and os.path.exists(p): print(p)\n";

static bool make_pipe(int ends[2])
{
#ifdef __linux__
    return pipe2(ends, O_CLOEXEC) == 0;
#else
    return pipe(ends) == 0 && fcntl(ends[0], F_SETFD, FD_CLOEXEC) == 0 &&
           fcntl(ends[1], F_SETFD, FD_CLOEXEC) == 0;
#endif
}

/* Output of `program -c ASK`, or NULL. Waits ten seconds at most. */
static char *ask_python(const char *program)
{
    extern char **environ;
    int ends[2];
    if (!make_pipe(ends))
        return NULL;
    char *arguments[] = {(char *)program, "-I", "-S", "-c", (char *)ASK, NULL};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    pid_t child;
    bool running = posix_spawnp(&child, program, &actions, NULL, arguments, environ) == 0;
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);

    Text answer = {0};
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    const time_t deadline = now.tv_sec + 10;
    while (running && now.tv_sec < deadline) {
        char part[1024];
        struct pollfd wait = {.fd = ends[0], .events = POLLIN};
        if (poll(&wait, 1, 500) > 0) {
            ssize_t n = read(ends[0], part, sizeof part);
            if (n > 0)
                append(&answer, "%.*s", (int)n, part);
            else if (n == 0 || errno != EINTR)
                break;
        }
        clock_gettime(CLOCK_MONOTONIC, &now);
    }
    if (running) {
        if (now.tv_sec >= deadline)
            kill(child, SIGKILL);
        while (waitpid(child, NULL, 0) < 0 && errno == EINTR)
            ; /* ECHILD where the tool reaps children itself */
    }
    close(ends[0]);
    return answer.text;
}

bool has_standard_library(const char *prefix, int minor)
{
    static const char *const marks[] = {"%s/lib/python3.%d/os.py", "%s/lib64/python3.%d/os.py",
                                        "%s/lib/python3%d.zip"};
    bool found = false;
    for (int k = 0; k < 3 && !found; k++) {
        char path[4200];
        found = snprintf(path, sizeof path, marks[k], prefix, minor) < (int)sizeof path && is_file(path);
    }
    return found;
}

char *program_of(const char *prefix, int minor)
{
    return formatted("%s/bin/python3.%d", prefix, minor);
}

/* The Python that `program` runs; `name` is what to call it in `tried`. */
static bool try_program(const char *program, const char *name, Attempt *attempt, Text *tried)
{
    char *answer = ask_python(program), *rest = NULL;
    char *itself = answer ? strtok_r(answer, "\n", &rest) : NULL;
    char *prefix = itself ? strtok_r(NULL, "\n", &rest) : NULL;
    char *path = prefix ? strtok_r(NULL, "\n", &rest) : NULL;
    bool found = false;
    if (prefix)
        append(tried, "; %s (%s%s)", name, itself, path ? "" : ", without a shared library");
    else
        append(tried, "; %s (none that runs)", name);
    for (; path && !found; path = strtok_r(NULL, "\n", &rest))
        found = attempt(path, prefix, itself, tried);
    free(answer);
    return found;
}

/* The usual names of libraries, those under `folder` for a start; the newest is the last resort. */
static bool try_names(const char *folder, const char *prefix, Attempt *attempt, Text *tried)
{
    bool found = false;
    for (int k = 0; k <= NEWEST - OLDEST && !found; k++) {
        int minor = k < NEWEST - OLDEST ? NEWEST - 1 - k : NEWEST;
        char *path = formatted("%slibpython3.%d.so.1.0", folder, minor);
        if (path && (!*folder || is_file(path)))
            found = attempt(path, prefix, NULL, tried);
        free(path);
    }
    return found;
}

/* Load what first.txt in a folder names: libraries beside it that the others there need. */
static void load_first(const char *folder)
{
    char *list = formatted("%sfirst.txt", folder), *text = list ? read_text(list) : NULL, *rest = NULL;
    for (char *name = text ? strtok_r(text, "\n", &rest) : NULL; name; name = strtok_r(NULL, "\n", &rest)) {
        char *path = formatted("%s%s", folder, name);
        Text why = {0};
        if (path)
            open_library(path, &why);
        free(why.text);
        free(path);
    }
    free(text);
    free(list);
}

bool try_python_at(const char *path, Attempt *attempt, Text *tried)
{
    const char *base = strrchr(path, '/');
    char *within = formatted("%s/lib/", path);
    bool found = false;
    if (within && is_file(within)) {
        load_first(within);
        found = try_names(within, path, attempt, tried);
    } else if (strstr(base ? base : path, ".so") || strstr(base ? base : path, ".dylib")) {
        found = attempt(path, NULL, NULL, tried);
    } else {
        found = try_program(path, path, attempt, tried);
    }
    free(within);
    return found;
}

bool try_pythons_of_system(Attempt *attempt, Text *tried)
{
    return try_program("python3", "the python3 on PATH", attempt, tried) ||
           try_names("", NULL, attempt, tried);
}
