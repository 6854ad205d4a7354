/* Saved states. */
#ifndef CURVEBOUND_STATES_H
#define CURVEBOUND_STATES_H

#include "handles.h"

/* Free an acquired state. */
void drop_state(Slot *slot);

#endif
