/* Handles: what the importing tool holds of instances and saved states.
 *
 * They are numbers, not addresses: the place of a slot, how often it has been used, and a key of this
 * library, so that no pointer of another library, freed or made up is ever followed. Looking a number up
 * takes no lock, because slots never move. */
#ifndef CURVEBOUND_HANDLES_H
#define CURVEBOUND_HANDLES_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

typedef enum { INSTANCE = 5, STATE = 6 } Kind;

typedef struct {
    _Atomic uintptr_t handle; /* 0: vacant */
    _Atomic uintptr_t owner;  /* of a state: the instance with which it is freed at the latest */
    atomic_bool busy;         /* a call is using the object: */
    _Atomic uintptr_t user;   /* one of this thread */
    void *object;
    uint32_t uses;
    uint32_t next;            /* vacant slots form a list */
} Slot;

/* A handle for `object`, or NULL when there is no memory for one. */
void *issue(Kind kind, void *object, void *owner);

/* The slot behind a valid handle, for the caller alone until release(); NULL when the handle is not (or
 * no longer) one of this library, or the object cannot be had. */
Slot *acquire(Kind kind, void *handle);

static inline void release(Slot *slot)
{
    atomic_store_explicit(&slot->user, 0, memory_order_relaxed);
    atomic_store_explicit(&slot->busy, false, memory_order_release);
}

/* Make an acquired slot vacant; its handle is refused from now on. */
void retire(Slot *slot);

/* Acquire one after the other the states that `owner` has; `place` is 0 at first. NULL after the last. */
Slot *next_state_of(void *owner, uint32_t *place);

#endif
