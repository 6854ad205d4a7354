/* What one internal step costs in C: loops of Runge-Kutta steps, called through ctypes.
 *
 * Each function advances a state by n steps of h seconds. The systems come by pointer, so that the
 * compiler cannot specialise the equations for one set of parameters.
 */
#include "physics.h"

void run_bead_cartesian(const bead *b, int project, double h, long n, state *out)
{
    state s = *out;

    for (long i = 0; i < n; i++) {
        rk4(bead_cartesian, b, (double)i * h, h, &s);
        if (project)
            bead_project(b, &s);
    }
    *out = s;
}

/* q0 and v0 of the state are the angle and its rate. */
void run_bead_angle(const bead *b, double h, long n, state *out)
{
    double angle = out->q0, rate = out->v0;

    for (long i = 0; i < n; i++)
        rk4_bead_angle(b, h, &angle, &rate);
    out->q0 = angle;
    out->v0 = rate;
}

void run_pendulum_nonlinear(const pendulum *p, double h, long n, state *out)
{
    state s = *out;

    for (long i = 0; i < n; i++)
        rk4(pendulum_nonlinear, p, (double)i * h, h, &s);
    *out = s;
}

void run_pendulum_linear(const linear_pendulum *p, double h, long n, state *out)
{
    state s = *out;

    for (long i = 0; i < n; i++)
        rk4(pendulum_linear, p, (double)i * h, h, &s);
    *out = s;
}
