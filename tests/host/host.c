/* A small co-simulation host: no Python in it, and nothing done for the FMU's sake.
 *
 * It reads commands from standard input, one a line, words separated by tabs, and answers each with one
 * line "= STATUS VALUES..." on standard output; log messages come before it as "LOG INSTANCE STATUS
 * CATEGORY TEXT". Names (F a binary, I an instance, S a state, B bytes) are single digits.
 *
 *   load F PATH            unload F
 *   new I F NAME GUID URI LOGGING      (NAME, GUID and URI may be NULL or EMPTY)
 *   free I    enter I    exit I    terminate I    reset I    cancel I
 *   setup I TOLERANCE START STOP       (- for a tolerance or stop time that is not defined)
 *   debug I ON CATEGORY...
 *   set I VR VALUE ...     get I VR ...         Real
 *   seti I VR VALUE ...    geti I VR ...        Integer and Enumeration
 *   gets I VR ...          sets I VR VALUE ...  String
 *   step I TIME SIZE       steps I START SIZE COUNT [VR ...]   prints the values after each step
 *   save I S   restore I S   drop I S   write I S B   read I B S   flip B OFFSET   cut B LENGTH
 *   length B
 *   clock                  CPU seconds of this process
 *   status I               the inquiries about the last step
 *   derivatives I IN OUT   the three functions about derivatives, of an input and an output
 *   change I OUT IN SEED ...           the directional derivative of an output
 *   misuse I               calls with NULL arguments
 *   strange F              calls with NULL, made-up and freed components
 *   churn F COUNT GUID URI                      memory growth in bytes per instantiate and free
 *   parallel F THREADS STEPS GUID URI VR        as many instances, each in a thread of its own
 */
#define _GNU_SOURCE
#include "fmi2.h"
#include <pthread.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char *const NAMES[] = {"OK", "Warning", "Discard", "Error", "Fatal", "Pending"};

static Fmu fmus[10];
static fmi2Component instances[10];
static Fmu *fmu_of[10];
static fmi2FMUstate states[10];
static fmi2Byte *bytes[10];
static size_t lengths[10];

static void on_log(void *environment, fmi2String instance, fmi2Status status, fmi2String category,
                   fmi2String format, ...)
{
    va_list list;
    (void)environment;
    printf("LOG\t%s\t%s\t%s\t", instance, NAMES[status], category);
    va_start(list, format);
    vprintf(format, list);
    va_end(list);
    printf("\n");
}

/* One answer, put together here so that log messages come out before it. */
static char answer[1 << 16];
static size_t answered;

static void say(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    answered += (size_t)vsnprintf(answer + answered, sizeof answer - answered, format, list);
    va_end(list);
    if (answer[answered - 1] == '\n') {
        fputs(answer, stdout);
        answered = 0;
    }
}

/* The struct is overwritten after every fmi2Instantiate: the standard does not say that it lives on. */
static fmi2CallbackFunctions callbacks(void)
{
    fmi2CallbackFunctions c = {on_log, calloc, free, NULL, &fmus};
    return c;
}

static fmi2String text(char *word)
{
    return strcmp(word, "NULL") == 0 ? NULL : strcmp(word, "EMPTY") == 0 ? "" : word;
}

static fmi2Component create(Fmu *f, char *name, char *guid, char *uri, int logging)
{
    fmi2CallbackFunctions c = callbacks();
    char copies[3][4096] = {"", "", ""};
    snprintf(copies[0], 4096, "%s", name);
    snprintf(copies[1], 4096, "%s", guid);
    snprintf(copies[2], 4096, "%s", uri);
    fmi2Component i =
        f->Instantiate(text(copies[0]), 1, text(copies[1]), text(copies[2]), &c, 0, logging);
    memset(&c, 0x5A, sizeof c);
    memset(copies, 0x5A, sizeof copies);
    return i;
}

static fmi2Status run(Fmu *f, fmi2Component i, double start, double step, int count)
{
    fmi2Status status = f->SetupExperiment(i, 0, 0, start, 0, 0);
    if (status == fmi2OK)
        status = f->EnterInitializationMode(i);
    if (status == fmi2OK)
        status = f->ExitInitializationMode(i);
    for (int k = 0; k < count && status == fmi2OK; k++)
        status = f->DoStep(i, start + k * step, step, 1);
    return status;
}

/* -- several threads -- */

typedef struct {
    Fmu *fmu;
    char *guid, *uri;
    int steps, number;
    fmi2ValueReference vr;
    double value;
    fmi2Status status;
} Job;

