"""What a statement refuses, and how; and what is said of a mechanics.py that fails."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
import sympy
from sympy import Symbol, cos, sin

import curvebound.mechanics
from curvebound.errors import CurveboundError
from curvebound.mechanics import (
    Constraint,
    Mechanics,
    angle,
    drag,
    input_,
    length,
    mass,
    parameter,
    shape,
)
from curvebound.mechanics.derived import Derived
from curvebound.mechanics.deriving import derived_from
from curvebound.mechanics.numeric import double

U, TH = length("bead.u"), angle("rod.angle")
K = parameter("spring.stiffness")
A = shape("wire.bend")
BEAD = mass("bead", U, K * U**2)
BOB = mass("bob", U + sin(TH), -cos(TH))
T = Symbol("t")


def test_no_name_stands_for_two_things() -> None:
    x = length("cart.x")
    with pytest.raises(ValueError, match=r"cart\.x would stand for two things.*cart\.u"):
        Mechanics([x], [mass("cart", x, 0)])
    u = length("cart.u")
    with pytest.raises(ValueError, match=r"cart\.x would"):
        Mechanics([u], [mass("cart", u, 0), mass("cart", u, 1)])
    with pytest.raises(ValueError, match=r"rail\.y would"):
        Mechanics([u], [mass("cart", u, parameter("rail.y"))], frame="rail")
    with pytest.raises(ValueError, match=r"field\.x would"):
        Mechanics([field := length("field.x")], [mass("cart", field, 0)])
    assert "cart.u" in Mechanics([u], [mass("cart", u, parameter("cart.rise"))]).outputs


def stated(**more: Any) -> Callable[[], Mechanics]:
    return lambda: Mechanics(**{"coordinates": [U], "masses": [BEAD], **more})


def held(**more: Any) -> Callable[[], Mechanics]:
    """The bead held on its curve by a multiplier."""
    on = Constraint(lambda x, y: y - K * x**2, coordinate=lambda x, y: x)
    return stated(constraint=on, **more)


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        # keys that belong to nothing
        (stated(couples={"bead.u": 1}), "'bead.u' in couples is no coordinate.*coordinates are be"),
        (stated(couples={parameter("bead.u"): 1}), "bead.u in couples is no coordinate"),
        (stated(couples={TH: 1}), "rod.angle in couples is no coordinate"),
        (stated(linear_about={TH: 0}), "rod.angle in linear_about is no coordinate"),
        (stated(forces={"bead": (1, 0)}), "'bead' in forces is no mass.*which are mass bead"),
        (stated(forces={BOB: (1, 0)}), "mass bob in forces is no mass"),
        (stated(damping=[drag("bob.d", BOB)]), "mass bob in drag bob.d is no mass"),
        (stated(damping=[drag("bob.d", "bead")]), "'bead' in drag bob.d is no mass"),
        (stated(damping=[drag("rod.d", TH)]), "drag rod.d is of rod.angle, which is no coord"),
        # lists, dictionaries, components
        (stated(coordinates=U), r"coordinates=bead.u is no list: give a list, coordinates=\["),
        (stated(masses=BEAD), r"masses=mass bead is no list: give a list, masses=\["),
        (stated(damping=drag("bead.d", U)), "damping=drag bead.d is no list: give a list"),
        (stated(coordinates=["bead.u"]), r"'bead.u' in coordinates is no coordinate: .*length\("),
        (stated(masses=[U]), r"bead.u in masses is no mass: make it with mass\("),
        (stated(couples=[1]), r"couples=\[1\] is no dictionary"),
        (stated(coordinates=[]), r"coordinates=\[\] are 0: state one or two"),
        (stated(coordinates=[U, U]), "coordinate bead.u is listed twice in coor"),
        (stated(forces={BEAD: (1, 0, 0)}), "force on mass bead has 3 components, 1, 0, 0: .* plan"),
        (stated(forces={BEAD: K}), "force spring.stiffness on mass bead has no two components"),
        (lambda: mass("bead", U, 0, 0), "position of mass bead has 3 components.*planar.*x and y"),
        # symbols and values
        (stated(masses=[mass("bead", U, sin(T))]), r"t in the position y of mass bead, sin\(t\), "
         "is no symbol of this system: make it a parameter"),
        (stated(masses=[mass("bead", U, BEAD.mass * U.rate)]), "u_rate in the pos.* is a rate"),
        (stated(masses=[mass("bead", U, A + A.rate)]), "wire.bend_rate in the position y.*a rate"),
        (stated(masses=[mass("bead", U, input_("lift"))]), "lift in the position y.*an input"),
        (stated(masses=[mass("bead", U, [U])]), r"position y of mass bead is \[bead.u\]: give one"),
        (stated(masses=[mass("bead", U, sympy.sqrt(-1))]), "position y of mass bead is I: give"),
        (stated(masses=[mass("bead", U, 1 / sympy.S(0))]), "position y of mass bead is zoo: give"),
        (stated(couples={U: sin(T)}), r"t in the couple on bead.u, sin\(t\), .*make it an input_"),
        (stated(couples={U: TH.rate}), "rod.angular_velocity in the couple.*rate of no coordinate"),
        (stated(couples={U: BEAD.reaction[0]}), "bead.reaction.x in the couple.*is a reaction"),
        (stated(forces={BEAD: (0, sin(T))}), "t in the force y on mass bead.*make it an input_"),
        (stated(observed={"bead.seen": T}), "t in observed bead.seen, t, .*make it an input_"),
        (stated(potential=K * T), "t in the potential, .*is no symbol of this system"),
        (stated(potential=K * U.rate**2), "bead.u_rate in the potential.*is a rate.*use couples"),
        (stated(potential=U * input_("pull")), "pull in the potential.*is an input.*use couples"),
        (stated(masses=[mass("bead", U, sympy.gamma(U))]), r"gamma\(bead.u\) in the position y"),
        (stated(potential=sympy.Max(U, 0)), r"Max\(0, bead.u\) in the pot.* has no.*use powers"),
        (stated(couples={U: sympy.Integral(K, (K, 0, U))}), "Integral.* in the couple on bead.u"),
        (stated(constraint=1), r"constraint=1 is none: make it with Constraint\("),
        # what the Cartesian form does not have
        (held(couples={U: K}), "the couple on bead.u, spring.stiffness, has no part in the Cartes"),
        (held(damping=[drag("bead.d", U)]), "drag bead.d of bead.u has no part.*leave the constr"),
        (held(potential=K * U), r"the potential, .*bead.u\*spring.stiff.*, has no part"),
        (held(forces={BEAD: (0, K * U)}), "the force y on mass bead, .*, has no part"),
        (held(forces={BEAD: (U.rate, 0)}), "the force x on mass bead, bead.u_rate, has no part"),
        (held(masses=[mass("bead", U, A * U)]), "shape wire.bend has no part"),
        (held(linear_about={U: 0}), "linear_about has no part"),
        (held(coordinates=[TH], masses=[mass("bob", sin(TH), -cos(TH))], observed={"seen": K * TH}),
         r"observed seen, .*rod.angle\*.*, which counts turns, has no part"),
        # inertia
        (stated(masses=[mass("bead", K, 1)]), "coordinate bead.u moves no mass"),
        (stated(masses=[mass("bead", (U + K) * (U - K) - U**2, 1)]), "bead.u moves no mass"),
        (stated(coordinates=[U, TH]), "coordinate rod.angle moves no mass"),
        (stated(coordinates=[U, TH], masses=[mass("bead", U + TH, sin(U + TH))]),
         "move with a combination of bead.u and rod.angle only"),
        # names
        *((stated(coordinates=[c], masses=[mass("bead", c, 0)]), f"coordinate '{c}' is no name")
          for c in map(length, ("bead-u", "1u", "a b", "a..u", "é", ""))),
        (stated(masses=[mass("the bead", U, 0)]), "mass 'the bead' is no name"),
        (stated(masses=[mass("bead", U, parameter("1a"))]), "parameter '1a' is no name"),
        (stated(masses=[mass("bead", U, shape("a-b"))]), "shape 'a-b' is no name"),
        (stated(couples={U: input_("a b")}), "input 'a b' is no name of a variable: use letters"),
        (stated(observed={"a b": U}), "observed 'a b' is no name"),
        (stated(frame="my wire"), "frame 'my wire' is no name"),
        (stated(damping=[drag("d!", U)]), "damping 'd!' is no name"),
    ],
)  # fmt: skip
def test_it_refuses(statement: Callable[[], Mechanics], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        statement()


def test_a_constraint_takes_forces_of_inputs_and_drag_on_the_mass() -> None:
    made = held(
        forces={BEAD: (input_("push"), -K)}, damping=[drag("bead.d", BEAD)], couples={U: 0},
        observed={"bead.bend": K * U},
    )()  # fmt: skip
    assert {"push", "bead.fx"} <= set(made.inputs)
    assert "constraint.drift" in made.outputs


def test_it_takes_what_belongs_to_it() -> None:
    made = Mechanics(
        coordinates=(U, TH),
        masses=[BEAD, mass("bob", U + A * sin(TH), -A * cos(TH))],
        damping=[drag("bead.d", BEAD), drag("rod.d", TH)],
        couples={TH: input_("motor.torque") - K * TH.rate * A.rate},
        forces={BEAD: (input_("push"), -K * U.rate)},
        potential=K * A * U**2,
        observed={"bead.held": BEAD.reaction[1] + TH.rate},
    )
    assert {"motor.torque", "push", "wire.bend_acceleration"} <= set(made.inputs)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("u = ", "line 2: SyntaxError: invalid syntax"),
        ("u = lenght('u')", "line 2: NameError: name 'lenght' is not defined: define it"),
        ("u = angle('u')", "'angle' is not defined: import it, from curvebound.mechanics import"),
        ("sin(1)", "'sin' is not defined: import it, from sympy import sin"),
        ("import math; math.sin(length('u'))", "line 2: TypeError.*import them from sympy"),
        ("import numpy; numpy.sin(length('u'))", "line 2: TypeError.*import them from sympy"),
        ("mass('bead', 1, 2, 3)", "line 2: the position of mass bead has 3 components"),
        ("length(1)", "line 2: TypeError: name should be a string"),
    ],
)
def test_a_fault_in_mechanics_py_is_named_with_its_line(line: str, message: str) -> None:
    text = f"from curvebound.mechanics import length, mass\n{line}\n"
    with pytest.raises(CurveboundError, match=rf"my/mechanics\.py, {message}|{message}") as raised:
        derived_from(text, "My", "my/mechanics.py")
    assert str(raised.value).startswith("my/mechanics.py, line 2: ")


def test_help_lists_the_words() -> None:
    text = curvebound.mechanics.__doc__ or ""
    for word in (*curvebound.mechanics.__all__, *Mechanics.__dataclass_fields__):
        assert word in text, word
        assert word not in curvebound.mechanics.__all__ or word in dir(curvebound.mechanics)


@pytest.mark.parametrize("frame", ["cart", ""])
def test_symbols_at_a_time_after_the_start(frame: str) -> None:
    """Frame and shapes move by polynomials; coordinates and rates are those of the start."""
    named: Any = SimpleNamespace(
        variables=[SimpleNamespace(name="bob.fx", kind="input")], frame=frame, shapes=["bend"],
        coordinates=["u"], rates=["u_rate"],
    )  # fmt: skip
    values = {
        "gravity.x": 1.0, "gravity.y": -9.0, "cart.ax": 2.0, "cart.ay": 4.0, "bend_start": 5.0,
        "bend_rate_start": 6.0, "bend_acceleration": 8.0, "u_start": 0.25, "u_rate_start": 0.75,
    }  # fmt: skip
    found = Derived.at(named, double, values, 3.0)
    assert {name: found[name] for name in ("bob.fx", "u", "u_rate", "bend", "bend_rate")} == {
        "bob.fx": 0, "u": 0.25, "u_rate": 0.75, "bend": 5.0 + 18.0 + 36.0, "bend_rate": 30.0
    }  # fmt: skip
    moves = [found[f"frame.{name}"] for name in ("x", "y", "vx", "vy", "ax", "ay")]
    assert moves == ([9.0, 18.0, 6.0, 12.0, 2.0, 4.0] if frame else [0] * 6)
    field = [found["field.x"], found["field.y"]]
    assert field == ([-1.0, -13.0] if frame else [1.0, -9.0])
