/* The pendulum on the parabola as a plant of fmu.c: the nonlinear equations. */
#define VARIABLES "pendulum_variables.h"

typedef struct {
    pendulum system;
    state s;
    double x, y, vx, vy; /* of the vertex */
} plant;

static const char *plant_start(plant *p, const double *r)
{
    if (!(r[slider_mass] > 0.0) || !(r[pendulum_mass] > 0.0) || !(r[pendulum_length] > 0.0)
        || !(r[slider_damping] >= 0.0) || !(r[pendulum_damping] >= 0.0))
        return "masses and pendulum.length must be above zero, dampings not below";
    *p = (plant){.system = {.m1 = r[slider_mass],
                            .m2 = r[pendulum_mass],
                            .length = r[pendulum_length],
                            .per_length = 1.0 / r[pendulum_length],
                            .a = r[coefficient_start],
                            .da = r[coefficient_rate_start],
                            .slider_damping = r[slider_damping],
                            .pendulum_damping = r[pendulum_damping]},
                 .s = {r[u_start], r[angle_start], r[u_rate_start], r[rate_start]}};
    return NULL;
}

static void plant_step(plant *p, const double *r, double duration, long count)
{
    const double h = duration / (double)count;
    pendulum *system = &p->system;

    system->dda = r[coefficient_acceleration];
    system->gx = r[parabola_ax] - r[gravity_x];
    system->gy = r[parabola_ay] - r[gravity_y];
    system->slider_fx = r[slider_fx];
    system->slider_fy = r[slider_fy];
    system->bob_fx = r[pendulum_fx];
    system->bob_fy = r[pendulum_fy];
    system->shape_moves = system->da != 0.0 || system->dda != 0.0;
    system->forced = system->slider_damping != 0.0 || system->pendulum_damping != 0.0
                     || system->slider_fx != 0.0 || system->slider_fy != 0.0
                     || system->bob_fx != 0.0 || system->bob_fy != 0.0;
    for (long i = 0; i < count; i++)
        rk4(pendulum_nonlinear, system, (double)i * h, h, &p->s);
    p->x += duration * (p->vx + 0.5 * duration * r[parabola_ax]);
    p->y += duration * (p->vy + 0.5 * duration * r[parabola_ay]);
    p->vx += duration * r[parabola_ax];
    p->vy += duration * r[parabola_ay];
    system->a += duration * (system->da + 0.5 * duration * system->dda);
    system->da += duration * system->dda;
}

static int plant_is_finite(const plant *p)
{
    return isfinite(p->s.q0) && isfinite(p->s.q1) && isfinite(p->s.v0) && isfinite(p->s.v1);
}

static void plant_observe(const plant *p, double *r)
{
    const double a = p->system.a, da = p->system.da, length = p->system.length;
    const double at = p->s.q0, du = p->s.v0, sine = sin(p->s.q1), cosine = cos(p->s.q1);

    r[u] = at;
    r[u_rate] = du;
    r[angle] = p->s.q1;
    r[rate] = p->s.v1;
    r[slider_x] = p->x + at;
    r[slider_y] = p->y + a * at * at;
    r[slider_vx] = p->vx + du;
    r[slider_vy] = p->vy + at * (2.0 * a * du + da * at);
    r[pendulum_x] = r[slider_x] + length * sine;
    r[pendulum_y] = r[slider_y] - length * cosine;
    r[pendulum_vx] = r[slider_vx] + length * p->s.v1 * cosine;
    r[pendulum_vy] = r[slider_vy] + length * p->s.v1 * sine;
    r[parabola_x] = p->x;
    r[parabola_y] = p->y;
    r[parabola_vx] = p->vx;
    r[parabola_vy] = p->vy;
    r[coefficient] = a;
    r[coefficient_rate] = da;
}