static void *work(void *data)
{
    Job *job = data;
    char name[20];
    snprintf(name, sizeof name, "thread%d", job->number);
    job->status = fmi2Error;
    fmi2Component i = create(job->fmu, name, job->guid, job->uri, 0);
    if (!i)
        return NULL;
    job->status = run(job->fmu, i, 0, 0.01, job->steps);
    if (job->status == fmi2OK)
        job->status = job->fmu->GetReal(i, &job->vr, 1, &job->value);
    job->fmu->FreeInstance(i);
    return NULL;
}

static void parallel(Fmu *f, int count, int steps, char *guid, char *uri, fmi2ValueReference vr)
{
    pthread_t threads[64];
    Job jobs[64];
    for (int k = 0; k < count && k < 64; k++) {
        jobs[k] = (Job){f, guid, uri, steps, k, vr, 0, fmi2OK};
        pthread_create(&threads[k], NULL, work, &jobs[k]);
    }
    say("=");
    for (int k = 0; k < count && k < 64; k++) {
        pthread_join(threads[k], NULL);
        say(" %s %.17g", NAMES[jobs[k].status], jobs[k].value);
    }
    say("\n");
}

/* -- memory -- */

#ifdef _WIN32
#include <psapi.h>
static double resident(void)
{
    PROCESS_MEMORY_COUNTERS counters = {0};
    K32GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters);
    return (double)counters.WorkingSetSize;
}
#else
static double resident(void)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%*d %ld", &pages) != 1)
        pages = 0;
    if (file)
        fclose(file);
    return (double)pages * (double)sysconf(_SC_PAGESIZE);
}
#endif

static void churn(Fmu *f, int count, char *guid, char *uri)
{
    double before = 0;
    int begin = count / 10; /* the first ones fill the allocators */
    char category[1000];
    const fmi2String categories[] = {category, "logStatusError"};
    memset(category, 'x', sizeof category);
    category[sizeof category - 1] = 0;
    for (int k = 0; k < count + begin; k++) {
        if (k == begin)
            before = resident();
        fmi2Component i = create(f, "one", guid, uri, 0);
        if (!i) {
            say("= Error %d\n", k);
            return;
        }
        f->SetDebugLogging(i, 1, 2, categories);
        f->FreeInstance(i);
    }
    say("= OK %.1f\n", (resident() - before) / count);
}

/* -- what must be refused -- */

static void misuse(Fmu *f, fmi2Component i)
{
    fmi2ValueReference vr = 0;
    double real = 0;
    say("=");
#define TELL(call) say(" %s", NAMES[call])
    TELL(f->GetReal(i, NULL, 1, &real));
    TELL(f->GetReal(i, &vr, 1, NULL));
    TELL(f->GetReal(i, &vr, SIZE_MAX, &real));
    TELL(f->SetReal(i, NULL, 1, &real));
    TELL(f->SetReal(i, &vr, 1, NULL));
    TELL(f->GetInteger(i, NULL, 2, NULL));
    TELL(f->SetString(i, NULL, 2, NULL));
    TELL(f->GetFMUstate(i, NULL));
    TELL(f->SetFMUstate(i, NULL));
    TELL(f->SetFMUstate(i, &vr));
    TELL(f->SetFMUstate(i, i));
    TELL(f->SerializedFMUstateSize(i, NULL, NULL));
    TELL(f->SerializeFMUstate(i, NULL, NULL, 0));
    TELL(f->DeSerializeFMUstate(i, NULL, 0, NULL));
    TELL(f->SetDebugLogging(i, 1, 3, NULL));
    TELL(f->GetStatus(i, 0, NULL));
    TELL(f->GetRealStatus(i, 2, NULL));
    TELL(f->GetRealStatus(i, 17, &real));
    TELL(f->SetRealInputDerivatives(i, &vr, 1, NULL, &real));
    TELL(f->GetRealOutputDerivatives(i, NULL, 1, NULL, &real));
    TELL(f->GetDirectionalDerivative(i, &vr, 1, NULL, 1, &real, &real));
    say(" |"); /* harmless */
    TELL(f->GetReal(i, NULL, 0, NULL));
    TELL(f->SetReal(i, NULL, 0, NULL));
    TELL(f->FreeFMUstate(i, NULL));
    say("\n");
}

