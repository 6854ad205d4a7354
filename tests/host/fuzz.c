/* Random sequences of FMI calls against one FMU, in valid and in invalid order.
 *
 *   fuzz SEED FIRST COUNT NAME BINARY GUID URI VARIABLES OTHER_BINARY OTHER_GUID OTHER_URI
 *
 * VARIABLES is a file of lines "REFERENCE R|I|S o|p|i" (Real, Integer or String; output, parameter or
 * input). The other FMU lends components and states that must be refused. Sequence number n depends on
 * SEED and n alone: rerun one with FIRST = n and COUNT = 1 (every sixteenth runs in three threads, which
 * share an instance, and is repeatable only as far as the scheduler is).
 *
 * Checked after every call: the status is one that may come; an error has been logged, and only an
 * error has; a step succeeds only where one is allowed; no output is NaN; altered bytes and freed or
 * foreign states are refused. A sequence that hangs for a minute ends the process.
 */
#define _GNU_SOURCE
#include "fmi2.h"
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { INSTANCES = 3, STATES = 5, BUFFERS = 3, VARIABLES = 256, PER_CALL = 6 };
enum { NEW, INITIALIZING, STEPPING, DEAD }; /* DEAD: failed, discarded or terminated */

static Fmu fmu, other;
static const char *guid, *uri;
static fmi2Component other_component;
static fmi2FMUstate other_state;
static fmi2ValueReference outputs[VARIABLES], all[VARIABLES];
static char types[VARIABLES], causalities[VARIABLES];
static int n_outputs, n_all;
static long calls, failures;

static _Thread_local uint64_t rng;
static _Thread_local long errors_logged, logged_before;
static long sequence;

typedef struct {
    fmi2Component c;
    int phase;
    double start, time;
    int shared; /* with other threads, or freed: what it does cannot be foretold */
} Instance;

typedef struct {
    fmi2FMUstate s;
    int live, owner, phase, shared;
    double time;
} State;

typedef struct {
    fmi2Byte *bytes;
    size_t size;
    int intact, phase, shared;
    double time;
} Buffer;

typedef struct {
    Instance instances[INSTANCES];
    State states[STATES];
    Buffer buffers[BUFFERS];
} World;

static uint64_t next(void)
{ /* xorshift64* (Vigna, 2016) */
    rng ^= rng >> 12;
    rng ^= rng << 25;
    rng ^= rng >> 27;
    return rng * UINT64_C(2685821657736338717);
}

static int below(int n)
{
    return (int)(next() >> 33) % n;
}

static void fail(const char *what, const char *call)
{
    printf("FAILED sequence %ld: %s in %s\n", sequence, what, call);
    fflush(stdout);
    _exit(1);
}

static void on_log(void *environment, fmi2String instance, fmi2Status status, fmi2String category,
                   fmi2String text, ...)
{
    (void)environment;
    if (!instance || !category || !text)
        fail("NULL in a log message", "the logger");
    if (strstr(text, "Python code raised")) /* nothing in these FMUs is meant to raise */
        fail(text, "the Python code");
    if (status >= fmi2Error)
        errors_logged++;
}

/* Check what every call must keep; returns whether it succeeded. */
static int check(Instance *i, const char *call, fmi2Status status)
{
    long logged = errors_logged - logged_before;
    __atomic_fetch_add(&calls, 1, __ATOMIC_RELAXED);
    if (status != fmi2OK && status != fmi2Error)
        fail("a status other than OK and Error", call);
    if (status == fmi2OK && logged)
        fail("success with an error message", call);
    if (status == fmi2Error) {
        __atomic_fetch_add(&failures, 1, __ATOMIC_RELAXED);
        if (!logged && i && i->c && !i->shared)
            fail("failure without a message", call);
    }
    return status == fmi2OK;
}

#define CALL(i, name, ...) (logged_before = errors_logged, check(i, #name, fmu.name(__VA_ARGS__)))

