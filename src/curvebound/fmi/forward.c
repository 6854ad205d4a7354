/* The binary of a curvebound FMU on Linux: a forwarding library between the importing tool and
 * PythonFMU's wrapper (pythonfmu-export.so, beside this file's binary).
 *
 * The wrapper alone has undefined Python symbols, trusts its caller in everything and frees an
 * instance whose Python code raises. This library makes it safe to use from any process:
 *
 *   - it finds and starts a Python interpreter where the process has none (section 4);
 *   - it knows its own instances and saved states, so a NULL, foreign or freed pointer is refused
 *     (section 2), and it enforces the state machine of FMI 2.0 for co-simulation (section 6);
 *   - it passes log text on so that nothing in it acts as a format, and turns an error that the
 *     Python code logs or raises into fmi2Error, the instance still usable after fmi2Reset or
 *     fmi2SetFMUstate (sections 3 and 6);
 *   - it decodes the resource URI and checks the GUID (section 5);
 *   - it calls the methods that every step needs itself, several times faster (end of section 4).
 *
 * Threads: different instances may be used by different threads at once. The standard wants one
 * instance to be used by one thread at a time; here a second call waits until the first has ended.
 *
 * C11 and POSIX, no dependency but libdl. See the FMI specification 2.0.4, sections 2.1 and 4.2.
 */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <locale.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <wchar.h>

/* glibc 2.34 moved these functions from libdl to libc under a new version. The old version exists in
 * both, so asking for it lets a binary that was built on a new system load on an old one too. */
#if defined __x86_64__ && defined __GLIBC__
__asm__(".symver dlopen, dlopen@GLIBC_2.2.5");
__asm__(".symver dlsym, dlsym@GLIBC_2.2.5");
__asm__(".symver dlerror, dlerror@GLIBC_2.2.5");
__asm__(".symver dladdr, dladdr@GLIBC_2.2.5");
__asm__(".symver dlclose, dlclose@GLIBC_2.2.5");
#endif

#define EXPORT __attribute__((visibility("default")))
#define FORMAT(string, first) __attribute__((format(printf, string, first)))
#define RARE __attribute__((cold, noinline))

/* ---- 1. FMI 2.0 and the wrapper ----------------------------------------------------------------- */

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus,
    fmi2PendingStatus,
    fmi2LastSuccessfulTime,
    fmi2Terminated
} fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String instance, fmi2Status, fmi2String category,
                   fmi2String message, ...);
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

/* The functions of the wrapper that are called here. The inquiries about a step's status and the
 * derivatives of inputs and outputs are answered without it. */
#define WRAPPER(F)                                                                                     \
    F(fmi2Component, Instantiate,                                                                      \
      (fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, fmi2Boolean,       \
       fmi2Boolean))                                                                                   \
    F(void, FreeInstance, (fmi2Component))                                                             \
    F(fmi2Status, SetupExperiment,                                                                     \
      (fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real))                         \
    F(fmi2Status, EnterInitializationMode, (fmi2Component))                                            \
    F(fmi2Status, ExitInitializationMode, (fmi2Component))                                             \
    F(fmi2Status, Terminate, (fmi2Component))                                                          \
    F(fmi2Status, Reset, (fmi2Component))                                                              \
    F(fmi2Status, GetReal, (fmi2Component, const fmi2ValueReference *, size_t, fmi2Real *))            \
    F(fmi2Status, GetInteger, (fmi2Component, const fmi2ValueReference *, size_t, fmi2Integer *))      \
    F(fmi2Status, GetBoolean, (fmi2Component, const fmi2ValueReference *, size_t, fmi2Boolean *))      \
    F(fmi2Status, GetString, (fmi2Component, const fmi2ValueReference *, size_t, fmi2String *))        \
    F(fmi2Status, SetReal, (fmi2Component, const fmi2ValueReference *, size_t, const fmi2Real *))      \
    F(fmi2Status, SetInteger, (fmi2Component, const fmi2ValueReference *, size_t, const fmi2Integer *))\
    F(fmi2Status, SetBoolean, (fmi2Component, const fmi2ValueReference *, size_t, const fmi2Boolean *))\
    F(fmi2Status, SetString, (fmi2Component, const fmi2ValueReference *, size_t, const fmi2String *))  \
    F(fmi2Status, GetFMUstate, (fmi2Component, fmi2FMUstate *))                                        \
    F(fmi2Status, SetFMUstate, (fmi2Component, fmi2FMUstate))                                          \
    F(fmi2Status, FreeFMUstate, (fmi2Component, fmi2FMUstate *))                                       \
    F(fmi2Status, SerializedFMUstateSize, (fmi2Component, fmi2FMUstate, size_t *))                     \
    F(fmi2Status, SerializeFMUstate, (fmi2Component, fmi2FMUstate, fmi2Byte *, size_t))                \
    F(fmi2Status, DeSerializeFMUstate, (fmi2Component, const fmi2Byte *, size_t, fmi2FMUstate *))      \
    F(fmi2Status, DoStep, (fmi2Component, fmi2Real, fmi2Real, fmi2Boolean))

#define MEMBER(result, name, arguments) result(*name) arguments;

static struct {
    WRAPPER(MEMBER)
} wrapper;

/* The Python code of an instance, as it handed itself over; `methods` is NULL when it has not. */
typedef struct {
    void *methods; /* the tuple that keeps the others alive */
    void *do_step;
    void *get_real;
    void *set_real;
    void *queue; /* list of the messages that wait to be logged */
} Direct;

/* What an instance may be asked to do depends on its phase. */
typedef enum {
    INSTANTIATED = 1,
    INITIALIZING = 2,
    STEPPING = 4,   /* initialised, between two communication steps */
    DISCARDED = 8,  /* the last step was discarded */
    FAILED = 16,    /* a call returned fmi2Error */
    TERMINATED = 32
} Phase;

enum {
    ANY = INSTANTIATED | INITIALIZING | STEPPING | DISCARDED | FAILED | TERMINATED,
    SETTING = INSTANTIATED | INITIALIZING | STEPPING,
    GETTING = INITIALIZING | STEPPING | DISCARDED | FAILED | TERMINATED,
    AFTER_A_STEP = STEPPING | DISCARDED | FAILED | TERMINATED
};

/* What this library knows of an instance, and a saved state brings back. */
typedef struct {
    double time;          /* end of the last successful step, else the start time */
    double stop;
    int32_t stop_defined;
    int32_t phase;        /* a Phase */
    int32_t step_status;  /* an fmi2Status, of the last fmi2DoStep */
    int32_t unused;
} Progress;

/* What every call needs comes first: with thousands of instances these lines compete for the cache. */
typedef struct {
    void *handle;                /* what the importing tool holds */
    fmi2Component inner;         /* the wrapper's instance; NULL after its Python code has raised */
    Direct direct;               /* how to call its Python code without the wrapper */
    Progress now;
    fmi2Status worst;            /* of the messages logged during the present call */
    bool calling_host;           /* the tool's logger is running */
    bool visible;
    bool logging;
    fmi2CallbackFunctions host;  /* copies, because nothing says how long the originals live */
    fmi2CallbackFunctions own;   /* what the wrapper is given instead */
    char *name;
    char *resources;
    char **categories;           /* those switched on; none given means all */
    size_t n_categories;
} Instance;

typedef struct {
    fmi2FMUstate inner; /* the wrapper's state: a reference to a Python object */
    Progress progress;
} State;

/* ---- 2. Handles --------------------------------------------------------------------------------- */

/* The tool gets numbers, not addresses: the place of a slot, how often it has been used, and a key of
 * this library, so that no pointer of another library, freed or made up is ever followed. Looking a
 * number up takes no lock, because slots never move. */

typedef enum { INSTANCE = 5, STATE = 6 } Kind;

typedef struct {
    _Atomic uintptr_t handle; /* 0: vacant */
    _Atomic uintptr_t owner;  /* of a state: the instance with which it is freed at the latest */
    atomic_bool busy;         /* a call is using the object: */
    _Atomic pthread_t user;   /* one of this thread */
    void *object;
    uint32_t uses;
    uint32_t next;            /* vacant slots form a list */
} Slot;

