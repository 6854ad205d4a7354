/* The equations of motion and one Runge-Kutta step, as one would write them in C by hand.
 *
 * kernel.c and fmu.c both take their physics from here, so that what the benchmark compares the
 * Python kernel with is one piece of C, at both levels. Terms that are off (no damping, no force, a
 * parabola of fixed shape) cost one comparison, as they do in the Python kernel.
 *
 * Units are SI; x to the right, y up; angles counter-clockwise from the downward vertical.
 */
#ifndef CURVEBOUND_BENCH_PHYSICS_H
#define CURVEBOUND_BENCH_PHYSICS_H

#include <math.h>

#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* Two generalised coordinates and their rates; a bead in Cartesian form has them in x and y. */
typedef struct {
    double q0, q1, v0, v1;
} state;

/* q'' of a system at time t since the last communication point. */
typedef void acceleration(const void *system, double t, const state *s, double *a0, double *a1);

/* One step of the classical Runge-Kutta method (Kutta 1901). `f` is a constant at every call, so
 * that the compiler puts the equations straight into the step. */
ALWAYS_INLINE void rk4(acceleration *f, const void *system, double t, double h, state *s)
{
    const double half = 0.5 * h, sixth = h / 6.0;
    double a0, a1, b0, b1, c0, c1, d0, d1;
    state b, c, d;

    f(system, t, s, &a0, &a1);
    b = (state){s->q0 + half * s->v0, s->q1 + half * s->v1, s->v0 + half * a0, s->v1 + half * a1};
    f(system, t + half, &b, &b0, &b1);
    c = (state){s->q0 + half * b.v0, s->q1 + half * b.v1, s->v0 + half * b0, s->v1 + half * b1};
    f(system, t + half, &c, &c0, &c1);
    d = (state){s->q0 + h * c.v0, s->q1 + h * c.v1, s->v0 + h * c0, s->v1 + h * c1};
    f(system, t + h, &d, &d0, &d1);

    s->q0 += sixth * (s->v0 + 2.0 * (b.v0 + c.v0) + d.v0);
    s->q1 += sixth * (s->v1 + 2.0 * (b.v1 + c.v1) + d.v1);
    s->v0 += sixth * (a0 + 2.0 * (b0 + c0) + d0);
    s->v1 += sixth * (a1 + 2.0 * (b1 + c1) + d1);
}

/* -- Bead on a circular wire --------------------------------------------------------------------- */

typedef struct {
    double radius; /* m */
    double per_radius; /* its reciprocal */
    double drag;   /* damping over mass, 1/s */
    double gx, gy; /* gravity, plus force over mass, less the centre's acceleration, m/s2 */
} bead;

/* Cartesian form with the multiplier lambda = -(p.f + m v.v) / (p.p) eliminated. */
ALWAYS_INLINE void bead_cartesian(const void *system, double t, const state *s, double *ax,
                                  double *ay)
{
    const bead *b = system;
    const double x = s->q0, y = s->q1, vx = s->v0, vy = s->v1;
    const double pull = (b->gx * x + b->gy * y + vx * vx + vy * vy) / (x * x + y * y);

    (void)t;
    *ax = b->gx - pull * x;
    *ay = b->gy - pull * y;
    if (b->drag != 0.0) {
        *ax -= b->drag * vx;
        *ay -= b->drag * vy;
    }
}

/* Back onto the wire: the position along the radius, the velocity onto the tangent. */
ALWAYS_INLINE void bead_project(const bead *b, state *s)
{
    const double per_length = 1.0 / sqrt(s->q0 * s->q0 + s->q1 * s->q1);
    const double nx = s->q0 * per_length, ny = s->q1 * per_length;
    const double radial = nx * s->v0 + ny * s->v1;

    s->q0 = b->radius * nx;
    s->q1 = b->radius * ny;
    s->v0 -= radial * nx;
    s->v1 -= radial * ny;
}

