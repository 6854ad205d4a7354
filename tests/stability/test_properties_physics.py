"""Laws that every output obeys: energy, constraint, Newton's law for the whole."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st
from properties import FMUS, counts, holds, rate, run, run_or_none, sampled

from curvebound.fmi.folder import find
from curvebound.kernel.base import acceleration_of

bead_on_wire = find("BeadOnWire").module("kernel").model
parabola_pendulum = find("ParabolaPendulum").module("kernel").model

EPSILON = float(np.finfo(float).eps)


def small_steps(system: str, values: Any, method: str) -> tuple[Any, float]:
    """A communication step, and what resolves the fastest motion at the start.

    And what damping does, which `adaptive` sees to itself.
    """
    fastest = rate(system, values)
    if method != "adaptive":
        fastest = max(fastest, damping_rate(system, values))
    step = 0.1 / fastest
    return {
        **values,
        "solver.method": method,
        "solver.step": 0.02 * step,
        "solver.tolerance": 1e-9,
        "solver.max_steps": 20_000,
    }, step


def damping_rate(system: str, values: Any) -> float:
    """At least the fastest rate (1/s) at which damping slows anything."""
    if system == "bead":
        return values["bead.damping"] / values["bead.mass"]
    slider = 1.0 / values["slider.mass"] + 1.0 / values["pendulum.mass"]
    turning = values["pendulum.damping"] / values["pendulum.length"] ** 2
    return (values["slider.damping"] + turning) * slider


def size_of(*columns: np.ndarray) -> float:
    return float(sum(np.abs(c).max() for c in columns))


@counts(8, 300)
@pytest.mark.parametrize("system", FMUS)
@pytest.mark.parametrize("method", ["adaptive", "implicit"])
def test_energy_balance(system: str, method: str, count: int) -> None:
    """What the residual is judged by is all that moves: energies, and the work between them."""
    failures = []

    def check(values: Any) -> None:
        values, step = small_steps(system, values, method)
        found = run_or_none(system, values, step, 5)
        if found is None:
            failures.append(values)
            return
        potential = found["energy.potential"]
        moved = size_of(found["energy.kinetic"], potential - potential[0])
        # the work of drive and inputs is what the total energy has changed by
        moved += size_of(found["energy.total"] - found["energy.total"][0])
        rounding = 1e3 * EPSILON * size_of(found["energy.total"], potential)
        # `implicit` has the step that resolves the start; damping that dies out at once neither
        # of the two resolves
        damped = any(values[k] for k in values if k.endswith(".damping"))
        allowed = {"adaptive": (1e-6, 1e-5), "implicit": (1e-4, 1e-2)}[method][damped]
        assert np.abs(found["energy.residual"]).max() <= allowed * moved + rounding

    holds(count, check, sampled(system))
    # `implicit` may refuse a violent motion; `adaptive` has no reason to
    assert len(failures) <= (0 if method == "adaptive" else 0.1 * count)


@pytest.mark.parametrize("stabilization", ["none", "baumgarte", "projection"])
@pytest.mark.parametrize("push", [0.0, 1.0])
def test_heavy_damping_leads_implicit_to_no_other_solution(stabilization: str, push: float) -> None:
    """Its stages have one in which the bead gains energy: from a guess at damping's speed."""
    found = run(
        "bead",
        {
            "gravity.x": -1.0,
            "gravity.y": 0.0,
            "bead.mass": 2.26e-6,
            "bead.damping": 1.0,
            "bead.angle_start": 0.0,
            "bead.angular_velocity_start": -1.0,
            "wire.ax": push,
            "constraint.stabilization": stabilization,
            "solver.method": "implicit",
            "solver.step": 2e-3,
        },
        0.1,
        5,
    )
    assert found["energy.kinetic"].max() <= found["energy.kinetic"][0]
    assert np.abs(found["energy.residual"]).max() < 1e-6 * found["energy.kinetic"][0]
    assert found["solver.steps"][-1] == 250


@counts(8, 300)
def test_constraint_of_the_wire(count: int) -> None:
    def check(values: Any, method: str) -> None:
        values, step = small_steps("bead", values, method)
        found = run_or_none("bead", values, step, 5)
        if found is None:
            return
        r = values["wire.radius"]
        x = found["bead.x"] - found["wire.x"]
        y = found["bead.y"] - found["wire.y"]
        exact = (
            values["model.formulation"] == "angle"
            or values["constraint.stabilization"] == "projection"
        )
        rounding = 16 * EPSILON * size_of(found["wire.x"], found["wire.y"])
        assert np.abs(np.hypot(x, y) - r).max() <= (1e-14 if exact else 1e-6) * r + rounding
        assert np.abs(found["constraint.drift"]).max() <= (1e-14 if exact else 1e-6) * r
        angle = found["bead.angle"]
        assert np.abs(x - r * np.sin(angle)).max() <= 1e-6 * r + rounding
        assert np.abs(y + r * np.cos(angle)).max() <= 1e-6 * r + rounding

    some = st.sampled_from(["rk4", "implicit", "adaptive"])
    holds(count, check, sampled("bead"), some, refused=0.2)