static double some_real(void)
{
    static const double odd[] = {NAN, INFINITY, -INFINITY, 0.0, -0.0, -1.0, 1e-300, 1e300, -1e300,
                                 5e-324, 1e-3, 0.5, 1.0, 2.0, 9.81, 100.0};
    if (below(3))
        return odd[below(sizeof odd / sizeof *odd)];
    return (double)(int64_t)next() / 9e18 * 3.0;
}

static int some_integer(void)
{
    static const int odd[] = {0, -1, 1, 2, 3, 4, 5, 6, 7, 100, INT32_MIN};
    return odd[below(sizeof odd / sizeof *odd)];
}

/* A reference: mostly of a variable of that type, of any, or of none. */
static fmi2ValueReference some_variable(char type, char causality)
{
    if (below(25) == 0)
        return (fmi2ValueReference)next();
    for (int tries = 0; tries < 40; tries++) {
        int k = below(n_all);
        if (below(30) == 0 || (types[k] == type && (!causality || causalities[k] == causality)))
            return all[k];
    }
    return all[0];
}

static fmi2Component some_component(World *w)
{
    switch (below(4)) {
    case 0: return NULL;
    case 1: return other_component;
    case 2: return (void *)(uintptr_t)next();
    default: return w->states[below(STATES)].s;
    }
}

static void create(World *w, int k)
{
    fmi2CallbackFunctions callbacks = {on_log, calloc, free, NULL, NULL};
    const char *name = below(20) ? "fuzzed" : NULL;
    const char *id = below(20) ? guid : "{wrong}";
    const char *where = below(20) ? uri : "file:///nowhere/%zz";
    int type = below(20) ? 1 : 0;
    long before = errors_logged;
    Instance *i = &w->instances[k];
    *i = (Instance){.c = fmu.Instantiate(name, type, id, where, &callbacks, 0, below(2))};
    if ((i->c != NULL) != (name && id == guid && where == uri && type == 1))
        fail("a component where there must be none, or none", "Instantiate");
    if (!i->c && errors_logged == before)
        fail("failure without a message", "Instantiate");
}

static void destroy(World *w, int k)
{
    fmu.FreeInstance(w->instances[k].c);
    if (below(3))
        w->instances[k].c = NULL; /* else used after it was freed */
    w->instances[k].phase = DEAD;
    w->instances[k].shared = 1; /* a freed handle may not be told from one in use by a thread */
    for (int s = 0; s < STATES; s++)
        if (w->states[s].owner == k)
            w->states[s].live = 0;
}

static void read_outputs(Instance *i)
{
    double values[VARIABLES];
    for (int k = 0; k < VARIABLES; k++)
        values[k] = 0.0;
    if (CALL(i, GetReal, i->c, outputs, (size_t)n_outputs, values))
        for (int k = 0; k < n_outputs; k++)
            if (isnan(values[k]))
                fail("an output that is NaN", "GetReal");
}

static void random_values(Instance *i)
{
    fmi2ValueReference vr[PER_CALL];
    double real[PER_CALL];
    int integer[PER_CALL];
    const char *string[PER_CALL];
    int n = below(PER_CALL), kind = below(12);
    char type = kind < 6 ? 'R' : kind < 9 ? 'I' : 'S';
    for (int k = 0; k < n; k++) {
        vr[k] = some_variable(type, 0);
        real[k] = some_real();
        integer[k] = some_integer();
        string[k] = below(3) ? "%s%n" : below(2) ? NULL : "\xff\xfe";
    }
    switch (kind) {
    case 0: case 1: case 2: case 3:
        CALL(i, SetReal, i->c, vr, (size_t)n, real);
        break;
    case 4: case 5:
        CALL(i, GetReal, i->c, vr, (size_t)n, real);
        break;
    case 6: case 7:
        CALL(i, SetInteger, i->c, vr, (size_t)n, integer);
        break;
    case 8:
        CALL(i, GetInteger, i->c, vr, (size_t)n, integer);
        break;
    case 9:
        CALL(i, SetString, i->c, vr, (size_t)n, string);
        break;
    case 10:
        CALL(i, GetString, i->c, vr, (size_t)n, string);
        break;
    default:
        CALL(i, SetBoolean, i->c, vr, (size_t)n, integer);
        CALL(i, GetBoolean, i->c, vr, (size_t)n, integer);
    }
    if (below(10) == 0) {
        CALL(i, GetReal, i->c, NULL, 2, real);
        CALL(i, SetReal, i->c, vr, 2, NULL);
        CALL(i, GetReal, i->c, NULL, 0, NULL);
    }
}

