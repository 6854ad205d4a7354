"""Models and states at which a system is looked at."""

from __future__ import annotations

import functools
import math
import random
from collections.abc import Callable, Iterable, Mapping

from ..cosim.fmu import Value
from ..fmi.declaration import CHOICE, COUNT_PARAMETER, INPUT, PARAMETER, Fmu
from ..kernel.base import Model

__all__ = ["anywhere", "model_anywhere", "models", "numbers_of", "pushes"]

#: amplitude of an input that is pushed, by unit
_PUSH = {"m/s2": 1.0, "N": 0.5}


def models(fmu: Fmu) -> Iterable[tuple[str, dict[str, Value]]]:
    """The models that the choices offer: (words for messages, choices), one choice at a time."""
    yield "", {}
    for variable in fmu.variables:
        if variable.kind == CHOICE and variable.type and variable.name.startswith("model."):
            for number, (item, _) in enumerate(variable.type.items, 1):
                if number != variable.start:
                    yield f"{variable.name} = {item}: ", {variable.name: item}


def anywhere(fmu: Fmu, rng: random.Random) -> dict[str, float]:
    """Parameters and inputs at random: sizes about their start values, states in all directions."""
    values = {}
    for v in fmu.variables:
        if v.kind == INPUT or (v.kind == PARAMETER and v.unit in ("rad", "m/s", "rad/s")):
            values[v.name] = rng.uniform(-3.0, 3.0)
        elif v.kind == PARAMETER and v.start == 0.0:
            values[v.name] = abs(rng.gauss(0.0, 1.0))
        elif v.kind == PARAMETER:
            values[v.name] = v.start * math.exp(rng.gauss(0.0, 1.0))
    return values


def model_anywhere(
    fmu: Fmu,
    factory: Callable[[dict[str, int]], Model],
    numbers: dict[str, int],
    rng: random.Random,
) -> tuple[Model, dict[str, float]]:
    """A model at such a point, started and with its inputs, and the values there."""
    values = anywhere(fmu, rng)
    model = factory(numbers)
    model.start(values, numbers)
    model.set_inputs([values[name] for name in model.INPUTS], 0)
    return model, values


def numbers_of(fmu: Fmu, choices: Mapping[str, Value]) -> dict[str, int]:
    """Enumerations and Integer parameters by number: `choices` by item name, others as declared."""
    numbers = {v.name: int(v.start) for v in fmu.variables if v.kind in (CHOICE, COUNT_PARAMETER)}
    for v in fmu.variables:
        if v.type is not None and v.name in choices:
            numbers[v.name] = v.type.number(str(choices[v.name]))
    return numbers


def pushes(fmu: Fmu) -> dict[str, Callable[[float], float]]:
    """A sine for each input, no two of one frequency."""
    return {
        v.name: functools.partial(_sine, _PUSH.get(v.unit, 0.2), 0.3 + 0.17 * number)
        for number, v in enumerate(v for v in fmu.variables if v.kind == INPUT)
    }


def _sine(amplitude: float, frequency: float, time: float) -> float:
    return amplitude * math.sin(2.0 * math.pi * frequency * time)