@counts(8, 300)
def test_constraints_of_the_pendulum(count: int) -> None:
    """The slider is on the parabola and the bob at the rod's end, whatever the method's error."""

    def check(values: Any, method: str) -> None:
        values, step = small_steps("pendulum", values, method)
        found = run_or_none("pendulum", values, step, 5)
        if found is None:
            return
        f = {name: found[name] for name in found}
        u = f["slider.u"]
        x, y = f["slider.x"] - f["parabola.x"], f["slider.y"] - f["parabola.y"]
        rounding = 16 * EPSILON * size_of(f["slider.x"], f["slider.y"], f["parabola.y"])
        rounding += 16 * EPSILON * size_of(f["parabola.x"])
        assert np.abs(x - u).max() <= rounding
        assert np.abs(y - f["parabola.coefficient"] * u * u).max() <= rounding
        r = values["pendulum.length"]
        dx, dy = f["pendulum.x"] - f["slider.x"], f["pendulum.y"] - f["slider.y"]
        rounding += 16 * EPSILON * size_of(f["pendulum.x"], f["pendulum.y"])
        assert np.abs(np.hypot(dx, dy) - r).max() <= 1e-14 * r + rounding
        turn = f["pendulum.angular_velocity"]
        vx = f["pendulum.vx"] - f["slider.vx"]
        vy = f["pendulum.vy"] - f["slider.vy"]
        rounding = (
            64 * EPSILON * size_of(*(f[f"{p}.v{c}"] for p in ("slider", "pendulum") for c in "xy"))
        )
        # the rod is rigid: the bob moves about the slider at r th', across the rod
        assert np.abs(np.hypot(vx, vy) - r * np.abs(turn)).max() <= rounding + 1e-13 * size_of(
            r * turn
        )

    some = st.sampled_from(["rk4", "implicit", "adaptive"])
    holds(count, check, sampled("pendulum"), some, refused=0.1)


def started(system: str, values: Any) -> Any:
    """The kernel's model at its start, with its inputs."""
    items = {
        "model.formulation": ("lagrange_multiplier", "angle"),
        "constraint.stabilization": ("none", "baumgarte", "projection"),
        "model.fidelity": ("linear", "nonlinear"),
    }
    choices = {k: items[k].index(v) + 1 for k, v in values.items() if isinstance(v, str)}
    real = {k: v for k, v in values.items() if not isinstance(v, str)}
    real |= {"constraint.stiffness": 100.0, "constraint.damping": 20.0} if system == "bead" else {}
    model = (bead_on_wire if system == "bead" else parabola_pendulum)(choices)
    model.start(real, choices)
    model.set_inputs([real[name] for name in model.INPUTS], 0)
    return model


def outputs(model: Any) -> dict[str, float]:
    values = [0.0] * len(model.OUTPUTS)
    for group in set(model.OUTPUTS.values()):
        model.observe(group, values, 0)
    return dict(zip(model.OUTPUTS, values, strict=True))


@counts(25, 1000)
def test_newtons_law_of_the_bead(count: int) -> None:
    """Mass times acceleration in the world is gravity, inputs and the wire's force."""

    def check(values: Any) -> None:
        model = started("bead", values)
        out = outputs(model)
        a = acceleration_of(model, 0.0, model.q0, model.q1, model.v0, model.v1)
        m, r = values["bead.mass"], values["wire.radius"]
        if values["model.formulation"] == "angle":
            c, s = np.cos(model.q0), np.sin(model.q0)
            spin = model.v0 * model.v0
            a = r * (a[0] * c - spin * s), r * (a[0] * s + spin * c)
        for axis, acceleration in zip("xy", a, strict=True):
            terms = [
                m * (acceleration + values[f"wire.a{axis}"]),
                -m * values[f"gravity.{axis}"],
                -values[f"bead.f{axis}"],
                out[f"wire.f{axis}"],
            ]
            # parts that may cancel: of the acceleration, the wire's; of its force, what it
            # carries, and the drag
            parts = [
                *(m * values["wire.ax"], m * values["wire.ay"], out["constraint.force"]),
                *(values["bead.damping"] * out[f"bead.v{c}"] for c in "xy"),
            ]
            assert abs(sum(terms)) <= 64 * EPSILON * sum(abs(x) for x in terms + parts)

    holds(count, check, sampled("bead"))


@counts(25, 1000)
def test_newtons_law_of_slider_bob_and_whole(count: int) -> None:
    """In both fidelities the reactions are those of the exact geometry."""

    def check(values: Any) -> None:
        model = started("pendulum", values)
        out = outputs(model)
        a0, a1 = acceleration_of(model, 0.0, model.q0, model.q1, model.v0, model.v1)
        v = values
        m1, m2, r = v["slider.mass"], v["pendulum.mass"], v["pendulum.length"]
        u, th, du, dth = model.q0, model.q1, model.v0, model.v1
        a, rising = v["parabola.coefficient_start"], v["parabola.coefficient_rate_start"]
        s, c = np.sin(th), np.cos(th)
        x_parts = [v["parabola.ax"], a0, r * a1 * c, -r * dth * dth * s]
        y_parts = [
            *(v["parabola.ay"], 2 * a * u * a0, 2 * a * du * du, 4 * rising * u * du),
            *(v["parabola.coefficient_acceleration"] * u * u, r * a1 * s, r * dth * dth * c),
        ]
        # rod and parabola turn the loads of either axis into forces along the other
        loads = [(m1 + m2) * v[f"gravity.{axis}"] for axis in "xy"]
        loads += [v[f"{body}.f{axis}"] for body in ("slider", "pendulum") for axis in "xy"]
        for axis, parts in (("x", x_parts), ("y", y_parts)):
            slider, bob = sum(parts[:-2]), sum(parts)
            terms = [
                *(m1 * slider, m2 * bob, -(m1 + m2) * v[f"gravity.{axis}"]),
                *(-v[f"slider.f{axis}"], -v[f"pendulum.f{axis}"], out[f"parabola.f{axis}"]),
            ]
            # the forces pass through the masses, and rounding with them
            through = [
                *((m1 + m2) * abs(part) for part in parts),
                *(abs(out["constraint.normal_force"]), abs(out["pendulum.tension"])),
            ]
            size = sum(map(abs, [*terms, *loads])) + sum(through)
            assert abs(sum(terms)) <= 1e-12 * size

    holds(count, check, sampled("pendulum"))
