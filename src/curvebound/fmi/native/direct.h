/* The C functions of a slave whose engine is compiled: called without objects in between. */
#ifndef CURVEBOUND_DIRECT_H
#define CURVEBOUND_DIRECT_H

#include "fmi2.h"

#include <stdbool.h>

/* On the engine; as those of Python they are called holding the interpreter, and may raise. */
typedef struct {
    void *engine; /* NULL: there are none, the slave's methods have to do */
    int (*do_step)(void *engine, double time, double size);
    double (*get_real)(void *engine, long long vr);
    int (*set_real)(void *engine, long long vr, double value);
    int (*set_slope)(void *engine, long long vr, long long order, double value);
    double (*get_rate)(void *engine, long long vr, long long order);
} Direct;

/* Take those that a slave offers, if any. */
void find_direct(Direct *direct, void *slave);

/* Each for n variables; false with an exception set. */
bool get_reals(const Direct *direct, const fmi2ValueReference vr[], size_t n, fmi2Real value[]);
bool set_reals(const Direct *direct, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]);
bool set_slopes(const Direct *direct, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                const fmi2Real value[]);
bool get_rates(const Direct *direct, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
               fmi2Real value[]);

#endif