static void strange(Fmu *f)
{
    fmi2Component some[] = {NULL, (void *)1, (void *)~(uintptr_t)0, &some, (void *)0x7fffdeadbee5, f->library, NULL};
    fmi2ValueReference vr = 0;
    double real = 0;
    fmi2FMUstate state = NULL;
    some[6] = instances[0]; /* of another FMU, or freed */
    say("=");
    for (int k = 0; k < 7; k++) {
        TELL(f->GetReal(some[k], &vr, 1, &real));
        TELL(f->SetReal(some[k], &vr, 1, &real));
        TELL(f->DoStep(some[k], 0, 1, 1));
        TELL(f->Reset(some[k]));
        TELL(f->Terminate(some[k]));
        TELL(f->EnterInitializationMode(some[k]));
        TELL(f->GetFMUstate(some[k], &state));
        TELL(f->SetDebugLogging(some[k], 1, 0, NULL));
        f->FreeInstance(some[k]);
    }
    say("\n");
}

/* -- commands -- */

enum { WORDS = 200 };

static void values(const char *command, fmi2Component i, Fmu *f, char **word, int n)
{
    fmi2ValueReference vr[WORDS];
    double real[WORDS];
    int integer[WORDS];
    fmi2String string[WORDS];
    int setting = command[0] == 's', m = 0;
    char type = command[3];
    fmi2Status status;
    for (int k = 2; k < n; k++, m++) {
        vr[m] = (fmi2ValueReference)strtoul(word[k], NULL, 10);
        if (setting && ++k < n) {
            real[m] = strtod(word[k], NULL);
            integer[m] = atoi(word[k]);
            string[m] = text(word[k]);
        }
    }
    if (type == 'i')
        status = setting ? f->SetInteger(i, vr, (size_t)m, integer) : f->GetInteger(i, vr, (size_t)m, integer);
    else if (type == 's')
        status = setting ? f->SetString(i, vr, (size_t)m, string) : f->GetString(i, vr, (size_t)m, string);
    else
        status = setting ? f->SetReal(i, vr, (size_t)m, real) : f->GetReal(i, vr, (size_t)m, real);
    say("= %s", NAMES[status]);
    for (int k = 0; k < m && !setting; k++) {
        if (type == 'i')
            say(" %d", integer[k]);
        else if (type == 's')
            say(" %s", string[k]);
        else
            say(" %.17g", real[k]);
    }
    say("\n");
}

