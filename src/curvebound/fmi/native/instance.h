/* Instances: what this library knows of them, and how each call on one begins and ends. */
#ifndef CURVEBOUND_INSTANCE_H
#define CURVEBOUND_INSTANCE_H

#include "direct.h"
#include "fmi2.h"
#include "handles.h"
#include "text.h"

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

/* The methods about derivatives. */
typedef enum { SLOPES, RATES, CHANGES } OfDerivatives;

/* The Python object of an instance, and what of it every step needs. */
typedef struct {
    Direct direct;
    void *object;
    void *do_step;
    void *get_real;
    void *set_real;
    void *of_derivatives[3]; /* by OfDerivatives; NULL for what it does not offer */
    void *queue;  /* list of the messages that wait to be logged */
} Slave;

/* What every call needs comes first: with thousands of instances these lines compete for the cache. */
typedef struct {
    void *handle;                /* what the importing tool holds */
    Slave slave;
    Progress now;
    fmi2Status worst;            /* of the messages logged during the present call */
    bool interrupted;            /* the present call was */
    bool calling_host;           /* the tool's logger is running */
    bool visible;
    bool logging;
    fmi2CallbackFunctions host;  /* a copy, because nothing says how long the original lives */
    void *type;                  /* the slave's class */
    void *strings;               /* list of what fmi2GetString has pointed to last */
    struct Folder *folder;       /* of its modules */
    char *name;
    char *resources;
    char **categories;           /* those switched on; none given means all */
    size_t n_categories;
} Instance;

/* Begin a call: the instance, for this call alone until done() or finish(). NULL when the call is
 * refused; the reason is logged where there is an instance to log it. */
Slot *begin(fmi2Component c, const char *function, int allowed);

/* End a call that cannot have changed the instance. */
static inline fmi2Status done(Slot *slot, fmi2Status status)
{
    release(slot);
    return status;
}

/* End a call that may have changed the instance: after an error it counts as failed. */
static inline fmi2Status finish(Slot *slot, fmi2Status status)
{
    Instance *i = slot->object;
    if (status >= fmi2Error && !i->interrupted)
        i->now.phase = FAILED;
    return done(slot, status);
}

/* Whether the arrays of an fmi2GetXxx or fmi2SetXxx function can be used; says so if not. */
bool usable(Instance *i, const char *function, const void *references, size_t n, const void *values);

#endif
