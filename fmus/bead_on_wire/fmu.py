"""BeadOnWire: a bead on a circular wire in a vertical plane, held by a Lagrange multiplier.

The wire's centre can be accelerated, forces can be applied to the bead, viscous damping acts on the
motion relative to the wire.
"""

from curvebound.fmi.common import ENERGY, GRAVITY, SOLVER
from curvebound.fmi.declaration import Enumeration, Fmu, choice, input_, output, parameter
from curvebound.fmi.plant import Plant
from curvebound.models.bead_on_wire import bead_on_wire

FORMULATION = Enumeration(
    "Formulation",
    "coordinates in which the equations of motion are integrated",
    (
        ("lagrange_multiplier", "Cartesian position and velocity with a Lagrange multiplier"),
        ("angle", "the angle as minimal coordinate"),
    ),
)

STABILIZATION = Enumeration(
    "Stabilization",
    "what keeps the Cartesian position on the wire",
    (
        ("none", "nothing: the constraint holds on acceleration level only and drifts"),
        ("baumgarte", "feedback of the drift and its rate (Baumgarte 1972)"),
        ("projection", "projection of position and velocity after each internal step"),
    ),
)

FMU = Fmu(
    name="BeadOnWire",
    description="Bead on a circular wire in a vertical plane, with viscous damping",
    system=Plant(bead_on_wire),
    variables=(
        *GRAVITY,
        parameter("wire.radius", "m", 1.0, "radius of the wire (above zero)", above=0.0),
        parameter("bead.mass", "kg", 1.0, "mass of the bead (above zero)", above=0.0),
        parameter("bead.damping", "N.s/m", 0.0, "viscous damping of the bead", at_least=0.0),
        parameter(
            "bead.angle_start",
            "rad",
            1.5707963267948966,
            "initial angle from the downward vertical, counter-clockwise",
        ),
        parameter("bead.angular_velocity_start", "rad/s", 0.0, "initial angular velocity"),
        parameter(
            "constraint.stiffness",
            "1/s2",
            100.0,
            "Baumgarte feedback of the constraint C = (p.p - r^2)/2",
            at_least=0.0,
            nominal=100.0,
        ),
        parameter(
            "constraint.damping",
            "1/s",
            20.0,
            "Baumgarte feedback of the rate of the constraint",
            at_least=0.0,
            nominal=10.0,
        ),
        choice(
            "model.formulation",
            FORMULATION,
            "lagrange_multiplier",
            "coordinates of the equations of motion",
        ),
        choice(
            "constraint.stabilization",
            STABILIZATION,
            "projection",
            "stabilisation of the constraint, for lagrange_multiplier",
        ),
        *SOLVER,
        input_("wire.ax", "m/s2", "acceleration of the wire's centre to the right", nominal=10.0),
        input_("wire.ay", "m/s2", "acceleration of the wire's centre upward", nominal=10.0),
        input_("bead.fx", "N", "external force on the bead to the right", nominal=10.0),
        input_("bead.fy", "N", "external force on the bead upward", nominal=10.0),
        output("bead.x", "m", "position of the bead, to the right, world frame"),
        output("bead.y", "m", "position of the bead, upward, world frame"),
        output("bead.vx", "m/s", "velocity of the bead to the right, world frame"),
        output("bead.vy", "m/s", "velocity of the bead upward, world frame"),
        output("bead.angle", "rad", "angle from the downward vertical, continuous"),
        output("bead.angular_velocity", "rad/s", "rate of the angle"),
        output("wire.x", "m", "position of the wire's centre to the right"),
        output("wire.y", "m", "position of the wire's centre upward"),
        output("wire.vx", "m/s", "velocity of the wire's centre to the right"),
        output("wire.vy", "m/s", "velocity of the wire's centre upward"),
        output(
            "constraint.drift",
            "m",
            "distance of the bead from the wire's centre, minus the radius",
            nominal=1e-6,
        ),
        *ENERGY,
        output("wire.fx", "N", "force of the bead on the wire to the right, damping included"),
        output("wire.fy", "N", "force of the bead on the wire upward, damping included"),
        output("constraint.multiplier", "N/m", "multiplier lambda: constraint force = lambda p"),
        output("constraint.force", "N", "lambda times the radius, positive outward"),
    ),
    reference_inputs={"wire.ax": (1.0, 0.5), "wire.ay": (2.0, 1.5)},
    plotted=("bead.angle", "constraint.force", "energy.total", "energy.residual"),
    documentation="""
<h2>Equations</h2>
<p>p is the position from the wire's centre, v its rate, m the mass, r the radius, d the damping,
g gravity, f the external force, a the acceleration of the centre, &lambda; the multiplier.</p>
<pre>
m p'' = m (g &minus; a) + f &minus; d v + &lambda; p,      C = (p&middot;p &minus; r&sup2;)/2 = 0
&lambda;    = &minus;( p&middot;(m (g &minus; a) + f &minus; d v) + m v&middot;v + m (D C' + S C) ) / (p&middot;p)
</pre>
<p><b>lagrange_multiplier</b> integrates p and v in this form. The constraint then holds on
acceleration level only and drifts, unless it is stabilised: <b>baumgarte</b> feeds the drift back
(D = constraint.damping, S = constraint.stiffness, both zero otherwise), <b>projection</b> moves p
and v back onto the wire after each internal step. <b>angle</b> integrates the angle &theta;
instead, p = r (sin &theta;, &minus;cos &theta;), and cannot drift:</p>
<pre>m r &theta;'' = (m (g &minus; a) + f)&middot;(cos &theta;, sin &theta;) &minus; d r &theta;'</pre>
<h2>What accuracy costs</h2>
<p>Microseconds of CPU time per simulated second to reach the given error of the state after 10 s from
the default start, one communication step, kernel compiled (<code>curvebound bench --only accuracy</code>,
7 rounds, one core of a shared Intel Xeon): the ratios carry over to other machines, the times do not.
A dash: not reached with any step that was tried.</p>
<p>angle:</p>
<table><tr><th>method<th>1e-4<th>1e-6<th>1e-8<th>1e-10<th>1e-12</tr>
<tr><td>semi_implicit_euler<td class="n">3270<td class="n">&ndash;<td class="n">&ndash;<td class="n">&ndash;<td class="n">&ndash;</tr>
<tr><td>rk4<td class="n">2.1<td class="n">7.5<td class="n">28<td class="n">85.2<td class="n">&ndash;</tr>
<tr><td>adaptive<td class="n">2.5<td class="n">2.2<td class="n">2.8<td class="n">4.6<td class="n">5.4</tr>
<tr><td>implicit<td class="n">7.8<td class="n">17.6<td class="n">58.7<td class="n">151<td class="n">239</tr>
</table>
<p>lagrange_multiplier with projection:</p>
<table><tr><th>method<th>1e-4<th>1e-6<th>1e-8<th>1e-10<th>1e-12</tr>
<tr><td>rk4<td class="n">4.3<td class="n">11.7<td class="n">42.4<td class="n">136<td class="n">466</tr>
<tr><td>adaptive<td class="n">3.3<td class="n">3.3<td class="n">4.0<td class="n">4.9<td class="n">5.8</tr>
<tr><td>implicit<td class="n">8.4<td class="n">13.7<td class="n">46.7<td class="n">153<td class="n">358</tr>
</table>
<p>What that teaches: few communication steps save more than any method does. At the same step of rk4
projection has 7 times the error of the angle, baumgarte 160 times and no stabilisation 700 times. rk4 is
the cheapest to errors of 1e-6, adaptive from there on, with which 1e-10 costs hardly more than 1e-2
(<code>curvebound study bead_on_wire --quick</code>).</p>
<p>Without stabilisation the drift grows as (step)<sup>4</sup> (time)<sup>2</sup>, inward, until the bead
falls into the centre: with rk4 at 1/60 s within minutes.</p>
<h2>Where the methods break</h2>
<p>Largest accurate step (solid: relative error of the bead's position below 1e-3) and largest stable step
(dashed: the energy is wrong by less than ten times what is at stake) over one parameter at a time,
from the horizontal, Cartesian with projection, runs of 10 s or as long as the parameter asks for, boundaries by bisection to
2 % between 5e-6 and 0.1 of the run (<code>curvebound stability --all --documentation fmus</code>).
A line at the rim lies beyond it. Above the dashed lines the step fails with a message, or
energy.residual tells.</p>
<p><img src="stability.svg" alt="largest accurate and stable steps over the parameters"></p>
<p>At rest linear theory bounds the step of rk4 by 2.83 sqrt(r/g), and of a strongly damped bead by
2.79 m/d; from the horizontal it is stable to half of the first and to all of the second, and accurate
to a twentieth of the first. semi_implicit_euler is symplectic in the angle only. implicit is
stable with every step that was tried, and damping does not shorten its accurate one. <b>adaptive</b> at solver.tolerance = 1e-6 is
accurate at every point of these maps but a start at 1000 rad/s over 10 s, which wants 1e-9.</p>
<h2>How to couple it</h2>
<p>Positions, velocities and energies do not depend on the inputs of the same instant; wire.fx,
wire.fy, constraint.multiplier and constraint.force do (direct feedthrough, declared in
ModelStructure). Drive the wire by accelerations: the FMU integrates the motion of the centre
itself, exactly. energy.residual is zero for the exact solution: watch it to see the integration
error while running.</p>
""",
)