static void command(char **word, int n)
{
#define IS(name, words) (strcmp(word[0], name) == 0 && n >= (words))
#define NUMBER(k) strtod(word[k], NULL)
    int a = n > 1 ? word[1][0] - '0' : 0, b = n > 2 ? word[2][0] - '0' : 0;
    a = a < 0 || a > 9 ? 0 : a;
    b = b < 0 || b > 9 ? 0 : b;
    fmi2Component i = instances[a];
    Fmu *f = fmu_of[a];
    fmi2Status status = fmi2OK;

    if (IS("load", 3)) {
        status = fmu_load(&fmus[a], word[2]) ? fmi2OK : fmi2Error;
    } else if (IS("unload", 2)) {
        status = dlclose(fmus[a].library) ? fmi2Error : fmi2OK;
    } else if (IS("new", 7)) {
        fmu_of[a] = &fmus[b];
        instances[a] = create(&fmus[b], word[3], word[4], word[5], atoi(word[6]));
        status = instances[a] ? fmi2OK : fmi2Error;
    } else if (IS("churn", 5)) {
        churn(&fmus[a], atoi(word[2]), word[3], word[4]);
        return;
    } else if (IS("parallel", 7)) {
        parallel(&fmus[a], atoi(word[2]), atoi(word[3]), word[4], word[5],
                 (fmi2ValueReference)strtoul(word[6], NULL, 10));
        return;
    } else if (IS("strange", 2)) {
        strange(&fmus[a]);
        return;
    } else if (IS("flip", 3)) {
        bytes[a][strtoul(word[2], NULL, 10) % lengths[a]] ^= 1;
    } else if (IS("cut", 3)) {
        lengths[a] = strtoul(word[2], NULL, 10);
    } else if (IS("clock", 1)) {
        say("= OK %.6f\n", (double)clock() / CLOCKS_PER_SEC);
        return;
    } else if (IS("length", 2)) {
        say("= OK %zu\n", lengths[a]);
        return;
    } else if (!f) {
        status = fmi2Error; /* an instance that was never made */
    } else if (IS("free", 2)) {
        f->FreeInstance(i);
    } else if (IS("enter", 2)) {
        status = f->EnterInitializationMode(i);
    } else if (IS("exit", 2)) {
        status = f->ExitInitializationMode(i);
    } else if (IS("terminate", 2)) {
        status = f->Terminate(i);
    } else if (IS("reset", 2)) {
        status = f->Reset(i);
    } else if (IS("cancel", 2)) {
        status = f->CancelStep(i);
    } else if (IS("setup", 5)) {
        status = f->SetupExperiment(i, word[2][0] != '-', NUMBER(2), NUMBER(3), word[4][0] != '-', NUMBER(4));
    } else if (IS("debug", 3)) {
        status = f->SetDebugLogging(i, atoi(word[2]), (size_t)(n - 3), (const fmi2String *)(word + 3));
    } else if (strncmp(word[0], "get", 3) == 0 || strncmp(word[0], "set", 3) == 0) {
        values(word[0], i, f, word, n);
        return;
    } else if (IS("step", 4)) {
        status = f->DoStep(i, NUMBER(2), NUMBER(3), 1);
    } else if (IS("steps", 5)) {
        for (int k = 0; k < atoi(word[4]) && status == fmi2OK; k++) {
            status = f->DoStep(i, NUMBER(2) + k * NUMBER(3), NUMBER(3), 1);
            if (n > 5)
                values("get", i, f, word + 3, n - 3);
        }
    } else if (IS("save", 3)) {
        status = f->GetFMUstate(i, &states[b]);
    } else if (IS("restore", 3)) {
        status = f->SetFMUstate(i, states[b]);
    } else if (IS("drop", 3)) {
        fmi2FMUstate copy = states[b]; /* kept, so that a test can use it after it was freed */
        status = f->FreeFMUstate(i, &copy);
    } else if (IS("write", 4)) {
        int c = word[3][0] - '0';
        status = f->SerializedFMUstateSize(i, states[b], &lengths[c]);
        if (status == fmi2OK) {
            bytes[c] = realloc(bytes[c], lengths[c]);
            status = f->SerializeFMUstate(i, states[b], bytes[c], lengths[c]);
        }
    } else if (IS("read", 4)) {
        int c = word[3][0] - '0';
        states[c] = NULL;
        status = f->DeSerializeFMUstate(i, bytes[b], lengths[b], &states[c]);
    } else if (IS("status", 2)) {
        fmi2Status last = fmi2Pending;
        double time = -1;
        int integer = -1, terminated = -1;
        fmi2String text = "?";
        say("= %s", NAMES[f->GetStatus(i, 0, &last)]);
        say(" %s", NAMES[last]);
        TELL(f->GetRealStatus(i, 2, &time));
        say(" %.17g", time);
        TELL(f->GetIntegerStatus(i, 0, &integer));
        TELL(f->GetBooleanStatus(i, 3, &terminated));
        say(" %d", terminated);
        TELL(f->GetStringStatus(i, 1, &text));
        say(" '%s'\n", text);
        return;
    } else if (IS("derivatives", 4)) {
        fmi2ValueReference in = (fmi2ValueReference)NUMBER(2), out = (fmi2ValueReference)NUMBER(3);
        int order = 1;
        double value = 1;
        say("=");
        TELL(f->SetRealInputDerivatives(i, &in, 1, &order, &value));
        TELL(f->GetRealOutputDerivatives(i, &out, 1, &order, &value));
        TELL(f->GetDirectionalDerivative(i, &out, 1, &in, 1, &value, &value));
        say("\n");
        return;
    } else if (strcmp(word[0], "change") == 0 && n > 4) {
        fmi2ValueReference out = (fmi2ValueReference)NUMBER(2), in[WORDS];
        double seed[WORDS], value = 0;
        size_t count = 0;
        for (int k = 3; k + 1 < n; k += 2, count++) {
            in[count] = (fmi2ValueReference)NUMBER(k);
            seed[count] = NUMBER(k + 1);
        }
        say("=");
        TELL(f->GetDirectionalDerivative(i, &out, 1, in, count, seed, &value));
        say(" %.17g\n", value);
        return;
    } else if (IS("misuse", 2)) {
        misuse(f, i);
        return;
    } else {
        say("? %s\n", word[0]);
        exit(2);
    }
    say("= %s\n", NAMES[status]);
}

int main(void)
{
    static char line[65536];
    prepare_streams();
    while (fgets(line, sizeof line, stdin)) {
        char *word[WORDS], *rest = NULL;
        int n = 0;
        line[strcspn(line, "\n")] = 0;
        for (char *w = strtok_r(line, "\t", &rest); w && n < WORDS; w = strtok_r(NULL, "\t", &rest))
            word[n++] = w;
        if (n)
            command(word, n);
        fflush(stdout);
    }
    return 0;
}