enum { SLOTS = 256, CHUNKS = 4096, NO_SLOT = SLOTS * CHUNKS };

static _Atomic(Slot *) chunks[CHUNKS];
static pthread_mutex_t slots_lock = PTHREAD_MUTEX_INITIALIZER; /* guards the lists of slots */
static uint32_t first_vacant = NO_SLOT;
static _Atomic uint32_t n_slots;
static _Atomic uint32_t n_states; /* among the objects */

static Slot *slot_at(uint32_t place)
{
    Slot *chunk = atomic_load_explicit(&chunks[place / SLOTS], memory_order_acquire);
    return chunk ? &chunk[place % SLOTS] : NULL;
}

/* Different in each loaded copy of this library. */
static uintptr_t library_key(void)
{
    return ((uintptr_t)&slots_lock >> 4) * UINT64_C(0x9E3779B97F4A7C15) >> 45;
}

/* A handle for `object`, or NULL when there is no memory for one. */
static void *issue(Kind kind, void *object, void *owner)
{
    void *handle = NULL;
    pthread_mutex_lock(&slots_lock);
    uint32_t n = atomic_load(&n_slots);
    if (first_vacant == NO_SLOT && n < NO_SLOT) {
        Slot *chunk = calloc(SLOTS, sizeof *chunk);
        if (chunk) {
            for (uint32_t i = 0; i < SLOTS; i++)
                chunk[i].next = i + 1 < SLOTS ? n + i + 1 : NO_SLOT;
            first_vacant = n;
            atomic_store_explicit(&chunks[n / SLOTS], chunk, memory_order_release);
            atomic_store(&n_slots, n + SLOTS);
        }
    }
    if (first_vacant != NO_SLOT) {
        uint32_t place = first_vacant;
        Slot *slot = slot_at(place);
        first_vacant = slot->next;
        slot->object = object;
        slot->uses++;
        /* 19 bits of key, 20 of use count, 20 of place, 4 of kind; the top bit stays 0 */
        uintptr_t number = library_key() << 44 | (uintptr_t)(slot->uses & 0xFFFFF) << 24 |
                           (uintptr_t)place << 4 | kind;
        atomic_store_explicit(&slot->owner, (uintptr_t)owner, memory_order_relaxed);
        atomic_store_explicit(&slot->busy, false, memory_order_relaxed);
        atomic_store_explicit(&slot->handle, number, memory_order_release);
        handle = (void *)number;
    }
    pthread_mutex_unlock(&slots_lock);
    return handle;
}

static Slot *find(Kind kind, void *handle)
{
    uintptr_t number = (uintptr_t)handle;
    if ((number & 15) != kind)
        return NULL;
    Slot *slot = slot_at(number >> 4 & 0xFFFFF);
    return slot && atomic_load_explicit(&slot->handle, memory_order_acquire) == number ? slot : NULL;
}

static void release(Slot *slot)
{
    atomic_store_explicit(&slot->user, (pthread_t)0, memory_order_relaxed);
    atomic_store_explicit(&slot->busy, false, memory_order_release);
}

/* Wait until another thread's call has ended. False for a call within a call of the same thread (from
 * the tool's logger), and after ten seconds: then the other one waits for something of this thread. */
static bool RARE wait_for(Slot *slot)
{
    const struct timespec moment = {.tv_nsec = 100000};
    for (int k = 0; k < 100000; k++) {
        if (pthread_equal(atomic_load(&slot->user), pthread_self()))
            return false;
        nanosleep(&moment, NULL);
        if (!atomic_exchange_explicit(&slot->busy, true, memory_order_acquire))
            return true;
    }
    return false;
}

/* The slot behind a valid handle, for the caller alone until release(); NULL when the handle is not (or
 * no longer) one of this library, or the object cannot be had. */
static Slot *acquire(Kind kind, void *handle)
{
    Slot *slot = find(kind, handle);
    if (!slot)
        return NULL;
    if (atomic_exchange_explicit(&slot->busy, true, memory_order_acquire) && !wait_for(slot))
        return NULL;
    atomic_store_explicit(&slot->user, pthread_self(), memory_order_relaxed);
    /* It may have been freed, and even issued anew, since find(). */
    if (atomic_load_explicit(&slot->handle, memory_order_acquire) != (uintptr_t)handle) {
        release(slot);
        return NULL;
    }
    return slot;
}

/* Make an acquired slot vacant; its handle is refused from now on. */
static void retire(Slot *slot)
{
    pthread_mutex_lock(&slots_lock);
    uint32_t place = (uint32_t)(atomic_load(&slot->handle) >> 4 & 0xFFFFF);
    atomic_store_explicit(&slot->handle, 0, memory_order_release);
    atomic_store(&slot->owner, 0);
    slot->object = NULL;
    slot->next = first_vacant;
    first_vacant = place;
    release(slot);
    pthread_mutex_unlock(&slots_lock);
}

/* ---- 3. Text and messages ----------------------------------------------------------------------- */

/* A growing text; what does not fit in memory is left out. */
typedef struct {
    char *text;
    size_t length;
} Text;

static void RARE FORMAT(2, 3) append(Text *t, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    int n = vsnprintf(NULL, 0, format, list);
    va_end(list);
    char *longer = n < 0 ? NULL : realloc(t->text, t->length + (size_t)n + 1);
    if (!longer)
        return;
    va_start(list, format);
    vsnprintf(longer + t->length, (size_t)n + 1, format, list);
    va_end(list);
    t->text = longer;
    t->length += (size_t)n;
}

static const char *text_of(const Text *t)
{
    return t->text ? t->text : "";
}

/* Length of the UTF-8 sequence at `s` and its code point, or 0 where there is no valid one. */
static int utf8(const char *s, uint32_t *point)
{
    const unsigned char *u = (const unsigned char *)s;
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    int n = u[0] < 0x80 ? 1 : u[0] >> 5 == 6 ? 2 : u[0] >> 4 == 14 ? 3 : u[0] >> 3 == 30 ? 4 : 0;
    uint32_t value = n > 1 ? u[0] & (0x7Fu >> n) : u[0];
    for (int i = 1; i < n; i++) {
        if (u[i] >> 6 != 2) /* the terminating 0 ends up here */
            return 0;
        value = value << 6 | (u[i] & 0x3Fu);
    }
    if (n == 0 || value < least[n] || value > 0x10FFFF || (value >= 0xD800 && value < 0xE000))
        return 0;
    *point = value;
    return n;
}

static bool is_utf8(const char *s)
{
    uint32_t point;
    while (*s) {
        int n = utf8(s, &point);
        if (!n)
            return false;
        s += n;
    }
    return true;
}

/* Hand a message to the tool's logger. A well-behaved logger treats the text as a printf format, a
 * simple one prints it as it is: a text without % suits both, any other goes through "%s". */
static void log_to(const fmi2CallbackFunctions *host, const char *name, fmi2Status status,
                   const char *category, const char *text)
{
    if (!host->logger)
        return;
    if (strchr(text, '%'))
        host->logger(host->componentEnvironment, name, status, category, "%s", text);
    else
        host->logger(host->componentEnvironment, name, status, category, text);
}

/* Errors and warnings always reach the tool, other messages as fmi2SetDebugLogging says. */
static void report(Instance *i, fmi2Status status, const char *category, const char *text)
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

/* The logger that the wrapper is given: what it passes is text, not a format. */
static void on_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                       fmi2String category, fmi2String text, ...)
{
    Instance *i = environment;
    (void)name;
    if (status == fmi2Fatal) /* for this process and instance it is not: see finish() */
        status = fmi2Error;
    if (status != fmi2Pending && status > i->worst)
        i->worst = status;
    report(i, status, category ? category : "", text ? text : "");
}

