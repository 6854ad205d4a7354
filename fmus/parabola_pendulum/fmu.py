"""ParabolaPendulum: a slider on the parabola y = a u^2 and a pendulum that hangs from it.

The vertex of the parabola can be accelerated, its coefficient can change, forces can be applied to
slider and bob; damping acts along the parabola and on the pendulum's rotation.
"""

from curvebound.fmi.common import ENERGY, GRAVITY, SOLVER
from curvebound.fmi.declaration import Enumeration, Fmu, choice, input_, output, parameter
from curvebound.fmi.plant import Plant
from curvebound.models.parabola_pendulum import parabola_pendulum

FIDELITY = Enumeration(
    "Fidelity",
    "terms of the Lagrangian that are kept",
    (
        ("linear", "the quadratic part about slider.u = pendulum.angle = 0"),
        ("nonlinear", "all terms"),
    ),
)

FMU = Fmu(
    name="ParabolaPendulum",
    description="Pendulum that hangs from a mass sliding on a parabola, driven and damped",
    system=Plant(parabola_pendulum),
    variables=(
        *GRAVITY,
        parameter(
            "parabola.coefficient_start", "1/m", 0.5, "initial coefficient a of y = a u^2, any sign"
        ),
        parameter(
            "parabola.coefficient_rate_start", "1/(m.s)", 0.0, "initial rate of the coefficient"
        ),
        parameter("slider.mass", "kg", 1.0, "mass of the slider (above zero)", above=0.0),
        parameter("pendulum.mass", "kg", 1.0, "mass of the bob (above zero)", above=0.0),
        parameter("pendulum.length", "m", 1.0, "length of the rod (above zero)", above=0.0),
        parameter(
            "slider.damping",
            "N.s/m",
            0.0,
            "viscous damping of the slider along the parabola",
            at_least=0.0,
        ),
        parameter(
            "pendulum.damping",
            "N.m.s/rad",
            0.0,
            "viscous damping of the pendulum's rotation",
            at_least=0.0,
        ),
        parameter("slider.u_start", "m", 0.5, "initial abscissa of the slider from the vertex"),
        parameter("slider.u_rate_start", "m/s", 0.0, "initial rate of the abscissa"),
        parameter(
            "pendulum.angle_start",
            "rad",
            0.5,
            "initial angle of the rod from the downward vertical, counter-clockwise",
        ),
        parameter("pendulum.angular_velocity_start", "rad/s", 0.0, "initial angular velocity"),
        choice("model.fidelity", FIDELITY, "nonlinear", "terms of the Lagrangian that are kept"),
        *SOLVER,
        input_("parabola.ax", "m/s2", "acceleration of the vertex to the right", nominal=10.0),
        input_("parabola.ay", "m/s2", "acceleration of the vertex upward", nominal=10.0),
        input_(
            "parabola.coefficient_acceleration",
            "1/(m.s2)",
            "second time derivative of the coefficient",
        ),
        input_("slider.fx", "N", "external force on the slider to the right", nominal=10.0),
        input_("slider.fy", "N", "external force on the slider upward", nominal=10.0),
        input_("pendulum.fx", "N", "external force on the bob to the right", nominal=10.0),
        input_("pendulum.fy", "N", "external force on the bob upward", nominal=10.0),
        output("slider.u", "m", "abscissa of the slider from the vertex"),
        output("slider.u_rate", "m/s", "rate of the abscissa"),
        output("pendulum.angle", "rad", "angle of the rod from the downward vertical, continuous"),
        output("pendulum.angular_velocity", "rad/s", "rate of the angle"),
        output("slider.x", "m", "position of the slider to the right, world frame"),
        output("slider.y", "m", "position of the slider upward, world frame"),
        output("slider.vx", "m/s", "velocity of the slider to the right, world frame"),
        output("slider.vy", "m/s", "velocity of the slider upward, world frame"),
        output("pendulum.x", "m", "position of the bob to the right, world frame"),
        output("pendulum.y", "m", "position of the bob upward, world frame"),
        output("pendulum.vx", "m/s", "velocity of the bob to the right, world frame"),
        output("pendulum.vy", "m/s", "velocity of the bob upward, world frame"),
        output("parabola.x", "m", "position of the vertex to the right"),
        output("parabola.y", "m", "position of the vertex upward"),
        output("parabola.vx", "m/s", "velocity of the vertex to the right"),
        output("parabola.vy", "m/s", "velocity of the vertex upward"),
        output("parabola.coefficient", "1/m", "coefficient a of y = a u^2"),
        output("parabola.coefficient_rate", "1/(m.s)", "rate of the coefficient"),
        *ENERGY,
        output(
            "constraint.normal_force",
            "N",
            "force of the parabola on the slider along its unit normal, positive upward",
        ),
        output("pendulum.tension", "N", "force in the rod, positive in tension"),
        output("parabola.fx", "N", "force of slider and bob on the parabola to the right"),
        output("parabola.fy", "N", "force of slider and bob on the parabola upward"),
        output(
            "model.acceleration_error",
            "1",
            "linear fidelity: relative difference between linear and nonlinear accelerations",
        ),
    ),
    reference_inputs={"parabola.ax": (1.0, 0.3), "parabola.ay": (1.0, 0.7)},
    plotted=("slider.u", "pendulum.angle", "constraint.normal_force", "energy.residual"),
    documentation="""
<h2>Equations</h2>
<p>Slider (mass m1) at (u, a u&sup2;) from the vertex, bob (m2) at slider + r (sin &theta;,
&minus;cos &theta;). With q = 2 a u, M = m1 + m2 and g the downward gravity the kinetic and
potential energies of the parabola at rest are</p>
<pre>
T = &frac12; M (1 + q&sup2;) u'&sup2; + &frac12; m2 r&sup2; &theta;'&sup2; + m2 r u' &theta;' (cos &theta; + q sin &theta;)
V = M g a u&sup2; &minus; m2 g r cos &theta;
</pre>
<p><b>nonlinear</b> keeps all of it. With the vertex accelerations X, Y, w = cos &theta; + q sin &theta;,
k = sin &theta; &minus; q cos &theta; and G = g + Y + 2 a u'&sup2; + a'' u&sup2; + 4 a' u u' the equations of
motion are solved without cancellation at any mass ratio:</p>
<pre>
D   = m1 (1 + q&sup2;) + m2 k&sup2;
u'' = (&minus;m1 (X + q G) + m2 k (G cos &theta; &minus; X sin &theta; + r &theta;'&sup2;) + Q<sub>u</sub> &minus; w Q<sub>&theta;</sub>/r) / D
&theta;'' = (&minus;k (M (G &minus; q X) + w m2 r &theta;'&sup2;) + M (1 + q&sup2;) Q<sub>&theta;</sub>/(m2 r) &minus; w Q<sub>u</sub>) / (r D)
</pre>
<p><b>linear</b> keeps the quadratic part about u = &theta; = 0 and draws the masses at their exact
positions. model.acceleration_error tells while running when that stops being enough. With constant
coefficient the method <b>exact</b> solves it at any communication step.</p>
<h2>What accuracy costs</h2>
<p>Microseconds of CPU time per simulated second to reach the given error of the state after 10 s from
the default start, one communication step, kernel compiled (<code>curvebound bench --only accuracy</code>,
7 rounds, one core of a shared Intel Xeon): the ratios carry over to other machines, the times do not.
A dash: not reached with any step that was tried.</p>
<p>nonlinear:</p>
<table><tr><th>method<th>1e-4<th>1e-6<th>1e-8<th>1e-10<th>1e-12</tr>
<tr><td>semi_implicit_euler<td class="n">509<td class="n">&ndash;<td class="n">&ndash;<td class="n">&ndash;<td class="n">&ndash;</tr>
<tr><td>rk4<td class="n">5.0<td class="n">14.9<td class="n">46.6<td class="n">146<td class="n">459</tr>
<tr><td>adaptive<td class="n">4.3<td class="n">4.5<td class="n">6.0<td class="n">7.1<td class="n">10.2</tr>
<tr><td>implicit<td class="n">15.4<td class="n">38.1<td class="n">125<td class="n">269<td class="n">&ndash;</tr>
</table>
<p>What that teaches: few communication steps save more than any method does; rk4 is the cheapest to
errors of 1e-6, adaptive from there on and for motions started high. From u = angle = 0.5 the linear
model is off by 0.5 rad within 10 s, however exactly it is solved
(<code>curvebound study pendulum_small pendulum_large --quick</code>).</p>
<p>linear: exact has no error at any communication step (below 5e-15 after 10 s).</p>
<h2>Where the methods break</h2>
<p>Largest accurate step (solid: relative error of u and angle below 1e-3) and largest stable step
(dashed: the energy is wrong by less than ten times what is at stake) over one parameter at a time,
from the default start, runs of 10 s or as long as the parameter asks for, boundaries by bisection to
2 % between 5e-6 and 0.1 of the run (<code>curvebound stability --all --documentation fmus</code>).
A line at the rim lies beyond it. Above the dashed lines the step fails with a message, or
energy.residual tells.</p>
<p><img src="stability.svg" alt="largest accurate and stable steps over the parameters"></p>
<p>Linear theory at rest tells the largest stable step of rk4 within a tenth at the defaults (0.49 s), but
amplitude matters: with m2/m1 = 1e5 it is 0.4 instead of 2 ms, with a = 100 1/m 1.4 instead of 45 ms.
implicit cuts its own steps there: from m2/m1 = 100 and a = 100 1/m on it stays stable with every step that
was tried, if not accurate. Strong damping ends the explicit methods where theory says (rk4: 2.79 over its
rate) and does not touch implicit. <b>adaptive</b> at solver.tolerance = 1e-7 is accurate at every point of
these maps, mass ratio 1e8 and coefficient 1e4 included: it is the method for the extremes.</p>
<h2>How to couple it</h2>
<p>Connect ParabolaDrive: its outputs parabola.ax, parabola.ay and parabola.coefficient_acceleration
to the inputs of the same name, and slider.u, slider.u_rate, pendulum.angle,
pendulum.angular_velocity, parabola.x, parabola.vx back. None of these outputs depends on an input
of the same instant, so the loop has no algebraic part; the forces and model.acceleration_error do
(declared in ModelStructure).</p>
""",
)