/* Minimal form: the angle's acceleration from the tangential force. */
ALWAYS_INLINE double bead_angle(const bead *b, double angle, double rate)
{
    double a = (b->gx * cos(angle) + b->gy * sin(angle)) * b->per_radius;

    if (b->drag != 0.0)
        a -= b->drag * rate;
    return a;
}

/* One degree of freedom, so its step carries one. */
ALWAYS_INLINE void rk4_bead_angle(const bead *system, double h, double *angle, double *rate)
{
    const double half = 0.5 * h, sixth = h / 6.0, q = *angle, v = *rate;
    const double a = bead_angle(system, q, v);
    const double vb = v + half * a, b = bead_angle(system, q + half * v, vb);
    const double vc = v + half * b, c = bead_angle(system, q + half * vb, vc);
    const double vd = v + h * c, d = bead_angle(system, q + h * vc, vd);

    *angle = q + sixth * (v + 2.0 * (vb + vc) + vd);
    *rate = v + sixth * (a + 2.0 * (b + c) + d);
}

/* -- Pendulum hung from a slider on a parabola --------------------------------------------------- */

typedef struct {
    double m1, m2;             /* kg */
    double length, per_length; /* m, and its reciprocal */
    double a, da, dda;         /* coefficient of the parabola, 1/m, and its time derivatives */
    double gx, gy;             /* vertex acceleration less gravity: (X'', g + Y''), m/s2 */
    double slider_damping, pendulum_damping;     /* N.s/m, N.m.s/rad */
    double slider_fx, slider_fy, bob_fx, bob_fy; /* N */
    int shape_moves, forced; /* whether da or dda, and whether damping or forces, are not zero */
} pendulum;

/* u'' and th'' in the form without cancelling products, see the model's own documentation. */
ALWAYS_INLINE void pendulum_nonlinear(const void *system, double t, const state *s, double *ddu,
                                      double *ddth)
{
    const pendulum *p = system;
    const double u = s->q0, du = s->v0, dth = s->v1;
    const double sine = sin(s->q1), cosine = cos(s->q1);
    double a = p->a, g = p->gy;

    if (p->shape_moves) {
        const double da = p->da + t * p->dda;
        a += t * (p->da + 0.5 * t * p->dda);
        g += u * (u * p->dda + 4.0 * du * da);
    }
    g += 2.0 * a * du * du;

    const double q = 2.0 * a * u, lift = 1.0 + q * q;
    const double w = cosine + q * sine, k = sine - q * cosine;
    const double m1 = p->m1, m2 = p->m2, r = p->length, x = p->gx;
    const double swing = r * dth * dth;
    double nu = m2 * k * (g * cosine - x * sine + swing) - m1 * (x + q * g);
    double nth = -k * ((m1 + m2) * (g - q * x) + w * m2 * swing);

    if (p->forced) {
        const double fu = p->slider_fx + p->bob_fx + q * (p->slider_fy + p->bob_fy)
                          - p->slider_damping * lift * du;
        const double fth = r * (p->bob_fx * cosine + p->bob_fy * sine) - p->pendulum_damping * dth;
        nu += fu - w * fth * p->per_length;
        nth += (m1 + m2) * lift * fth * p->per_length / m2 - w * fu;
    }
    const double inverse = 1.0 / (m1 * lift + m2 * k * k);
    *ddu = nu * inverse;
    *ddth = nth * inverse * p->per_length;
}

/* The quadratic part of the Lagrangian, undamped and undriven: two coupled oscillators. */
typedef struct {
    double uu, uth, thu, thth; /* u'' = uu u + uth th, th'' = thu u + thth th, 1/s2 */
} linear_pendulum;

ALWAYS_INLINE void pendulum_linear(const void *system, double t, const state *s, double *ddu,
                                   double *ddth)
{
    const linear_pendulum *p = system;

    (void)t;
    *ddu = p->uu * s->q0 + p->uth * s->q1;
    *ddth = p->thu * s->q0 + p->thth * s->q1;
}

#endif
