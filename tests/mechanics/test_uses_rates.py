"""Where a model says that its accelerations read no rates, they read none: by hand and derived."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from kernel_module import kernel_module

from curvebound.fmi.folder import Folder, find
from curvebound.kernel.adaptive import Adaptive
from curvebound.kernel.method import DONE

from .conftest import EACH, FOLDERS

CHOICES = {
    "model.formulation": (1, 2),
    "constraint.stabilization": (1, 2, 3),
    "model.fidelity": (1, 2),
}
BY_HAND = ("BeadOnWire", "ParabolaPendulum")
Factory = Callable[[dict[str, int]], Any]


def factory_of(name: str) -> Factory:
    """What makes the models of a system, by hand or derived."""
    if name in BY_HAND:
        return find(name).module("kernel").model  # type: ignore[no-any-return]
    return kernel_module(Folder(FOLDERS[name]).derived()).model  # type: ignore[no-any-return]


@pytest.fixture(params=[*BY_HAND, *EACH])
def factory(request: pytest.FixtureRequest) -> Factory:
    return factory_of(request.param)


def given(names: tuple[str, ...], drawn: random.Random, shares: dict[str, float]) -> dict[str, Any]:
    """Random values; of those of a kind as many as `shares` says are zero, where it can be."""
    values = {}
    for name in names:
        x = drawn.uniform(-1.5, 1.5)
        if name.endswith((".mass", ".length", ".radius")) or "axis" in name:
            x = abs(x) + 0.1
        kind = next((kind for kind in shares if kind in name), "")
        values[name] = 0.0 if drawn.random() < shares.get(kind, 0.0) else x
        if "damping" in name or "stiffness" in name:
            values[name] = abs(values[name])
    return values


def states(factory: Factory, drawn: random.Random) -> Iterator[Any]:
    """A model in all choices, with and without damping, inputs and motion of frame and shape.

    Each is one object that is started again, and goes on from where it is.
    """
    known = factory(dict.fromkeys(CHOICES, 1)).CHOICES
    for items in itertools.product(*(CHOICES[name] for name in known)):
        choices = dict(zip(known, items, strict=True))
        model = factory(choices)
        for _ in range(12):
            damped, moves, pushed = (drawn.choice((0.0, 1.0)) for _ in range(3))
            shares = {"damping": damped, "rate_start": 1.0 - moves, "velocity_start": 0.0}
            model.start(given(model.PARAMETERS, drawn, shares), choices)
            yield model
            for share in (1.0, pushed, 0.7, 1.0):
                inputs = given(model.INPUTS, drawn, {".": share})
                model.set_inputs([inputs[name] for name in model.INPUTS], 0)
                yield model
                saved = model.get_state()
                model.keep()
                model.advance_frame(0.2)
                yield model
                model.set_state(saved)
                yield model


def test_what_is_said_of_rates_is_so(factory: Factory) -> None:
    drawn = random.Random(16)
    for model in states(factory, drawn):
        if model.uses_rates:
            continue
        for _ in range(3):
            t, q0, q1 = drawn.uniform(0.0, 0.2), drawn.gauss(0.0, 1.0), drawn.gauss(0.0, 1.0)
            found = set()
            for rate in (0.0, drawn.gauss(0.0, 3.0), math.inf, math.nan):
                model.acceleration(t, q0, q1, rate, -rate)
                found.add((model.a0.hex(), model.a1.hex()))
            assert len(found) == 1


@pytest.mark.parametrize(
    ("name", "choices"),
    [
        ("BeadOnWire", {"model.formulation": 2}),
        ("ParabolaPendulum", {"model.fidelity": 1}),
        ("bead_on_wire", {"model.formulation": 2}),
    ],
)
def test_it_is_said_without_damping_and_changes_no_bit(name: str, choices: dict[str, int]) -> None:
    drawn = random.Random(3)
    choices = {**dict.fromkeys(CHOICES, 1), **choices}
    ends = []
    model = factory_of(name)(choices)
    values = given(model.PARAMETERS, drawn, {"damping": 1.0})
    for damping, said in ((0.3, True), (0.0, False), (0.0, True)):
        model.start({n: damping if "damping" in n else x for n, x in values.items()}, choices)
        model.set_inputs([0.0] * len(model.INPUTS), 0)
        if not damping:
            assert not model.uses_rates
            model.uses_rates = said
        assert model.uses_rates == said
        method = Adaptive()
        for _ in range(3):
            assert method.advance(model, 1.0, 1, 1e-10, 10**5) == DONE
        ends.append(([x.hex() for x in (*model.get_state(), *method.get_state())], method.steps))
    assert ends[1] == ends[2] != ends[0]
