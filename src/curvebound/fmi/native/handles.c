#include "handles.h"

#include "platform.h"

#include <stdlib.h>

enum { SLOTS = 256, CHUNKS = 4096, NO_SLOT = SLOTS * CHUNKS };

static _Atomic(Slot *) chunks[CHUNKS];
static Lock slots_lock = UNLOCKED; /* guards the lists of slots */
static uint32_t first_vacant = NO_SLOT;
static _Atomic uint32_t n_slots;
static _Atomic uint32_t n_states; /* among the objects */

static Slot *slot_at(uint32_t place)
{
    Slot *chunk = atomic_load_explicit(&chunks[place / SLOTS], memory_order_acquire);
    return chunk ? &chunk[place % SLOTS] : NULL;
}

/* Different in each loaded copy of this library. */
static uint64_t library_key(void)
{
    return ((uint64_t)(uintptr_t)&slots_lock >> 4) * UINT64_C(0x9E3779B97F4A7C15) >> 45;
}

static void add_chunk(uint32_t n)
{
    Slot *chunk = calloc(SLOTS, sizeof *chunk);
    if (!chunk)
        return;
    for (uint32_t i = 0; i < SLOTS; i++)
        chunk[i].next = i + 1 < SLOTS ? n + i + 1 : NO_SLOT;
    first_vacant = n;
    atomic_store_explicit(&chunks[n / SLOTS], chunk, memory_order_release);
    atomic_store(&n_slots, n + SLOTS);
}

void *issue(Kind kind, void *object, void *owner)
{
    void *handle = NULL;
    lock(&slots_lock);
    uint32_t n = atomic_load(&n_slots);
    if (first_vacant == NO_SLOT && n < NO_SLOT)
        add_chunk(n);
    if (first_vacant != NO_SLOT) {
        uint32_t place = first_vacant;
        Slot *slot = slot_at(place);
        first_vacant = slot->next;
        slot->object = object;
        slot->uses++;
        /* 19 bits of key, 20 of use count, 20 of place, 4 of kind; the top bit stays 0 */
        uintptr_t number = (uintptr_t)(library_key() << 44 | (uint64_t)(slot->uses & 0xFFFFF) << 24 |
                                       (uint64_t)place << 4 | kind);
        atomic_store_explicit(&slot->owner, (uintptr_t)owner, memory_order_relaxed);
        atomic_store_explicit(&slot->busy, false, memory_order_relaxed);
        atomic_store_explicit(&slot->handle, number, memory_order_release);
        if (kind == STATE)
            atomic_fetch_add(&n_states, 1);
        handle = (void *)number;
    }
    unlock(&slots_lock);
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

/* Wait until another thread's call has ended. False for a call within a call of the same thread (from
 * the tool's logger), and after ten seconds: then the other one waits for something of this thread. */
static bool RARE wait_for(Slot *slot)
{
    for (int k = 0; k < MOMENTS; k++) {
        if (atomic_load(&slot->user) == this_thread())
            return false;
        wait_a_moment();
        if (!atomic_exchange_explicit(&slot->busy, true, memory_order_acquire))
            return true;
    }
    return false;
}

Slot *acquire(Kind kind, void *handle)
{
    Slot *slot = find(kind, handle);
    if (!slot)
        return NULL;
    if (atomic_exchange_explicit(&slot->busy, true, memory_order_acquire) && !wait_for(slot))
        return NULL;
    atomic_store_explicit(&slot->user, this_thread(), memory_order_relaxed);
    /* It may have been freed, and even issued anew, since find(). */
    if (atomic_load_explicit(&slot->handle, memory_order_acquire) != (uintptr_t)handle) {
        release(slot);
        return NULL;
    }
    return slot;
}

void retire(Slot *slot)
{
    lock(&slots_lock);
    uintptr_t number = atomic_load(&slot->handle);
    if ((number & 15) == STATE)
        atomic_fetch_sub(&n_states, 1);
    atomic_store_explicit(&slot->handle, 0, memory_order_release);
    atomic_store(&slot->owner, 0);
    slot->object = NULL;
    slot->next = first_vacant;
    first_vacant = number >> 4 & 0xFFFFF;
    release(slot);
    unlock(&slots_lock);
}

Slot *next_state_of(void *owner, uint32_t *place)
{
    for (; atomic_load(&n_states) && *place < atomic_load(&n_slots); ++*place) {
        Slot *slot = slot_at(*place);
        if (atomic_load(&slot->owner) != (uintptr_t)owner)
            continue;
        Slot *state = acquire(STATE, (void *)atomic_load(&slot->handle));
        if (state)
            return state;
    }
    return NULL;
}

/* A tool may load and unload this library for each instance. */
__attribute__((destructor)) static void give_back(void)
{
    for (uint32_t place = 0; place < atomic_load(&n_slots); place++)
        if (atomic_load(&slot_at(place)->handle))
            return; /* still in use: the process ends */
    for (uint32_t k = 0; k < CHUNKS; k++)
        free(atomic_exchange(&chunks[k], NULL));
}
