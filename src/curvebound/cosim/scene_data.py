"""A scene as data: which FMUs run, how joined, how long, how, and what it shows and needs."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import CurveboundError, nearest
from ..units import number
from .scene_parts import ALGORITHMS, Adaptive, Component, Connection, Needs

if TYPE_CHECKING:
    from typing_extensions import Self

    from .fmu import Value
    from .signals import SignalLike

__all__ = ["SceneData"]

#: settings that are words
_WORDS = ("algorithm", "hold")


class SceneData:
    """What a scene says; nothing is read or checked before it is resolved."""

    def __init__(
        self,
        name: str,
        description: str = "",
        *,
        stop_time: float,
        step: float,
        start_time: float = 0.0,
        algorithm: str = "gauss_seidel",
        hold: str = "zero",
        order: Sequence[str] | None = None,
        groups: tuple[Sequence[str], Sequence[str]] | None = None,
        adaptive: Adaptive | None = None,
        loop_tolerance: float | None = None,
        tolerance: float | None = None,
        record_every: int = 1,
        needs: Mapping[str, float] | Needs | None = None,
        lesson: int | None = None,
    ) -> None:
        """An empty scene.

        Parameters
        ----------
        name, description : str
            One word, after which files are named; one line.
        stop_time, start_time, step : float
            In s; step: between communication points, the macro step (the first where `adaptive`).
        algorithm : {"gauss_seidel", "jacobi", "strang", "midpoint"}
            How components exchange values, see curvebound.cosim.algorithms.
        hold : {"zero", "first"}
            Inputs over a macro step: held, or linear in time where the FMUs can, see
            curvebound.cosim.slopes.
        order : sequence of str, optional
            Component names in the order in which gauss_seidel steps them (default: derived).
        groups : pair of sequences of str, optional
            The two groups of components of strang (default: derived).
        adaptive : Adaptive, optional
            Macro steps chosen by estimated error; None for a fixed step.
        loop_tolerance : float, optional
            Relative tolerance to which algebraic loops are iterated at each communication point;
            None makes a loop an error.
        tolerance : float, optional
            Given to every FMU in fmi2SetupExperiment; None gives each that of its own
            DefaultExperiment, if it has one.
        record_every : int
            Keep each n-th communication point only (and the last).
        needs : mapping of str to float, or Needs, optional
            Largest error allowed by output path, in the unit of the output.
        lesson : int, optional
            Its place in a course: the gallery shows scenes in this order, others behind them.

        Raises
        ------
        CurveboundError
            A time is no number.
        """
        self.name = name
        self.description = description
        self.stop_time = _number("stop_time", stop_time)
        self.step = _number("step", step)
        self.start_time = _number("start_time", start_time)
        self.algorithm = algorithm
        self.hold = hold
        self.order = list(order) if order is not None else None
        self.groups = groups
        self.adaptive = adaptive
        self.loop_tolerance = loop_tolerance
        self.tolerance = tolerance
        self.record_every = record_every
        self.needs = needs if isinstance(needs, Needs) else Needs(dict(needs or {}))
        self.lesson = lesson
        self.components: dict[str, Component] = {}
        self.connections: list[Connection] = []
        self.matches: list[tuple[str, str]] = []
        self.inputs: dict[str, SignalLike] = {}
        self.recorded: list[str] = []
        self.variants: dict[str, dict[str, Value]] = {}
        self.notes: list[str] = []  # said once with every result
        self.goes_back = False  # whoever steps it may return to a state saved before
        self.folder: Path | None = None  # what relative paths of FMUs and tables start from

    def set(self, path: str, value: Value) -> Self:
        """Change a start value, or a setting of the scene itself.

        Parameters
        ----------
        path : str
            ``component.variable``, or step, stop_time, start_time, tolerance, loop_tolerance,
            algorithm, hold.
        value : float, int, bool or str
            In the variable's unit, or text with a unit to convert from ("90deg").

        Returns
        -------
        Scene
            The scene itself.

        Raises
        ------
        CurveboundError
            There is no such component or setting.
        """
        component, dot, variable = path.partition(".")
        if not dot:
            self._set_own(path, value)
        elif component not in self.components:
            raise CurveboundError(
                f"{path}: the scene {self.name} has no component {component}; "
                + nearest(component, self.components)
            )
        elif path in self.inputs and not callable(self.inputs[path]):
            self.inputs[path] = value
        else:
            self.components[component].start[variable] = value
        return self

    def _set_own(self, name: str, value: Value) -> None:
        own = ("step", "stop_time", "start_time", "tolerance", "loop_tolerance", *_WORDS)
        if name in self.components:
            raise CurveboundError(f"{name} is a component: name a variable of it, {name}.VARIABLE.")
        if name not in own:
            raise CurveboundError(
                f"{name} is neither a path component.variable nor a setting of the scene; "
                + nearest(name, [*own, *self.components])
            )
        if name in _WORDS:
            setattr(self, name, str(value))
            return
        setattr(self, name, _number(name, value))

    @property
    def rolls_back(self) -> bool:
        """Whether its macro steps take states back."""
        algorithm = ALGORITHMS.get(self.algorithm)
        return self.adaptive is not None or (algorithm is not None and algorithm.rolls_back)

    def copy(self, name: str | None = None) -> Self:
        """An independent scene with the same content.

        Parameters
        ----------
        name : str, optional
            Another name.

        Returns
        -------
        Scene
            What is done to it leaves this one as it is.
        """
        other = copy.copy(self)
        other.name = name or self.name
        other.components = {k: copy.copy(c) for k, c in self.components.items()}
        for component in other.components.values():
            component.start = dict(component.start)
        other.connections = list(self.connections)
        other.matches = list(self.matches)
        other.inputs = dict(self.inputs)
        other.recorded = list(self.recorded)
        other.variants = {k: dict(v) for k, v in self.variants.items()}
        other.needs = copy.deepcopy(self.needs)
        return other

    def with_variant(self, name: str) -> Self:
        """A copy with the settings of a variant.

        Parameters
        ----------
        name : str
            Of the variant.

        Returns
        -------
        Scene
            A copy.

        Raises
        ------
        CurveboundError
            There is no such variant.
        """
        if name not in self.variants:
            raise CurveboundError(
                f"The scene {self.name} has no variant {name!r}; " + nearest(name, self.variants)
            )
        other = self.copy()
        for path, value in self.variants[name].items():
            other.set(path, value)
        return other


def _number(name: str, value: Value) -> float:
    """A setting of a scene; CurveboundError, which names it, where it is no number."""
    try:
        unit = "1" if name.endswith("tolerance") else "s"
        return number(value, unit) if isinstance(value, str) else float(value)
    except (TypeError, ValueError) as error:
        raise CurveboundError(f"{name}: {error}.") from None