/* A message of this library's own; always an error. */
static fmi2Status RARE FORMAT(2, 3) refuse(Instance *i, const char *format, ...)
{
    char line[512];
    va_list list;
    va_start(list, format);
    vsnprintf(line, sizeof line, format, list);
    va_end(list);
    report(i, fmi2Error, "logStatusError", line);
    return fmi2Error;
}

/* ---- 4. Python ---------------------------------------------------------------------------------- */

/* Where the process has no interpreter, libraries are tried in this order: the one that
 * CURVEBOUND_LIBPYTHON names, that of the python3 on PATH, the usual names. One that is too old or
 * whose standard library cannot be found is passed over: starting it would end the process. */

enum { OLDEST = 10, NEWEST = 14 }; /* minor versions of Python 3 */

/* Asks a Python for its program, its prefix and its shared libraries, one a line. */
static const char ASK[] =
    "import sys, sysconfig, os\n"
    "g = sysconfig.get_config_var\n"
    "print(sys.executable)\n"
    "print(sys.base_prefix)\n"
    "for d in (g('LIBDIR'), os.path.join(sys.base_prefix, 'lib')):\n"
    "    for n in (g('INSTSONAME'), g('LDLIBRARY')):\n"
    "        p = d and n and '.so' in n and os.path.join(d, n)\n"
    "        if p and os.path.exists(p): print(p)\n";

/* Output of `python3 -c ASK`, or NULL. Waits ten seconds at most. */
static char *ask_python(void)
{
    extern char **environ;
    int ends[2];
    if (pipe2(ends, O_CLOEXEC))
        return NULL;
    char *arguments[] = {"python3", "-I", "-S", "-c", (char *)ASK, NULL};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    pid_t child;
    bool running = posix_spawnp(&child, "python3", &actions, NULL, arguments, environ) == 0;
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

/* 11 for a library of Python 3.11, 0 for one of another major version or none at all. */
static int minor_version(void *library)
{
    const char *(*version)(void) = dlsym(library, "Py_GetVersion");
    const char *text = version ? version() : "";
    int minor = 0;
    if (strncmp(text, "3.", 2) == 0)
        for (text += 2; *text >= '0' && *text <= '9'; text++)
            minor = 10 * minor + (*text - '0');
    return minor;
}

/* Whether the standard library of Python 3.`minor` is under `prefix`. */
static bool has_library(const char *prefix, int minor)
{
    char marks[3][40];
    snprintf(marks[0], sizeof *marks, "lib/python3.%d/os.py", minor);
    snprintf(marks[1], sizeof *marks, "lib64/python3.%d/os.py", minor);
    snprintf(marks[2], sizeof *marks, "lib/python3%d.zip", minor);
    bool found = false;
    for (int k = 0; k < 3 && !found; k++) {
        Text path = {0};
        append(&path, "%s/%s", prefix, marks[k]);
        found = access(text_of(&path), R_OK) == 0;
        free(path.text);
    }
    return found;
}

/* The prefix to which a libpython belongs: the nearest folder above it with the standard library. */
static char *prefix_of(void *library, int minor)
{
    Dl_info info;
    void *address = dlsym(library, "Py_IsInitialized");
    char *path = address && dladdr(address, &info) ? realpath(info.dli_fname, NULL) : NULL;
    for (char *slash = path ? strrchr(path, '/') : NULL; slash > path; slash = strrchr(path, '/')) {
        *slash = 0;
        if (has_library(path, minor))
            return path;
    }
    free(path);
    return NULL;
}

/* A copy of a UTF-8 text as Python wants it; never freed, because Python keeps it. */
static wchar_t *wide(const char *s)
{
    wchar_t *copy = calloc(strlen(s) + 1, sizeof *copy), *end = copy;
    uint32_t point = 0;
    for (int n; copy && *s; s += n) {
        n = utf8(s, &point);
        if (!n) { /* PEP 383: bytes that are not UTF-8 become lone surrogates */
            n = 1;
            point = 0xDC00u + (unsigned char)*s;
        }
        *end++ = (wchar_t)point;
    }
    return copy;
}

/* Start the interpreter of a loaded libpython. What belongs to the process is left as it is: signal
 * handlers, locale and environment (whose PYTHON... variables mean the tool's own Python, if any).
 * It is never finalised: that would take it from other FMUs, and can abort the process at exit. */
static void start(void *library, const char *prefix, const char *program)
{
    void (*set_program)(const wchar_t *) = dlsym(library, "Py_SetProgramName");
    void (*set_home)(const wchar_t *) = dlsym(library, "Py_SetPythonHome");
    void (*initialize)(int) = dlsym(library, "Py_InitializeEx");
    void *(*let_go)(void) = dlsym(library, "PyEval_SaveThread");
    /* UTF-8 mode: paths may hold any character, whatever the locale */
    static const char *const flags[] = {"Py_UTF8Mode", "Py_IgnoreEnvironmentFlag"};
    for (size_t k = 0; k < sizeof flags / sizeof *flags; k++) {
        int *flag = dlsym(library, flags[k]);
        if (flag)
            *flag = 1;
    }
    if (set_program && access(program, X_OK) == 0)
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

/* Start the interpreter of a loaded libpython, given `prefix` and `program` or NULL, whose standard
 * library must be there; or add the reason why it does not do to `tried`. */
static bool start_if_usable(void *library, const char *path, const char *prefix, const char *program,
                            Text *tried)
{
    const int minor = minor_version(library);
    char *own_prefix = NULL;
    Text own_program = {0};
    if (minor < OLDEST) {
        append(tried, "; %s is not of Python 3.%d or newer", path, OLDEST);
        return false;
    }
    if (!prefix || !has_library(prefix, minor)) {
        prefix = own_prefix = prefix_of(library, minor);
        if (!prefix) {
            append(tried, "; %s has no standard library (lib/python3.%d) in a folder above it", path,
                   minor);
            return false;
        }
        append(&own_program, "%s/bin/python3.%d", prefix, minor);
        program = text_of(&own_program);
    }
    /* from now on extension modules, and the wrapper, find its symbols */
    if (library != RTLD_DEFAULT)
        dlopen(path, RTLD_NOW | RTLD_GLOBAL | RTLD_NODELETE);
    start(library, prefix, program);
    free(own_prefix);
    free(own_program.text);
    return true;
}

static bool try_library(const char *path, const char *prefix, const char *program, Text *tried)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char *why = dlerror();
        append(tried, "; %s", why ? why : path);
        return false;
    }
    bool usable = start_if_usable(library, path, prefix, program, tried);
    if (!usable)
        dlclose(library);
    return usable;
}

/* A libpython that the process holds privately: its path goes to the text behind `data`. */
static int find_private(struct dl_phdr_info *info, size_t size, void *data)
{
    const char *path = info->dlpi_name ? info->dlpi_name : "";
    const char *base = strrchr(path, '/');
    (void)size;
    base = base ? base + 1 : path;
    if (strncmp(base, "libpython3.", 11) != 0 || base[11] < '0' || base[11] > '9')
        return 0;
    append(data, "%s", path);
    return 1;
}

static bool start_some_python(Text *tried)
{
    const char *chosen = getenv("CURVEBOUND_LIBPYTHON");
    if (!chosen || !*chosen)
        append(tried, "CURVEBOUND_LIBPYTHON (not set)");
    else if (append(tried, "CURVEBOUND_LIBPYTHON"), try_library(chosen, NULL, NULL, tried))
        return true;

    char *answer = ask_python(), *rest = NULL;
    char *program = answer ? strtok_r(answer, "\n", &rest) : NULL;
    char *prefix = program ? strtok_r(NULL, "\n", &rest) : NULL;
    char *path = prefix ? strtok_r(NULL, "\n", &rest) : NULL;
    bool found = false;
    if (prefix)
        append(tried, "; the python3 on PATH (%s%s)", program, path ? "" : ", without a shared library");
    else
        append(tried, "; the python3 on PATH (none that runs)");
    for (; path && !found; path = strtok_r(NULL, "\n", &rest))
        found = try_library(path, prefix, program, tried);
    free(answer);

    for (int k = 0; !found && k <= NEWEST - OLDEST; k++) {
        /* the newest comes last: the wrapper is older than it */
        int minor = k < NEWEST - OLDEST ? NEWEST - 1 - k : NEWEST;
        char name[40];
        snprintf(name, sizeof name, "libpython3.%d.so.1.0", minor);
        found = try_library(name, NULL, NULL, tried);
    }
    return found;
}

