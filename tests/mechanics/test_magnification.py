"""What derived kernels know of how errors grow, so that `adaptive` keeps its tolerance."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from kernel_module import kernel_module

from curvebound.fmi.folder import Folder
from curvebound.mechanics.derive import derive_text

HERE = Path(__file__).parent
FOLDERS = {
    path.name: path
    for path in [*(HERE / "systems").iterdir(), *(HERE.parents[1] / "fmus").iterdir()]
}
CYCLOID = """
from sympy import cos, sin
from curvebound.mechanics import Mechanics, angle, mass, parameter
r, th = parameter("cycloid.radius"), angle("bead.angle")
MECHANICS = Mechanics([th], [mass("bead", r * (th + sin(th)), r * (1 - cos(th)))])
"""

ROD = """
from sympy import cos, sin
from curvebound.mechanics import Mechanics, angle, length, mass
r, th = length("bead.distance"), angle("rod.angle")
MECHANICS = Mechanics([th, r], [mass("bead", r * cos(th), r * sin(th))])
"""
TEXTS = {"cycloid": CYCLOID, "rod": ROD}


def started(name: str, choices: dict[str, int] | None = None, **values: float) -> Any:
    if name in TEXTS:
        derived = derive_text(TEXTS[name], name, name)
    else:
        derived = Folder(FOLDERS[name]).derived()
    given = {n.replace("__", "."): x for n, x in values.items()}
    model = kernel_module(derived).model(choices or {})
    start = {n: 1.0 if n.endswith((".mass", ".length", ".radius")) else 0.0 for n in
             model.PARAMETERS}  # fmt: skip
    model.start({**start, "gravity.y": -9.81, **given}, choices or {})
    model.set_inputs([given.get(n, 0.0) for n in model.INPUTS], 0)
    return model


def test_what_comes_down_from_high_is_magnified_by_the_slope() -> None:
    steep = started("bead_on_parabola", wire__coefficient=120.0, bead__u_start=22.6)
    assert steep.magnification == pytest.approx(2 * 120.0 * 22.6, rel=1e-3)
    flat = started("bead_on_parabola", wire__coefficient=0.0, bead__u_start=22.6)
    assert flat.magnification == 1.0
    # what its speed carries up comes down again
    fast = started("bead_on_parabola", wire__coefficient=0.5, bead__u_rate_start=100.0)
    assert fast.magnification > 10.0


@pytest.mark.parametrize(
    ("name", "pivot", "bob", "angle"),
    [
        ("parabola_pendulum", "slider", "pendulum", "pendulum.angle"),
        pytest.param("pendulum_on_sine", "pivot", "bob", "rod.angle", marks=pytest.mark.slow),
    ],
)
def test_a_light_pivot_is_thrown_about(name: str, pivot: str, bob: str, angle: str) -> None:
    choices = {"model.fidelity": 2}
    light = started(name, choices, **{f"{pivot}.mass": 1e-8, f"{angle}_start": 0.3})
    assert light.magnification == pytest.approx(1e8, rel=0.01)
    assert started(name, choices, **{f"{bob}.mass": 1e-8}).magnification < 1.01


def test_sizes_of_coordinates() -> None:
    """A length's: how far until its slope has turned; along a straight rod its distance."""
    bent = started("bead_on_parabola", wire__coefficient=2.0, bead__u_start=0.7)
    assert bent.q0_scale == pytest.approx(math.hypot(1.0, 2.8) / 4.0)
    assert started("bead_on_parabola", bead__u_start=0.7).q0_scale == 1.0
    rod = started("rod", bead__distance_start=2.5)
    assert (rod.q0_scale, rod.q1_scale) == pytest.approx((1.0, 2.5))
    assert started("rod").q1_scale == 1.0


def test_a_cusp_counts_where_energy_or_inputs_reach_it() -> None:
    assert started("cycloid", bead__angle_start=1.5).magnification < 10.0
    assert started("cycloid", bead__angular_velocity_start=5.0).magnification > 1e12
    assert started("cycloid", bead__fy=12.0, bead__angle_start=0.1).magnification > 1e12


def test_it_is_part_of_the_saved_state() -> None:
    steep = started("bead_on_parabola", wire__coefficient=120.0, bead__u_start=22.6)
    other = started("bead_on_parabola", wire__coefficient=120.0, bead__u_start=1.0)
    other.set_state(steep.get_state())
    assert other.magnification == steep.magnification
    steep.keep()
    steep.magnification = 1.0
    steep.undo()
    assert steep.magnification == other.magnification


def test_small_motion_and_cartesian_form_have_none() -> None:
    model = started(
        "bead_on_ellipse",
        {"model.formulation": 1, "constraint.stabilization": 3},
        wire__width=2.0,
        wire__height=1.0,
        bead__angle_start=1.0,
    )
    assert model.magnification == 1.0
