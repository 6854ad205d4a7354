/* The C interface of FMI 2.0 for co-simulation (FMI 2.0.4, sections 2.1 and 4.2) as an importing tool
 * uses it: the types, and the functions of one loaded FMU binary. */
#ifndef HOST_FMI2_H
#define HOST_FMI2_H

#include "loading.h"

#include <stddef.h>
#include <stdio.h>

typedef void *fmi2Component;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;

typedef struct {
    void (*logger)(void *environment, fmi2String instance, fmi2Status, fmi2String category,
                   fmi2String message, ...);
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *);
    void (*stepFinished)(void *environment, fmi2Status);
    void *environment;
} fmi2CallbackFunctions;

#define FMI2_FUNCTIONS(F)                                                                              \
    F(const char *, GetTypesPlatform, (void))                                                          \
    F(const char *, GetVersion, (void))                                                                \
    F(fmi2Component, Instantiate,                                                                      \
      (fmi2String, int type, fmi2String guid, fmi2String uri, const fmi2CallbackFunctions *,           \
       fmi2Boolean visible, fmi2Boolean logging))                                                      \
    F(void, FreeInstance, (fmi2Component))                                                             \
    F(fmi2Status, SetDebugLogging, (fmi2Component, fmi2Boolean, size_t, const fmi2String *))           \
    F(fmi2Status, SetupExperiment,                                                                     \
      (fmi2Component, fmi2Boolean, fmi2Real tolerance, fmi2Real start, fmi2Boolean, fmi2Real stop))    \
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
    F(fmi2Status, GetDirectionalDerivative,                                                            \
      (fmi2Component, const fmi2ValueReference *, size_t, const fmi2ValueReference *, size_t,          \
       const fmi2Real *, fmi2Real *))                                                                  \
    F(fmi2Status, SetRealInputDerivatives,                                                             \
      (fmi2Component, const fmi2ValueReference *, size_t, const fmi2Integer *, const fmi2Real *))      \
    F(fmi2Status, GetRealOutputDerivatives,                                                            \
      (fmi2Component, const fmi2ValueReference *, size_t, const fmi2Integer *, fmi2Real *))            \
    F(fmi2Status, DoStep, (fmi2Component, fmi2Real time, fmi2Real step, fmi2Boolean))                  \
    F(fmi2Status, CancelStep, (fmi2Component))                                                         \
    F(fmi2Status, GetStatus, (fmi2Component, int kind, fmi2Status *))                                  \
    F(fmi2Status, GetRealStatus, (fmi2Component, int kind, fmi2Real *))                                \
    F(fmi2Status, GetIntegerStatus, (fmi2Component, int kind, fmi2Integer *))                          \
    F(fmi2Status, GetBooleanStatus, (fmi2Component, int kind, fmi2Boolean *))                          \
    F(fmi2Status, GetStringStatus, (fmi2Component, int kind, fmi2String *))

typedef struct {
    void *library;
#define FMI2_MEMBER(result, name, arguments) result(*name) arguments;
    FMI2_FUNCTIONS(FMI2_MEMBER)
} Fmu;

#ifndef SCOPE
#define SCOPE RTLD_LOCAL /* as most tools load binaries */
#endif

/* Load a binary; 0 when that fails. */
static inline int fmu_load(Fmu *f, const char *path)
{
    f->library = dlopen(path, RTLD_NOW | SCOPE);
    if (!f->library) {
        printf("dlopen: %s\n", dlerror());
        return 0;
    }
#define FMI2_FIND(result, name, arguments)                                                             \
    if (!(f->name = (result(*) arguments)dlsym(f->library, "fmi2" #name))) {                           \
        printf("no fmi2" #name "\n");                                                                  \
        return 0;                                                                                      \
    }
    FMI2_FUNCTIONS(FMI2_FIND)
    return 1;
}

#endif