/* Make sure that the process has a running Python whose symbols are visible to the wrapper. */
static bool have_python(Text *why)
{
    bool done = true;
    /* One lock for all copies of this library in the process: that of a stream of libc's. */
    flockfile(stderr);
    if (!dlsym(RTLD_DEFAULT, "Py_IsInitialized")) {
        Text own = {0};
        dl_iterate_phdr(find_private, &own);
        if (own.text)
            dlopen(own.text, RTLD_NOW | RTLD_NOLOAD | RTLD_GLOBAL);
        free(own.text);
    }
    int (*initialized)(void) = dlsym(RTLD_DEFAULT, "Py_IsInitialized");
    Text tried = {0};
    if (!initialized) {
        done = start_some_python(&tried);
        if (!done)
            append(why,
                   "no usable libpython was found. Tried: %s. Install Python's shared library (Debian: "
                   "libpython3.11), or set CURVEBOUND_LIBPYTHON to the path of a libpython3.x.so",
                   text_of(&tried));
    } else if (!initialized()) { /* the process has one and has not started it */
        done = start_if_usable(RTLD_DEFAULT, "the process's own Python", NULL, NULL, &tried);
        if (!done)
            append(why, "no usable libpython%s", text_of(&tried));
    }
    free(tried.text);
    funlockfile(stderr);
    return done;
}

/* -- direct calls --
 *
 * The wrapper looks the methods up by name and builds an argument list in every call, which costs more
 * than a step of the model. Where the Python code hands its methods over on instantiation (slave.py),
 * fmi2DoStep, fmi2GetReal and fmi2SetReal call them. The wrapper still does all else, so also the
 * logging: whatever is in the queue of messages is left to it. */

#define PYTHON(F)                                                                                      \
    F(int, PyGILState_Ensure, (void))                                                                  \
    F(void, PyGILState_Release, (int))                                                                 \
    F(void, Py_IncRef, (void *))                                                                       \
    F(void, Py_DecRef, (void *))                                                                       \
    F(void *, PySys_GetObject, (const char *))                                                         \
    F(void *, PyDict_GetItem, (void *, void *))                                                        \
    F(int, PyDict_DelItem, (void *, void *))                                                           \
    F(void *, PyTuple_GetItem, (void *, ptrdiff_t))                                                    \
    F(void *, PyLong_FromLong, (long))                                                                 \
    F(void *, PyLong_FromUnsignedLong, (unsigned long))                                                \
    F(void *, PyFloat_FromDouble, (double))                                                            \
    F(double, PyFloat_AsDouble, (void *))                                                              \
    F(void *, PyList_New, (ptrdiff_t))                                                                 \
    F(ptrdiff_t, PyList_Size, (void *))                                                                \
    F(void *, PyList_GetItem, (void *, ptrdiff_t))                                                     \
    F(int, PyList_SetItem, (void *, ptrdiff_t, void *))                                                \
    F(int, PyObject_IsTrue, (void *))                                                                  \
    F(void *, PyObject_CallFunctionObjArgs, (void *, ...))                                             \
    F(void *, PyObject_Repr, (void *))                                                                 \
    F(const char *, PyUnicode_AsUTF8, (void *))                                                        \
    F(void, PyErr_Fetch, (void **, void **, void **))                                                  \
    F(void, PyErr_Clear, (void))

static struct {
    PYTHON(MEMBER)
    bool complete;
} python;
#undef MEMBER

