/* The bead as a plant of fmu.c: Cartesian form, projected onto the wire after each internal step. */
#define VARIABLES "bead_variables.h"
#define TURN 6.283185307179586

typedef struct {
    bead system;
    state s;             /* relative to the wire's centre */
    double turns;        /* whole turns, so that the angle is continuous */
    double x, y, vx, vy; /* of the centre */
} plant;

/* Angle within the turn, in (-pi, pi]; the zero added makes -0 a zero, which lies at pi. */
static double angle_within(const state *s) { return atan2(s->q0 + 0.0, -s->q1); }

static const char *plant_start(plant *p, const double *r)
{
    const double length = r[wire_radius], angle = r[bead_angle_start], rate = r[bead_rate_start];

    if (!(length > 0.0) || !(r[bead_mass] > 0.0) || !(r[bead_damping] >= 0.0))
        return "wire.radius and bead.mass must be above zero, bead.damping not below";
    *p = (plant){.system = {.radius = length,
                            .per_radius = 1.0 / length,
                            .drag = r[bead_damping] / r[bead_mass]},
                 .s = {length * sin(angle), -length * cos(angle), length * rate * cos(angle),
                       length * rate * sin(angle)}};
    p->turns = nearbyint((angle - angle_within(&p->s)) / TURN);
    return NULL;
}

static void plant_step(plant *p, const double *r, double duration, long count)
{
    const double h = duration / (double)count;

    p->system.gx = r[gravity_x] + r[bead_fx] / r[bead_mass] - r[wire_ax];
    p->system.gy = r[gravity_y] + r[bead_fy] / r[bead_mass] - r[wire_ay];
    for (long i = 0; i < count; i++) {
        const int was_left = p->s.q0 < 0.0;

        rk4(bead_cartesian, &p->system, (double)i * h, h, &p->s);
        bead_project(&p->system, &p->s);
        const int is_left = p->s.q0 < 0.0;
        if (is_left != was_left && p->s.q1 > 0.0) /* over the top */
            p->turns += is_left ? 1.0 : -1.0;
    }
    p->x += duration * (p->vx + 0.5 * duration * r[wire_ax]);
    p->y += duration * (p->vy + 0.5 * duration * r[wire_ay]);
    p->vx += duration * r[wire_ax];
    p->vy += duration * r[wire_ay];
}

static int plant_is_finite(const plant *p)
{
    return isfinite(p->s.q0) && isfinite(p->s.q1) && isfinite(p->s.v0) && isfinite(p->s.v1);
}

static void plant_observe(const plant *p, double *r)
{
    const double radius = p->system.radius;

    r[bead_x] = p->x + p->s.q0;
    r[bead_y] = p->y + p->s.q1;
    r[bead_vx] = p->vx + p->s.v0;
    r[bead_vy] = p->vy + p->s.v1;
    r[bead_angle_now] = angle_within(&p->s) + TURN * p->turns;
    r[bead_rate] = (p->s.q0 * p->s.v1 - p->s.q1 * p->s.v0) / (radius * radius);
    r[wire_x] = p->x;
    r[wire_y] = p->y;
    r[wire_vx] = p->vx;
    r[wire_vy] = p->vy;
}