static void step(Instance *i, double time, double size)
{
    int allowed = i->phase == STEPPING;
    if (CALL(i, DoStep, i->c, time, size, below(2))) {
        if (!i->shared && !(allowed && size > 0.0 && fabs(time - i->time) <= 1e-9))
            fail("a step that must be refused succeeded", "DoStep");
        i->time = time + size;
    } else if (allowed) {
        i->phase = DEAD;
    }
    read_outputs(i);
}

static void move(Instance *i)
{
    switch (i->phase) {
    case NEW:
        if (below(2)) {
            double tolerance = below(3) ? 1e-6 : some_real(), start = below(4) ? 0.0 : some_real();
            if (CALL(i, SetupExperiment, i->c, below(2), tolerance, start, below(4) == 0, some_real()))
                i->start = start;
            else
                i->phase = DEAD;
        } else if (CALL(i, EnterInitializationMode, i->c)) {
            i->phase = INITIALIZING;
            i->time = i->start;
        } else {
            i->phase = DEAD;
        }
        break;
    case INITIALIZING:
        i->phase = CALL(i, ExitInitializationMode, i->c) ? STEPPING : DEAD;
        break;
    case STEPPING:
        step(i, i->time, below(8) ? 0.01 : 0.3);
        break;
    default:
        if (CALL(i, Reset, i->c)) {
            i->phase = NEW;
            i->start = 0.0;
        }
    }
}

static void states(World *w, int k)
{
    Instance *i = &w->instances[k];
    State *s = &w->states[below(STATES)];
    Buffer *b = &w->buffers[below(BUFFERS)];
    size_t size = 0;
    int stale;
    switch (below(7)) {
    case 0: case 1:
        if (!s->live && below(5))
            s->s = NULL;
        stale = !s->live && s->s;
        if (CALL(i, GetFMUstate, i->c, &s->s)) {
            if (stale)
                fail("a freed state was overwritten", "GetFMUstate");
            *s = (State){s->s, 1, s->live ? s->owner : k, i->phase, i->shared || s->shared, i->time};
        }
        break;
    case 2: {
        fmi2FMUstate wrong[] = {NULL, other_state, i->c, (void *)(uintptr_t)next(), w};
        if (below(4) == 0) {
            if (CALL(i, SetFMUstate, i->c, wrong[below(5)]))
                fail("a state that is none was restored", "SetFMUstate");
        } else if (CALL(i, SetFMUstate, i->c, s->s)) {
            if (!s->live)
                fail("a freed state was restored", "SetFMUstate");
            i->phase = s->phase;
            i->time = s->time;
            i->shared |= s->shared;
        } else if (s->live) {
            i->phase = DEAD;
        }
        read_outputs(i);
        break;
    }
    case 3: {
        fmi2FMUstate gone = s->s; /* so that a freed state is used again now and then */
        if (CALL(i, FreeFMUstate, i->c, &gone)) {
            if (!s->live && s->s)
                fail("a freed state was freed", "FreeFMUstate");
            s->live = 0;
        }
        if (below(5) == 0)
            CALL(i, FreeFMUstate, i->c, below(2) ? &other_state : NULL);
        break;
    }
    case 4:
        if (CALL(i, SerializedFMUstateSize, i->c, s->s, &size)) {
            int enough = below(6) != 0;
            free(b->bytes);
            *b = (Buffer){calloc(size, 1), enough ? size : size / 2, enough, s->phase,
                          i->shared || s->shared, s->time};
            if (!b->bytes || CALL(i, SerializeFMUstate, i->c, s->s, b->bytes, b->size) != enough)
                if (!i->shared && !s->shared)
                    fail("serialising", "SerializeFMUstate");
        }
        break;
    case 5:
        if (b->bytes && b->intact) { /* once only, because a second time might undo the first */
            if (below(2))
                b->bytes[(size_t)next() % b->size] ^= (char)(1 << below(8));
            else
                b->size = (size_t)next() % b->size;
            b->intact = 0;
        }
        break;
    default:
        if (b->bytes && !s->live) {
            s->s = NULL;
            if (CALL(i, DeSerializeFMUstate, i->c, b->bytes, b->size, &s->s)) {
                if (!b->intact)
                    fail("altered bytes were accepted", "DeSerializeFMUstate");
                *s = (State){s->s, 1, k, b->phase, i->shared || b->shared, b->time};
            }
        }
    }
}