/* Find the functions of the process's Python; without them all goes through the wrapper. */
static void find_python(void)
{
    python.complete = true;
#define FIND(result, name, arguments)                                                                  \
    if (!(python.name = (result(*) arguments)dlsym(RTLD_DEFAULT, #name)))                              \
        python.complete = false;
    PYTHON(FIND)
#undef FIND
}

static void let_go(Instance *i)
{
    if (!i->direct.methods)
        return;
    int gil = python.PyGILState_Ensure();
    python.Py_DecRef(i->direct.methods);
    python.PyGILState_Release(gil);
    i->direct = (Direct){0};
}

/* Give up the methods of `i` and, for a Python object that this thread has just made for it, take those
 * that the object has left in sys.curvebound_handover. Before one is made, what is there is another's. */
static void take_over(Instance *i, bool made)
{
    let_go(i);
    if (!python.complete)
        return;
    int gil = python.PyGILState_Ensure();
    void *all = python.PySys_GetObject("curvebound_handover");
    void *thread = all ? python.PyLong_FromUnsignedLong((unsigned long)pthread_self()) : NULL;
    void *methods = thread ? python.PyDict_GetItem(all, thread) : NULL;
    if (methods && made && i->inner) {
        python.Py_IncRef(methods);
        i->direct = (Direct){methods, python.PyTuple_GetItem(methods, 0),
                             python.PyTuple_GetItem(methods, 1), python.PyTuple_GetItem(methods, 2),
                             python.PyTuple_GetItem(methods, 3)};
    }
    if (methods)
        python.PyDict_DelItem(all, thread);
    python.Py_DecRef(thread); /* nothing for NULL */
    python.PyGILState_Release(gil);
}

/* End a direct call: its status, given the result of the method, or NULL when it has raised. Gives back
 * result and interpreter. */
static fmi2Status end_direct(Instance *i, const char *function, void *result, int gil)
{
    fmi2Status status = result && python.PyObject_IsTrue(result) ? fmi2OK : fmi2Discard;
    bool messages = python.PyList_Size(i->direct.queue) != 0;
    Text why = {0};
    if (result) {
        python.Py_DecRef(result);
    } else {
        void *type = NULL, *value = NULL, *traceback = NULL;
        python.PyErr_Fetch(&type, &value, &traceback);
        void *said = value ? python.PyObject_Repr(value) : NULL;
        const char *text = said ? python.PyUnicode_AsUTF8(said) : NULL;
        append(&why, "%s", text ? text : "unknown");
        python.PyErr_Clear();
        void *all[] = {type, value, traceback, said};
        for (size_t k = 0; k < sizeof all / sizeof *all; k++)
            python.Py_DecRef(all[k]);
    }
    python.PyGILState_Release(gil);
    if (messages) {
        fmi2ValueReference vr = 0;
        fmi2Real value;
        if (wrapper.GetReal(i->inner, &vr, 0, &value) == fmi2Fatal) /* logs them */
            status = fmi2Fatal;
    }
    if (!result) {
        refuse(i, "%s: the Python code raised an exception: %s", function, text_of(&why));
        status = status == fmi2Fatal ? fmi2Fatal : fmi2Error;
    }
    free(why.text);
    return status;
}

static void *list_of_references(const fmi2ValueReference vr[], size_t n)
{
    void *list = python.PyList_New((ptrdiff_t)n);
    for (size_t k = 0; list && k < n; k++) /* signed, as the wrapper passes them */
        python.PyList_SetItem(list, (ptrdiff_t)k, python.PyLong_FromLong((int)vr[k]));
    return list;
}

static fmi2Status do_step(Instance *i, fmi2Real time, fmi2Real step, fmi2Boolean no_rollback)
{
    if (!i->direct.methods)
        return wrapper.DoStep(i->inner, time, step, no_rollback);
    int gil = python.PyGILState_Ensure();
    void *now = python.PyFloat_FromDouble(time), *size = python.PyFloat_FromDouble(step), *result = NULL;
    if (now && size)
        result = python.PyObject_CallFunctionObjArgs(i->direct.do_step, now, size, NULL);
    python.Py_DecRef(now);
    python.Py_DecRef(size);
    return end_direct(i, "fmi2DoStep", result, gil);
}

static fmi2Status get_Real(Instance *i, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    if (!i->direct.methods)
        return wrapper.GetReal(i->inner, vr, n, value);
    int gil = python.PyGILState_Ensure();
    void *references = list_of_references(vr, n), *values = NULL;
    if (references)
        values = python.PyObject_CallFunctionObjArgs(i->direct.get_real, references, NULL);
    python.Py_DecRef(references);
    for (size_t k = 0; values && k < n; k++)
        value[k] = python.PyFloat_AsDouble(python.PyList_GetItem(values, (ptrdiff_t)k));
    return end_direct(i, "fmi2GetReal", values, gil);
}

static fmi2Status set_Real(Instance *i, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
    if (!i->direct.methods)
        return wrapper.SetReal(i->inner, vr, n, value);
    int gil = python.PyGILState_Ensure();
    void *references = list_of_references(vr, n), *values = python.PyList_New((ptrdiff_t)n);
    void *result = NULL;
    for (size_t k = 0; values && k < n; k++)
        python.PyList_SetItem(values, (ptrdiff_t)k, python.PyFloat_FromDouble(value[k]));
    if (references && values)
        result = python.PyObject_CallFunctionObjArgs(i->direct.set_real, references, values, NULL);
    python.Py_DecRef(references);
    python.Py_DecRef(values);
    fmi2Status status = end_direct(i, "fmi2SetReal", result, gil);
    return status == fmi2Discard ? fmi2OK : status; /* the method returns None */
}

/* ---- 5. The FMU's folder ------------------------------------------------------------------------ */

static pthread_mutex_t load_lock = PTHREAD_MUTEX_INITIALIZER; /* guards this section's variables */
static char *folder; /* of this library; found when it is loaded, while a relative path still holds */
static char *guid;
static bool loaded;

/* A tool may load and unload this library for each instance. */
__attribute__((destructor)) static void clean_up(void)
{
    for (uint32_t place = 0; place < atomic_load(&n_slots); place++)
        if (atomic_load(&slot_at(place)->handle))
            return; /* still in use: the process ends */
    free(folder);
    free(guid);
    folder = guid = NULL;
    for (uint32_t k = 0; k < CHUNKS; k++)
        free(atomic_exchange(&chunks[k], NULL));
}

__attribute__((constructor)) static void find_folder(void)
{
    Dl_info info;
    folder = dladdr(&wrapper, &info) ? realpath(info.dli_fname, NULL) : NULL;
    if (folder)
        *strrchr(folder, '/') = 0;
}

static char *read_text(const char *path)
{
    FILE *file = fopen(path, "re");
    Text content = {0};
    char part[4096];
    size_t n;
    while (file && content.length < 65536 && (n = fread(part, 1, sizeof part, file)) > 0)
        append(&content, "%.*s", (int)n, part);
    if (file)
        fclose(file);
    return content.text;
}

/* The FMU's guid: that of guid.txt beside this library, else of modelDescription.xml, which not every
 * tool unpacks. Newly allocated; empty when there is neither. */
static char *read_guid(void)
{
    Text path = {0};
    append(&path, "%s/guid.txt", folder);
    char *text = read_text(text_of(&path)), *result = NULL;
    free(path.text);
    if (text) {
        text[strcspn(text, "\r\n")] = 0;
        return text;
    }
    path = (Text){0};
    append(&path, "%s/../../modelDescription.xml", folder);
    text = read_text(text_of(&path));
    free(path.text);
    const char *at = text ? strstr(text, "<fmiModelDescription") : NULL;
    at = at ? at + strlen("<fmiModelDescription") : NULL;
    while (at && !result) {
        at += strspn(at, " \t\r\n");
        size_t name = strcspn(at, " \t\r\n=>");
        const char *quote = at + name + strspn(at + name, " \t\r\n=");
        const char *end = *quote == '"' || *quote == '\'' ? strchr(quote + 1, *quote) : NULL;
        if (end && name == 4 && strncmp(at, "guid", 4) == 0)
            result = strndup(quote + 1, (size_t)(end - quote - 1));
        at = end ? end + 1 : NULL;
    }
    free(text);
    return result ? result : strdup("");
}

/* Load what an instance needs; says why not. */
static bool load(Text *why)
{
    pthread_mutex_lock(&load_lock);
    if (!guid && folder)
        guid = read_guid();
    if (!guid) {
        append(why, "this library does not know where it is");
    } else if (!loaded && have_python(why)) {
        Text path = {0};
        append(&path, "%s/pythonfmu-export.so", folder);
        /* Private to this FMU, whatever other wrappers the process has made public (the address
         * sanitizer refuses that); for ever, because Python objects hold on to it. */
        int deep = dlsym(RTLD_DEFAULT, "__asan_init") ? 0 : RTLD_DEEPBIND;
        void *library = dlopen(text_of(&path), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE | deep);
        free(path.text);
        const char *error = library ? NULL : dlerror();
        bool complete = library;
#define FIND(result, name, arguments)                                                                  \
    if (complete && !(wrapper.name = (result(*) arguments)dlsym(library, "fmi2" #name)))               \
        error = "it lacks fmi2" #name, complete = false;
        WRAPPER(FIND)
#undef FIND
        if (!complete)
            append(why, "PythonFMU's library could not be loaded: %s", error ? error : "unknown reason");
        /* At exit the wrapper frees its interpreter's state, and after that gives it up a second time:
         * what it then decrements may be anybody's. Having given it up before, it does neither. */
        void (*give_up)(void) = complete ? dlsym(library, "finalizePythonInterpreter") : NULL;
        if (give_up)
            atexit(give_up);
        find_python();
        loaded = complete;
    }
    bool done = loaded;
    pthread_mutex_unlock(&load_lock);
    return done;
}

static int hex(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* The path that a URI file:/x, file:///x or file://localhost/x means, or a plain absolute path as it
 * is. Newly allocated; NULL when it names no folder of this machine. */
static char *path_of(const char *uri)
{
    bool is_uri = strncasecmp(uri, "file:", 5) == 0;
    if (is_uri) {
        uri += 5;
        if (strncmp(uri, "//", 2) == 0) {
            uri += 2;
            if (strncasecmp(uri, "localhost/", 10) == 0)
                uri += 9;
        }
    }
    if (*uri != '/')
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
        while (end > path + 1 && end[-1] == '/')
            end--;
        *end = 0;
    }
    return path;
}

/* Whether a folder holds the module that the wrapper will import. It crashes where there is none. */
static bool has_module(const char *resources)
{
    Text path = {0};
    append(&path, "%s/slavemodule.txt", resources);
    char *module = read_text(text_of(&path));
    free(path.text);
    path = (Text){0};
    if (module)
        append(&path, "%s/%.*s.py", resources, (int)strcspn(module, "\r\n"), module);
    bool found = module && access(text_of(&path), R_OK) == 0;
    free(module);
    free(path.text);
    return found;
}

/* The resources' path as the wrapper must be given it. The wrapper edits what it gets ("%20" becomes a
 * space, "file://" goes); a path that contains these is reached through a descriptor, open for ever
 * because Python keeps the path. */
static char *plain_path(const char *path)
{
    static char *last;
    static int descriptor = -1;
    if (!strstr(path, "%20") && !strstr(path, "file://"))
        return strdup(path);
    Text plain = {0};
    pthread_mutex_lock(&load_lock);
    if (!last || strcmp(last, path) != 0) {
        free(last);
        last = strdup(path);
        descriptor = open(path, O_PATH | O_DIRECTORY | O_CLOEXEC);
    }
    if (descriptor >= 0)
        append(&plain, "/proc/self/fd/%d", descriptor);
    pthread_mutex_unlock(&load_lock);
    return plain.text;
}

/* ---- 6. Calls ----------------------------------------------------------------------------------- */

static const char *name_of(Phase phase)
{
    switch (phase) {
    case INSTANTIATED: return "before fmi2EnterInitializationMode";
    case INITIALIZING: return "in initialization mode";
    case STEPPING: return "between communication steps";
    case DISCARDED: return "after a discarded step";
    case FAILED: return "after an error: only reading, fmi2SetFMUstate, fmi2Reset and "
                        "fmi2FreeInstance can follow";
    case TERMINATED: return "after fmi2Terminate";
    }
    return "";
}

/* Begin a call: the instance, for this call alone until done() or finish(). NULL when the call is
 * refused; the reason is logged where there is an instance to log it. */
static __attribute__((noinline)) Slot *begin(fmi2Component c, const char *function, int allowed)
{
    Slot *slot = acquire(INSTANCE, c);
    if (!slot)
        return NULL;
    Instance *i = slot->object;
    i->worst = fmi2OK;
    if (!(i->now.phase & allowed)) {
        refuse(i, "%s is not allowed %s", function, name_of(i->now.phase));
        release(slot);
        return NULL;
    }
    return slot;
}

static inline fmi2Status done(Slot *slot, fmi2Status status)
{
    release(slot);
    return status;
}

/* The outcome of a call into the wrapper.
 *
 * Python code that fails logs with error status; what the wrapper then returns does not show it. Code
 * that raises makes the wrapper return fmi2Fatal, having freed the Python objects: its instance must not
 * be touched again, not even to free it, so its few hundred bytes are given up. */
static inline fmi2Status outcome(Instance *i, fmi2Status status)
{
    if (status == fmi2Fatal) {
        let_go(i);
        i->inner = NULL;
        i->now.phase = FAILED;
    }
    if (status == fmi2Fatal || i->worst >= fmi2Error)
        status = fmi2Error;
    return status;
}

/* End a call that may have changed the instance: after an error it counts as failed. */
static inline fmi2Status finish(Slot *slot, fmi2Status status)
{
    Instance *i = slot->object;
    status = outcome(i, status);
    if (status >= fmi2Error)
        i->now.phase = FAILED;
    return done(slot, status);
}

/* End a call that cannot have changed it. */
static inline fmi2Status finish_reading(Slot *slot, fmi2Status status)
{
    return done(slot, outcome(slot->object, status));
}

/* A fresh instance of the wrapper's. */
static bool create_inner(Instance *i)
{
    i->worst = fmi2OK;
    take_over(i, false);
    i->inner = wrapper.Instantiate(i->name, fmi2CoSimulation, guid, i->resources, &i->own, i->visible,
                                   true /* report() filters */);
    take_over(i, true);
    return i->inner != NULL;
}

/* Whether the Python code behind the instance is alive; says so if not. */
static inline bool alive(Instance *i, const char *function)
{
    if (i->inner)
        return true;
    refuse(i, "%s: the instance's values were lost when its Python code raised an exception: call "
              "fmi2Reset, or fmi2SetFMUstate with a state saved before", function);
    return false;
}

/* The arguments of the fmi2GetXxx and fmi2SetXxx functions. */
static inline bool valid(Instance *i, const char *function, const fmi2ValueReference *vr, size_t n,
                         const void *values)
{
    enum { MOST = 1000000 };
    if (n > MOST)
        refuse(i, "%s: nvr = %zu is more than any FMU has variables", function, n);
    else if (n > 0 && !(vr && values))
        refuse(i, "%s: %s is NULL: pass arrays of nvr = %zu elements", function, vr ? "value" : "vr", n);
    else
        return alive(i, function);
    return false;
}

static void free_categories(char **categories, size_t n)
{
    for (size_t k = 0; categories && k < n; k++)
        free(categories[k]);
    free(categories);
}

/* Replace an allocated text. */
static bool adopt(char **text, char *other)
{
    free(*text);
    *text = other;
    return other != NULL;
}

static void free_instance(Instance *i)
{
    free_categories(i->categories, i->n_categories);
    free(i->name);
    free(i->resources);
    free(i);
}

/* Free an acquired state. Without a live instance the Python object behind it is given up. */
static void drop_state(Slot *slot, Instance *any)
{
    State *state = slot->object;
    if (any && any->inner)
        wrapper.FreeFMUstate(any->inner, &state->inner);
    atomic_fetch_sub(&n_states, 1);
    retire(slot);
    free(state);
}

/* A state that `i` owns from now on; takes over the wrapper's `inner`. */
static fmi2FMUstate keep_state(Instance *i, fmi2FMUstate inner, Progress progress)
{
    State *state = malloc(sizeof *state);
    fmi2FMUstate handle = NULL;
    if (state) {
        *state = (State){inner, progress};
        handle = issue(STATE, state, i->handle);
    }
    if (handle) {
        atomic_fetch_add(&n_states, 1);
    } else {
        wrapper.FreeFMUstate(i->inner, &inner);
        free(state);
    }
    return handle;
}

/* The state behind a handle, for this call alone; NULL, with a message, when there is none. */
static Slot *begin_state(Instance *i, const char *function, fmi2FMUstate handle)
{
    Slot *slot = acquire(STATE, handle);
    if (!slot)
        refuse(i, "%s: not a state of this FMU, or already freed: pass one that fmi2GetFMUstate or "
                  "fmi2DeSerializeFMUstate gave", function);
    return slot;
}

/* ---- 7. The FMI functions ----------------------------------------------------------------------- */

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String asked, fmi2String uri,
                                     const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                                     fmi2Boolean logging)
{
    Text why = {0};
    Instance *i = functions ? calloc(1, sizeof *i) : NULL;
    if (!i) /* nobody to tell */
        return NULL;
    i->host = *functions;
    i->own = *functions;
    i->own.logger = on_message;
    i->own.componentEnvironment = i;
    i->own.stepFinished = NULL;
    i->visible = visible;
    i->logging = logging;
    i->now.phase = INSTANTIATED;
    i->name = name && is_utf8(name) ? strdup(name) : NULL;
    i->resources = uri && *uri ? path_of(uri) : NULL;
    if (!uri || !*uri) { /* some tools pass none: it is beside this library */
        Text path = {0};
        if (folder)
            append(&path, "%s/../../resources", folder);
        i->resources = path.text;
    }

    if (!i->name || !*i->name) {
        append(&why, "instanceName is NULL, empty or not UTF-8: pass a name");
    } else if (type != fmi2CoSimulation) {
        append(&why, "fmuType = %d: this FMU supports co-simulation only (fmi2CoSimulation = 1)", type);
    } else if (!load(&why)) {
        /* said why */
    } else if (!asked || (*guid && strcmp(asked, guid) != 0)) {
        append(&why, "fmuGUID = %s is not that of this FMU, %s: read it from its modelDescription.xml",
               asked ? asked : "NULL", guid);
    } else if (!i->resources || !is_utf8(i->resources)) {
        append(&why, "fmuResourceLocation = %s names no folder of this machine: pass file:///... in UTF-8",
               uri);
    } else if (!has_module(i->resources)) {
        append(&why, "fmuResourceLocation = %s (%s) is not the resources folder of this FMU",
               uri ? uri : "NULL", i->resources);
    } else if (!adopt(&i->resources, plain_path(i->resources))) {
        append(&why, "fmuResourceLocation = %s cannot be opened", uri ? uri : "NULL");
    } else if (create_inner(i) && !(i->handle = issue(INSTANCE, i, NULL))) {
        let_go(i);
        wrapper.FreeInstance(i->inner);
        append(&why, "out of memory");
    } else if (!i->inner && i->worst < fmi2Error) {
        append(&why, "the model could not be created");
    }

    if (why.text)
        log_to(&i->host, i->name ? i->name : "", fmi2Error, "logStatusError", why.text);
    free(why.text);
    void *handle = i->handle;
    if (!handle)
        free_instance(i);
    return handle;
}

EXPORT void fmi2FreeInstance(fmi2Component c)
{
    Slot *slot = begin(c, "fmi2FreeInstance", ANY);
    if (!slot)
        return;
    Instance *i = slot->object;
    for (uint32_t place = 0; atomic_load(&n_states) && place < atomic_load(&n_slots); place++) {
        Slot *other = slot_at(place);
        if (atomic_load(&other->owner) == (uintptr_t)c) {
            Slot *state = acquire(STATE, (void *)atomic_load(&other->handle));
            if (state)
                drop_state(state, i);
        }
    }
    let_go(i);
    if (i->inner)
        wrapper.FreeInstance(i->inner);
    retire(slot);
    free_instance(i);
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

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                      fmi2Real start_time, fmi2Boolean stop_defined, fmi2Real stop)
{
    Slot *slot = begin(c, "fmi2SetupExperiment", INSTANTIATED);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    if (!isfinite(start_time))
        return finish(slot, refuse(i, "startTime = %g: pass a finite time", start_time));
    if (stop_defined && !(isfinite(stop) && stop >= start_time))
        return finish(slot, refuse(i, "stopTime = %g: pass a finite time not before startTime = %g", stop,
                                   start_time));
    i->now.time = start_time;
    i->now.stop_defined = stop_defined;
    i->now.stop = stop;
    return finish(slot, wrapper.SetupExperiment(i->inner, tolerance_defined, tolerance, start_time,
                                                stop_defined, stop));
}

/* The three functions that lead from one phase to the next. */
static fmi2Status move_on(fmi2Component c, const char *function, fmi2Status (*call)(fmi2Component),
                          int allowed, Phase next)
{
    Slot *slot = begin(c, function, allowed);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    fmi2Status status = outcome(i, call(i->inner));
    if (status < fmi2Error)
        i->now.phase = next;
    return finish(slot, status);
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return move_on(c, "fmi2EnterInitializationMode", wrapper.EnterInitializationMode, INSTANTIATED,
                   INITIALIZING);
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return move_on(c, "fmi2ExitInitializationMode", wrapper.ExitInitializationMode, INITIALIZING,
                   STEPPING);
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    return move_on(c, "fmi2Terminate", wrapper.Terminate, STEPPING | DISCARDED, TERMINATED);
}

EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    Slot *slot = begin(c, "fmi2Reset", ANY);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    fmi2Status status = fmi2OK;
    if (i->inner) { /* the wrapper makes a new Python object */
        take_over(i, false);
        status = outcome(i, wrapper.Reset(i->inner));
        take_over(i, true);
    } else if (!create_inner(i)) {
        status = fmi2Error;
    }
    if (status < fmi2Error) {
        wrapper.SetupExperiment(i->inner, false, 0, 0, false, 0); /* the wrapper keeps the old one */
        i->now.phase = INSTANTIATED;
        i->now.stop_defined = false;
        i->now.time = 0;
        i->now.step_status = fmi2OK;
    }
    return finish(slot, status);
}

#define GETTER(name, type)                                                                             \
    EXPORT fmi2Status fmi2Get##name(fmi2Component c, const fmi2ValueReference vr[], size_t n,          \
                                    type value[])                                                      \
    {                                                                                                  \
        Slot *slot = begin(c, "fmi2Get" #name, GETTING);                                               \
        if (!slot)                                                                                     \
            return fmi2Error;                                                                          \
        Instance *i = slot->object;                                                                    \
        if (!valid(i, "fmi2Get" #name, vr, n, value))                                                  \
            return done(slot, fmi2Error);                                                              \
        return finish_reading(slot, n ? get_##name(i, vr, n, value) : fmi2OK);                         \
    }

#define SETTER(name, type)                                                                             \
    EXPORT fmi2Status fmi2Set##name(fmi2Component c, const fmi2ValueReference vr[], size_t n,          \
                                    const type value[])                                                \
    {                                                                                                  \
        Slot *slot = begin(c, "fmi2Set" #name, SETTING);                                               \
        if (!slot)                                                                                     \
            return fmi2Error;                                                                          \
        Instance *i = slot->object;                                                                    \
        if (!valid(i, "fmi2Set" #name, vr, n, value) || !passable##name(i, n, value))                  \
            return done(slot, fmi2Error);                                                              \
        return finish(slot, n ? set_##name(i, vr, n, value) : fmi2OK);                                 \
    }

#define get_Integer(i, vr, n, value) wrapper.GetInteger(i->inner, vr, n, value)
#define get_Boolean(i, vr, n, value) wrapper.GetBoolean(i->inner, vr, n, value)
#define get_String(i, vr, n, value) wrapper.GetString(i->inner, vr, n, value)
#define set_Integer(i, vr, n, value) wrapper.SetInteger(i->inner, vr, n, value)
#define set_Boolean(i, vr, n, value) wrapper.SetBoolean(i->inner, vr, n, value)
#define set_String(i, vr, n, value) wrapper.SetString(i->inner, vr, n, value)

#define passableReal(i, n, value) true
#define passableInteger(i, n, value) true
#define passableBoolean(i, n, value) true

/* The wrapper crashes on a string that Python cannot decode. */
static bool passableString(Instance *i, size_t n, const fmi2String *value)
{
    for (size_t k = 0; k < n; k++)
        if (!value[k] || !is_utf8(value[k])) {
            refuse(i, "fmi2SetString: value[%zu] is NULL or not UTF-8", k);
            return false;
        }
    return true;
}

GETTER(Real, fmi2Real)
GETTER(Integer, fmi2Integer)
GETTER(Boolean, fmi2Boolean)
GETTER(String, fmi2String)
SETTER(Real, fmi2Real)
SETTER(Integer, fmi2Integer)
SETTER(Boolean, fmi2Boolean)
SETTER(String, fmi2String)

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_rollback)
{
    Slot *slot = begin(c, "fmi2DoStep", STEPPING);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    /* The end of the step may miss the stop time by what adding up steps costs. */
    if (i->now.stop_defined && time + step > i->now.stop + 1e-6 * step + 1e-12 * fabs(i->now.stop)) {
        i->now.step_status = fmi2Error;
        return finish(slot, refuse(i, "a step of %.17g s at %.17g s ends after stopTime = %.17g s: "
                                      "shorten it, or define a later stopTime", step, time, i->now.stop));
    }
    i->now.step_status = outcome(i, do_step(i, time, step, no_rollback));
    if (i->now.step_status < fmi2Discard)
        i->now.time = time + step;
    else if (i->now.step_status == fmi2Discard)
        i->now.phase = DISCARDED;
    return finish(slot, i->now.step_status);
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    Slot *slot = begin(c, "fmi2CancelStep", ANY);
    if (!slot)
        return fmi2Error;
    return done(slot, refuse(slot->object, "fmi2CancelStep: no step is ever pending in this FMU"));
}

/* -- inquiries about the last step -- */

/* Begin one; NULL when it is refused. */
static Slot *begin_inquiry(fmi2Component c, const char *function, bool kind_fits, fmi2StatusKind kind,
                           const void *value)
{
    Slot *slot = begin(c, function, AFTER_A_STEP);
    if (slot && (!kind_fits || !value)) {
        if (kind_fits)
            refuse(slot->object, "%s: value is NULL", function);
        else
            refuse(slot->object, "%s: there is no such status of kind %d", function, (int)kind);
        release(slot);
        return NULL;
    }
    return slot;
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    Slot *slot = begin_inquiry(c, "fmi2GetStatus", kind == fmi2DoStepStatus, kind, value);
    if (!slot)
        return fmi2Error;
    *value = ((Instance *)slot->object)->now.step_status;
    return done(slot, fmi2OK);
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    Slot *slot = begin_inquiry(c, "fmi2GetRealStatus", kind == fmi2LastSuccessfulTime, kind, value);
    if (!slot)
        return fmi2Error;
    *value = ((Instance *)slot->object)->now.time;
    return done(slot, fmi2OK);
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    begin_inquiry(c, "fmi2GetIntegerStatus", false, kind, value); /* FMI 2.0 defines none */
    return fmi2Error;
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    Slot *slot = begin_inquiry(c, "fmi2GetBooleanStatus", kind == fmi2Terminated, kind, value);
    if (!slot)
        return fmi2Error;
    *value = ((Instance *)slot->object)->now.phase == DISCARDED; /* how a PythonFMU slave says it is over */
    return done(slot, fmi2OK);
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    Slot *slot = begin_inquiry(c, "fmi2GetStringStatus", kind == fmi2PendingStatus, kind, value);
    if (!slot)
        return fmi2Error;
    *value = "";
    return done(slot, fmi2OK);
}

/* -- derivatives: the modelDescription offers none -- */

static fmi2Status not_offered(fmi2Component c, const char *function)
{
    Slot *slot = begin(c, function, ANY);
    if (!slot)
        return fmi2Error;
    return done(slot, refuse(slot->object, "%s: not offered by this FMU, as its modelDescription.xml "
                                           "says", function));
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
                                               size_t n_unknowns, const fmi2ValueReference knowns[],
                                               size_t n_knowns, const fmi2Real seed[], fmi2Real result[])
{
    (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed, (void)result;
    return not_offered(c, "fmi2GetDirectionalDerivative");
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                              const fmi2Integer order[], const fmi2Real value[])
{
    (void)vr, (void)n, (void)order, (void)value;
    return not_offered(c, "fmi2SetRealInputDerivatives");
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                               const fmi2Integer order[], fmi2Real value[])
{
    (void)vr, (void)n, (void)order, (void)value;
    return not_offered(c, "fmi2GetRealOutputDerivatives");
}

/* -- saved states -- */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *handle)
{
    Slot *slot = begin(c, "fmi2GetFMUstate", ANY);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    if (!handle)
        return done(slot, refuse(i, "fmi2GetFMUstate: FMUstate is NULL"));
    if (!alive(i, "fmi2GetFMUstate"))
        return done(slot, fmi2Error);
    Slot *reused = NULL; /* a state given back is overwritten */
    if (*handle && !(reused = begin_state(i, "fmi2GetFMUstate", *handle)))
        return done(slot, fmi2Error);
    fmi2FMUstate inner = NULL;
    fmi2Status status = outcome(i, wrapper.GetFMUstate(i->inner, &inner));
    if (status < fmi2Error && reused) {
        State *state = reused->object;
        wrapper.FreeFMUstate(i->inner, &state->inner);
        *state = (State){inner, i->now};
    } else if (status < fmi2Error) {
        *handle = keep_state(i, inner, i->now);
        if (!*handle)
            status = refuse(i, "fmi2GetFMUstate: out of memory");
    }
    if (reused)
        release(reused);
    return done(slot, status);
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate handle)
{
    Slot *slot = begin(c, "fmi2SetFMUstate", ANY);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    Slot *saved = begin_state(i, "fmi2SetFMUstate", handle);
    if (!saved)
        return done(slot, fmi2Error);
    State *state = saved->object;
    fmi2Status status = fmi2Error;
    if (i->inner || create_inner(i))
        status = outcome(i, wrapper.SetFMUstate(i->inner, state->inner));
    if (status < fmi2Error) {
        i->now = state->progress;
    }
    release(saved);
    return finish(slot, status);
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *handle)
{
    Slot *slot = begin(c, "fmi2FreeFMUstate", ANY);
    if (!slot)
        return fmi2Error;
    if (!handle || !*handle) /* the standard: ignored */
        return done(slot, fmi2OK);
    Slot *state = begin_state(slot->object, "fmi2FreeFMUstate", *handle);
    if (!state)
        return done(slot, fmi2Error);
    drop_state(state, slot->object);
    *handle = NULL;
    return done(slot, fmi2OK);
}

/* What precedes the wrapper's bytes in a serialised state. */
typedef struct {
    char magic[8];
    char guid[64];
    uint64_t size; /* of the wrapper's bytes */
    Progress progress;
    uint64_t checksum; /* of all other bytes */
} Header;

static const char MAGIC[8] = "curvest2";

/* FNV-1a (Fowler, Noll and Vo): any single altered byte changes it. */
static uint64_t checksum(uint64_t sum, const void *bytes, size_t n)
{
    for (const unsigned char *b = bytes, *end = b + n; b < end; b++)
        sum = (sum ^ *b) * UINT64_C(0x100000001B3);
    return sum;
}

static uint64_t checksum_of(const Header *header, const fmi2Byte *payload)
{
    uint64_t sum = checksum(UINT64_C(0xCBF29CE484222325), header, offsetof(Header, checksum));
    return checksum(sum, payload, header->size);
}

/* Begin a call about serialising: the instance and the state, or NULL. */
static Slot *begin_serializing(fmi2Component c, const char *function, fmi2FMUstate handle, bool ready,
                               Slot **saved)
{
    Slot *slot = begin(c, function, ANY);
    if (!slot)
        return NULL;
    if (!ready)
        refuse(slot->object, "%s: an argument is NULL", function);
    else if (alive(slot->object, function) && (*saved = begin_state(slot->object, function, handle)))
        return slot;
    release(slot);
    return NULL;
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate handle, size_t *size)
{
    Slot *saved, *slot = begin_serializing(c, "fmi2SerializedFMUstateSize", handle, size, &saved);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    size_t payload = 0;
    fmi2Status status =
        outcome(i, wrapper.SerializedFMUstateSize(i->inner, ((State *)saved->object)->inner, &payload));
    if (status < fmi2Error)
        *size = sizeof(Header) + payload;
    release(saved);
    return done(slot, status);
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate handle, fmi2Byte bytes[],
                                        size_t size)
{
    Slot *saved, *slot = begin_serializing(c, "fmi2SerializeFMUstate", handle, bytes, &saved);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    State *state = saved->object;
    size_t payload = 0;
    fmi2Status status = outcome(i, wrapper.SerializedFMUstateSize(i->inner, state->inner, &payload));
    if (status < fmi2Error && size < sizeof(Header) + payload)
        status = refuse(i, "fmi2SerializeFMUstate: size = %zu is too small: ask "
                           "fmi2SerializedFMUstateSize", size);
    if (status < fmi2Error)
        status = outcome(i, wrapper.SerializeFMUstate(i->inner, state->inner, bytes + sizeof(Header),
                                                      payload));
    if (status < fmi2Error) {
        Header header = {.size = payload, .progress = state->progress};
        memcpy(header.magic, MAGIC, sizeof MAGIC);
        strncpy(header.guid, guid, sizeof header.guid - 1);
        header.checksum = checksum_of(&header, bytes + sizeof header);
        memcpy(bytes, &header, sizeof header);
    }
    release(saved);
    return done(slot, status);
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                          fmi2FMUstate *handle)
{
    Slot *slot = begin(c, "fmi2DeSerializeFMUstate", ANY);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    Header header;
    if (!bytes || !handle)
        return done(slot, refuse(i, "fmi2DeSerializeFMUstate: an argument is NULL"));
    if (size >= sizeof header)
        memcpy(&header, bytes, sizeof header);
    if (size < sizeof header || memcmp(header.magic, MAGIC, sizeof MAGIC) != 0 ||
        header.size != size - sizeof header ||
        header.checksum != checksum_of(&header, bytes + sizeof header))
        return done(slot, refuse(i, "the %zu bytes of serialised state are truncated, altered or not a "
                                    "state: pass them as fmi2SerializeFMUstate wrote them", size));
    header.guid[sizeof header.guid - 1] = 0;
    if (strncmp(header.guid, guid, sizeof header.guid - 1) != 0)
        return done(slot, refuse(i, "the serialised state was written by the FMU with guid %s, this one "
                                    "has %s: only its own states can be restored", header.guid, guid));
    if (!alive(i, "fmi2DeSerializeFMUstate"))
        return done(slot, fmi2Error);
    fmi2FMUstate inner = NULL;
    fmi2Status status =
        outcome(i, wrapper.DeSerializeFMUstate(i->inner, bytes + sizeof header, header.size, &inner));
    if (status < fmi2Error) {
        *handle = keep_state(i, inner, header.progress);
        if (!*handle)
            status = refuse(i, "fmi2DeSerializeFMUstate: out of memory");
    }
    return done(slot, status);
}
