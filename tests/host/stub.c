/* Stands in for PythonFMU's library: every function returns at once. What a call through the
 * forwarding library costs more than one of these is the cost of forwarding. */
#include <stddef.h>

typedef int Status;
#define STUB(name, ...)                                                                                \
    Status fmi2##name(__VA_ARGS__);                                                                    \
    Status fmi2##name(__VA_ARGS__)                                                                     \
    {                                                                                                  \
        return 0;                                                                                      \
    }

static int instance;

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *uri, const void *callbacks,
                      int visible, int logging);
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *uri, const void *callbacks,
                      int visible, int logging)
{
    (void)name, (void)type, (void)guid, (void)uri, (void)callbacks, (void)visible, (void)logging;
    return &instance;
}

STUB(FreeInstance, void)
STUB(SetupExperiment, void)
STUB(EnterInitializationMode, void)
STUB(ExitInitializationMode, void)
STUB(Terminate, void)
STUB(Reset, void)
STUB(GetReal, void)
STUB(GetInteger, void)
STUB(GetBoolean, void)
STUB(GetString, void)
STUB(SetReal, void)
STUB(SetInteger, void)
STUB(SetBoolean, void)
STUB(SetString, void)
STUB(GetFMUstate, void)
STUB(SetFMUstate, void)
STUB(FreeFMUstate, void)
STUB(SerializedFMUstateSize, void)
STUB(SerializeFMUstate, void)
STUB(DeSerializeFMUstate, void)
STUB(DoStep, void)