static void anything(World *w, int k)
{
    Instance *i = &w->instances[k], stranger = {.c = some_component(w), .shared = 1};
    fmi2ValueReference vr = 0;
    fmi2Status status;
    double real = 0.0;
    int integer = 1;
    const char *string = "logStatusError", *text;
    fmi2FMUstate state = NULL;
    switch (below(16)) {
    case 0: CALL(i, SetDebugLogging, i->c, below(2), (size_t)below(2), &string); break;
    case 1: CALL(i, GetStatus, i->c, below(5), &status); break;
    case 2: CALL(i, GetRealStatus, i->c, below(5), below(4) ? &real : NULL); break;
    case 3: CALL(i, GetIntegerStatus, i->c, below(5), &integer); break;
    case 4: CALL(i, GetBooleanStatus, i->c, below(5), &integer); break;
    case 5: CALL(i, GetStringStatus, i->c, below(5), &text); break;
    case 6: CALL(i, CancelStep, i->c); break;
    case 7: CALL(i, SetRealInputDerivatives, i->c, &vr, 1, &integer, &real); break;
    case 8: CALL(i, GetRealOutputDerivatives, i->c, &vr, 1, &integer, &real); break;
    case 9: CALL(i, GetDirectionalDerivative, i->c, &vr, 1, &vr, 1, &real, &real); break;
    case 10:
        if (CALL(i, Terminate, i->c) || i->phase == STEPPING)
            i->phase = DEAD;
        break;
    case 11:
        if (CALL(i, Reset, i->c)) {
            i->phase = NEW;
            i->start = 0.0;
        }
        break;
    case 12: /* out of order */
        if (CALL(i, EnterInitializationMode, i->c)) {
            if (i->phase != NEW && !i->shared)
                fail("out of order", "EnterInitializationMode");
            i->phase = INITIALIZING;
            i->time = i->start;
        } else if (i->phase == NEW) {
            i->phase = DEAD;
        }
        break;
    case 13:
        step(i, below(2) ? i->time : some_real(), below(2) ? 0.01 : some_real() > 0.5 ? NAN : some_real());
        break;
    default: /* strangers: only a status can be asked of them */
        CALL(&stranger, GetReal, stranger.c, &vr, 1, &real);
        CALL(&stranger, SetReal, stranger.c, &vr, 1, &real);
        CALL(&stranger, Reset, stranger.c);
        CALL(&stranger, DoStep, stranger.c, 0.0, 0.1, 1);
        if (CALL(&stranger, GetFMUstate, stranger.c, &state))
            fail("a stranger has a state", "GetFMUstate");
        fmu.FreeInstance(stranger.c);
    }
}

static void play(World *w, int length)
{
    for (int n = 0; n < length; n++) {
        int k = below(INSTANCES), what = below(100);
        Instance *i = &w->instances[k];
        if (!i->c && (what < 50 || w->instances[0].c == NULL))
            create(w, k);
        else if (what < 45)
            move(i);
        else if (what < 65)
            random_values(i);
        else if (what < 70)
            read_outputs(i);
        else if (what < 86)
            states(w, k);
        else if (what < 97)
            anything(w, k);
        else
            destroy(w, k);
    }
}

