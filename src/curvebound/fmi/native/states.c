#define _GNU_SOURCE
#include "states.h"

#include "fmu.h"
#include "logging.h"
#include "platform.h"
#include "slave.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    void *object; /* of Python's: what the slave's _get_fmu_state() gave */
    Progress progress;
} State;

void drop_state(Slot *slot)
{
    State *state = slot->object;
    if (py.Py_IsInitialized()) {
        int gil = py.PyGILState_Ensure();
        py.Py_DecRef(state->object);
        py.PyGILState_Release(gil);
    }
    retire(slot);
    free(state);
}

/* Put an object where the tool wants it: over the state `reused`, or into a new one that `i` owns.
 * Takes the object over. */
static fmi2Status keep(Instance *i, const char *function, void *object, Progress progress, Slot *reused,
                       fmi2FMUstate *handle)
{
    State *state = reused ? reused->object : calloc(1, sizeof *state);
    void *old = object;
    const bool kept = reused || (state && (*handle = issue(STATE, state, i->handle)));
    if (kept) {
        old = state->object;
        *state = (State){object, progress};
    } else {
        free(state);
    }
    int gil = py.PyGILState_Ensure();
    py.Py_DecRef(old);
    py.PyGILState_Release(gil);
    return kept ? fmi2OK : refuse(i, "%s: out of memory", function);
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

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *handle)
{
    const char *const function = "fmi2GetFMUstate";
    Slot *slot = begin(c, function, ANY);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    int gil;
    if (!handle)
        return done(slot, refuse(i, "%s: FMUstate is NULL", function));
    Slot *reused = NULL; /* a state given back is overwritten */
    if (*handle && !(reused = begin_state(i, function, *handle)))
        return done(slot, fmi2Error);
    fmi2Status status = fmi2Error;
    if (enter_python(i, function, &gil)) {
        void *object = call_method(i->slave.object, "_get_fmu_state", NULL, NULL, NULL);
        status = leave_python(i, function, gil, !object);
        if (object && status < fmi2Error)
            status = keep(i, function, object, i->now, reused, handle);
    }
    if (reused)
        release(reused);
    return done(slot, status);
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate handle)
{
    const char *const function = "fmi2SetFMUstate";
    Slot *slot = begin(c, function, ANY);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    Slot *saved = begin_state(i, function, handle);
    if (!saved)
        return done(slot, fmi2Error);
    State *state = saved->object;
    fmi2Status status = fmi2Error;
    int gil;
    if (enter_python(i, function, &gil)) {
        void *result = call_method(i->slave.object, "_set_fmu_state", state->object, NULL, NULL);
        py.Py_DecRef(result);
        status = leave_python(i, function, gil, !result);
    }
    if (status < fmi2Error)
        i->now = state->progress;
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
    drop_state(state);
    *handle = NULL;
    return done(slot, fmi2OK);
}

/* What precedes the slave's bytes in a serialised state. */
typedef struct {
    char magic[8];
    char guid[64];
    uint64_t size; /* of the slave's bytes */
    Progress progress;
    uint64_t checksum; /* of all other bytes */
} Header;

static const char MAGIC[8] = "curvest3";

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

/* Write a state to `bytes`, of which there are `size`, or with NULL only find how many it needs. */
static fmi2Status serialize(fmi2Component c, const char *function, fmi2FMUstate handle, bool ready,
                            fmi2Byte *bytes, size_t size, size_t *needed)
{
    Slot *slot = begin(c, function, ANY), *saved;
    int gil;
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    if (!ready)
        return done(slot, refuse(i, "%s: an argument is NULL", function));
    if (!(saved = begin_state(i, function, handle)))
        return done(slot, fmi2Error);
    if (!enter_python(i, function, &gil)) {
        release(saved);
        return done(slot, fmi2Error);
    }
    State *state = saved->object;
    char *payload = NULL;
    ptrdiff_t length = 0;
    void *object = call_method(i->slave.object, "_fmu_state_to_bytes", state->object, NULL, NULL);
    bool raised = !object || py.PyBytes_AsStringAndSize(object, &payload, &length);
    size_t total = sizeof(Header) + (size_t)length;
    if (!raised && bytes && size >= total) {
        Header header = {.size = (uint64_t)length, .progress = state->progress};
        memcpy(header.magic, MAGIC, sizeof MAGIC);
        strncpy(header.guid, guid_of_fmu(), sizeof header.guid - 1);
        header.checksum = checksum_of(&header, payload);
        memcpy(bytes, &header, sizeof header);
        memcpy(bytes + sizeof header, payload, (size_t)length);
    }
    py.Py_DecRef(object);
    fmi2Status status = leave_python(i, function, gil, raised);
    if (status < fmi2Error && bytes && size < total)
        status = refuse(i, "%s: size = %zu is too small: ask fmi2SerializedFMUstateSize", function, size);
    if (status < fmi2Error && needed)
        *needed = total;
    release(saved);
    return done(slot, status);
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate handle, size_t *size)
{
    return serialize(c, "fmi2SerializedFMUstateSize", handle, size, NULL, 0, size);
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate handle, fmi2Byte bytes[],
                                        size_t size)
{
    return serialize(c, "fmi2SerializeFMUstate", handle, bytes, bytes, size, NULL);
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                          fmi2FMUstate *handle)
{
    const char *const function = "fmi2DeSerializeFMUstate", *guid = guid_of_fmu();
    Slot *slot = begin(c, function, ANY);
    if (!slot)
        return fmi2Error;
    Instance *i = slot->object;
    Header header;
    int gil;
    if (!bytes || !handle)
        return done(slot, refuse(i, "%s: an argument is NULL", function));
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
    if (!enter_python(i, function, &gil))
        return done(slot, fmi2Error);
    void *payload = py.PyBytes_FromStringAndSize(bytes + sizeof header, (ptrdiff_t)header.size);
    void *object = NULL;
    if (payload)
        object = call_method(i->slave.object, "_fmu_state_from_bytes", payload, NULL, NULL);
    py.Py_DecRef(payload);
    fmi2Status status = leave_python(i, function, gil, !object);
    if (object && status < fmi2Error)
        status = keep(i, function, object, header.progress, NULL, handle);
    return done(slot, status);
}
