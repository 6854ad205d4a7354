"""Motions, work and counts of steps are what they were: figures.json, every value of it.

    python tests/integrators/test_figures.py        writes the file anew

Other tests say what is right, within bounds. This one sees any change: of a constant that decides
how many steps are made, of a state that is carried on, of a quantity that only a warning shows. Who
changes a method or a model on purpose writes the file anew and looks at what has changed in it.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent))

from small_models import Oscillator, Pendulum, Sliding

from curvebound.fmi.folder import find
from curvebound.kernel.base import Model
from curvebound.kernel.directional import output_changes
from curvebound.kernel.methods import METHODS, create
from curvebound.kernel.ramp import Ramp
from curvebound.kernel.rates import OutputRates

FILE = Path(__file__).parent / "figures.json"
#: what a model tells the methods and the FMU's face besides its results
TOLD = ("magnification", "works", "settles", "is_linear", "is_constant", "q0_scale", "q1_scale",
        "initial_kinetic", "initial_potential", "balance_energy", "balance_size")  # fmt: skip

BEAD = {
    "gravity.x": 0.5, "gravity.y": -9.81, "wire.radius": 1.3, "bead.mass": 0.7,
    "bead.damping": 0.1, "bead.angle_start": 2.9, "bead.angular_velocity_start": 1.5,
    "constraint.stiffness": 80.0, "constraint.damping": 15.0,
}  # fmt: skip
PENDULUM = {
    "gravity.x": 0.2, "gravity.y": -9.81, "parabola.coefficient_start": 0.4,
    "parabola.coefficient_rate_start": 0.02, "slider.mass": 1.7, "pendulum.mass": 0.6,
    "pendulum.length": 0.8, "slider.damping": 0.11, "pendulum.damping": 0.07,
    "slider.u_start": 0.5, "slider.u_rate_start": -0.3, "pendulum.angle_start": 2.7,
    "pendulum.angular_velocity_start": 0.9,
}  # fmt: skip
STIFF = {"bead.damping": 3e4, "slider.damping": 3e4, "pendulum.damping": 2e4}
CALM = dict.fromkeys(("slider.damping", "pendulum.damping", "parabola.coefficient_rate_start"), 0.0)
#: name -> FMU, choices, parameters beside those above
KINDS: dict[str, tuple[str, dict[str, int], dict[str, float]]] = {
    "angle": ("BeadOnWire", {"model.formulation": 2}, {}),
    "none": ("BeadOnWire", {"model.formulation": 1, "constraint.stabilization": 1}, {}),
    "baumgarte": ("BeadOnWire", {"model.formulation": 1, "constraint.stabilization": 2}, {}),
    "projection": ("BeadOnWire", {"model.formulation": 1, "constraint.stabilization": 3}, {}),
    "linear": ("ParabolaPendulum", {"model.fidelity": 1}, {"pendulum.angle_start": 0.2}),
    "nonlinear": ("ParabolaPendulum", {"model.fidelity": 2}, {}),
    "stiff angle": ("BeadOnWire", {"model.formulation": 2}, STIFF),
    "stiff pendulum": ("ParabolaPendulum", {"model.fidelity": 2}, STIFF),
    "steady linear": ("ParabolaPendulum", {"model.fidelity": 1}, CALM),
    "conservative": ("ParabolaPendulum", {"model.fidelity": 2}, CALM),
    "upright": ("BeadOnWire", {"model.formulation": 2},
                {"gravity.x": 0.0, "bead.damping": 0.0, "bead.angle_start": math.pi - 1e-7,
                 "bead.angular_velocity_start": 0.0}),
}  # fmt: skip
SMALL = {"oscillator": Oscillator, "damped": lambda: Oscillator(damping=0.3, push=0.7, outer=0.5),
         "pendulum": Pendulum, "sliding": Sliding}  # fmt: skip
#: method -> tolerance and number of steps in a communication step, one after the other
SETTINGS = {
    "explicit_euler": (0.0, 40), "semi_implicit_euler": (0.0, 40), "rk4": (0.0, 10),
    "implicit": (1e-9, 10), "exact": (0.0, 1), "adaptive": (1e-9, 1), "adaptive coarse": (1e-3, 1),
}  # fmt: skip


def started(name: str) -> Model:
    """A model of a kind at its start."""
    if name in SMALL:
        return SMALL[name]()
    fmu, choices, others = KINDS[name]
    choices = {"constraint.stabilization": 3, **choices} if fmu == "BeadOnWire" else choices
    values = BEAD if fmu == "BeadOnWire" else PENDULUM
    model: Model = find(fmu).module("kernel").model(choices)
    model.start({**values, **{k: v for k, v in others.items() if k in values}}, choices)
    return model


def observed(model: Model) -> list[float]:
    """All outputs."""
    values = [0.0] * len(model.OUTPUTS)
    for group in sorted(set(model.OUTPUTS.values())):
        model.observe(group, values, 0)
    return values


def rates(model: Model, slopes: list[float]) -> list[float]:
    """Time derivatives of all outputs."""
    values = [0.0] * len(model.OUTPUTS)
    motion = OutputRates(model)
    motion.begin()
    for group in set(model.OUTPUTS.values()):
        motion.find(group, slopes, values, 0)
    return values


def told(model: Model) -> dict[str, Any]:
    """What a model says of itself, and its equations where it is."""
    found: dict[str, Any] = {name: float(getattr(model, name)) for name in TOLD}
    state = (model.q0, model.q1, model.v0, model.v1)
    model.acceleration(0.01, *state)
    a = found["acceleration"] = [model.a0, model.a1]
    found["power"] = model.power(0.01, *state, *a) if model.works else 0.0
    model.jacobian(0.01, *state)
    found["jacobian"] = [model.a0_q0, model.a0_q1, model.a1_q0, model.a1_q1,
                         model.a0_v0, model.a0_v1, model.a1_v0, model.a1_v1]  # fmt: skip
    if model.INPUTS:
        found["outputs"] = observed(model)
        count = model.input_count
        slopes = [0.1 * (i + 1) for i in range(count)] + [0.0] * (len(model.slopes) - count)
        found["rates"] = rates(model, slopes)
        found["changes"] = output_changes(model, [0.2 + 0.1 * i for i in range(count)])
    return found


def inputs_of(model: Model, part: int, *, steady: bool) -> list[float]:
    """Inputs that change from one communication step to the next, off in the first."""
    sizes = [0.3, -0.4, 0.05, 0.6, 0.2, -0.3, 0.1][: model.input_count]
    if steady and len(sizes) > 2:
        sizes[2] = 0.0
    return [part * size for size in sizes]


def motion(name: str, setting: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """What there is to see after each of three communication steps, the last with slopes."""
    method = create(METHODS.index(setting.split()[0]) + 1)
    model = started(name)
    ramp = Ramp()
    tolerance, count = SETTINGS[setting]
    for part in range(3):
        model.set_inputs(inputs_of(model, part, steady=setting == "exact"), 0)
        if model.INPUTS:
            model.keep()
        if part == 2 and model.INPUTS and setting != "exact":
            ramp.begin(model, [0.1 * x for x in inputs_of(model, 1, steady=False)], 0.2)
            outcome = method.advance(ramp, 0.2, count, tolerance, 100_000)
            ramp.end()
        else:
            outcome = method.advance(model, 0.2, count, tolerance, 100_000)
            model.advance_frame(0.2)
        found = {
            "outcome": outcome,
            "steps": method.steps,
            "evaluations": method.evaluations,
            "doubt": method.doubt(),
            "loss": method.loss(),
            "method": method.get_state(),
            "work": model.work,
            "q": [model.q0, model.q1],
            "v": [model.v0, model.v1],
        }
        if model.INPUTS and part == 2:
            found["state"] = model.get_state()
            found["outputs"] = observed(model)
        yield f"{name}, {setting}, {part}", found


def everything() -> dict[str, Any]:
    """All figures, rounded to nine digits."""
    found: dict[str, Any] = {}
    for name in (*KINDS, *SMALL):
        if name in KINDS:
            found[f"{name} at its start"] = told(started(name))
        for setting in SETTINGS:
            if setting == "exact" and not started(name).is_linear:
                continue
            if name.startswith("stiff") and not setting.startswith("adaptive"):
                continue
            if name == "linear" and setting == "exact":  # the coefficient changes
                continue
            found.update(motion(name, setting))
    return _rounded(found)


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(one) for one in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value


def differing(found: Any, kept: Any, place: str = "") -> Iterator[str]:
    """Where two figures differ by more than another C library's last digits."""
    if isinstance(kept, dict):
        assert isinstance(found, dict)
        if found.keys() != kept.keys():
            yield f"{place}: {sorted(found.keys() ^ kept.keys())}"
        for key in kept.keys() & found.keys():
            yield from differing(found[key], kept[key], f"{place} {key}")
    elif isinstance(kept, list):
        if len(found) != len(kept):
            yield f"{place}: {len(found)} values, {len(kept)} before"
        for i, (one, other) in enumerate(zip(found, kept, strict=False)):
            yield from differing(one, other, f"{place}[{i}]")
    elif not math.isclose(found, kept, rel_tol=1e-7, abs_tol=1e-12):
        yield f"{place}: {found}, {kept} before"


def test_all_figures_are_what_they_were() -> None:
    kept = json.loads(FILE.read_text())
    assert list(differing(everything(), kept)) == []


if __name__ == "__main__":
    lines = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in everything().items()]
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    print(f"{FILE}: {FILE.stat().st_size} bytes")