static void clean(World *w)
{
    for (int k = 0; k < INSTANCES; k++)
        fmu.FreeInstance(w->instances[k].c);
    for (int k = 0; k < BUFFERS; k++)
        free(w->buffers[k].bytes);
}

static void seed(uint64_t s, long n, int thread)
{
    rng = (s * UINT64_C(0x9E3779B97F4A7C15)) ^ ((uint64_t)(n * 4 + thread + 1) * UINT64_C(0xD1B54A32D192ED03));
    rng = rng ? rng : 1;
    for (int k = 0; k < 8; k++)
        next();
}

typedef struct {
    uint64_t seed;
    long n;
    int thread;
    fmi2Component shared;
} Task;

static void *in_thread(void *data)
{
    Task *t = data;
    World w = {0};
    seed(t->seed, t->n, t->thread);
    w.instances[2] = (Instance){.c = t->shared, .phase = below(4), .shared = 1};
    play(&w, 20 + below(20));
    clean(&w); /* frees the shared one too, while the others use it */
    return NULL;
}

static void with_threads(uint64_t s, long n)
{
    fmi2CallbackFunctions callbacks = {on_log, calloc, free, NULL, NULL};
    fmi2Component shared = fmu.Instantiate("shared", 1, guid, uri, &callbacks, 0, 0);
    pthread_t threads[3];
    Task tasks[3];
    for (int k = 0; k < 3; k++) {
        tasks[k] = (Task){s, n, k + 1, shared};
        pthread_create(&threads[k], NULL, in_thread, &tasks[k]);
    }
    for (int k = 0; k < 3; k++)
        pthread_join(threads[k], NULL);
}

/* A crash or a hang: say where, then die of it. */
static void on_signal(int number)
{
    char line[80];
    int n = snprintf(line, sizeof line, "FAILED sequence %ld: signal %d\n", sequence, number);
    signal(number, SIG_DFL);
    if (write(1, line, (size_t)n) == n)
        raise(number);
}

static void read_variables(const char *path)
{
    FILE *file = fopen(path, "r");
    if (!file)
        exit(2);
    while (n_all < VARIABLES && fscanf(file, "%u %c %c", &all[n_all], &types[n_all], &causalities[n_all]) == 3) {
        if (types[n_all] == 'R' && causalities[n_all] == 'o')
            outputs[n_outputs++] = all[n_all];
        n_all++;
    }
    fclose(file);
}

int main(int argc, char **argv)
{
    if (argc != 12)
        return 2;
    const uint64_t s = strtoull(argv[1], NULL, 10);
    const long first = strtol(argv[2], NULL, 10), count = strtol(argv[3], NULL, 10);
    fmi2CallbackFunctions callbacks = {on_log, calloc, free, NULL, NULL};
    prepare_streams();
    signal(SIGALRM, on_signal);
    signal(SIGABRT, on_signal);
    if (!fmu_load(&fmu, argv[5]) || !fmu_load(&other, argv[9]))
        return 2;
    guid = argv[6];
    uri = argv[7];
    read_variables(argv[8]);
    other_component = other.Instantiate("other", 1, argv[10], argv[11], &callbacks, 0, 0);
    if (!other_component || other.GetFMUstate(other_component, &other_state) != fmi2OK)
        return 2;
    for (long n = first; n < first + count; n++) {
        alarm(60);
        sequence = n;
        seed(s, n, 0);
        if (n % 16 == 15) {
            with_threads(s, n);
        } else {
            World w = {0};
            play(&w, 5 + below(35));
            clean(&w);
        }
    }
    alarm(60);
    if (other.SetFMUstate(other_component, other_state) != fmi2OK)
        fail("the other FMU has suffered", "SetFMUstate");
    other.FreeInstance(other_component);
    printf("%s: %ld sequences, %ld calls, %ld refused or failed\n", argv[4], count, calls, failures);
    return 0;
}
