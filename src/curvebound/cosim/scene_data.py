"""A scene as data: which FMUs run, how joined, how long, how, and what it shows and needs."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import CurveboundError, nearest
from ..units import number
from .scene_parts import ALGORITHMS, Adaptive, Component, Connection, Jumping, Needs

if TYPE_CHECKING:
    from typing_extensions import Self

    from .fmu import Value
    from .signals import SignalLike

__all__ = ["SceneData"]

#: settings that are words
_WORDS = ("algorithm", "hold")


class SceneData:
    """A scene under construction; nothing is read or checked before it is resolved."""

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
        name : str
            One word, after which files are named.
        description : str
            One line.
        stop_time, start_time : float
            In s.
        step : float
            Macro step between communication points in s (the first one where `adaptive`).
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

    # building

    def add(
        self,
        name: str,
        source: str | Path,
        start: Mapping[str, Value] | None = None,
        *,
        feedthrough: Mapping[str, Sequence[str]] | bool | None = None,
    ) -> Self:
        """Add a component.

        Parameters
        ----------
        name : str
            A word without a dot; its variables are ``name.variable`` in the scene.
        source : str or Path
            An FMU, or a system that is built if need be: by name, or the path of its folder.
        start : mapping of str to float, int, bool or str, optional
            Start values by the variable's name, in its unit; enumerations by item name or number.
        feedthrough : mapping of str to sequence of str, or bool, optional
            Inputs on which outputs depend directly; False: none. Default: what the FMU declares.

        Returns
        -------
        Scene
            The scene itself.

        Raises
        ------
        CurveboundError
            The name has a dot or is taken.
        """
        if not name or "." in name:
            raise CurveboundError(
                f"The component name {name!r} must be a word without a dot: "
                "what follows the first dot of a path is the FMU's variable."
            )
        if name in self.components:
            raise CurveboundError(f"The scene {self.name} has a component {name} already.")
        self.components[name] = Component(name, source, dict(start or {}), feedthrough)
        return self

    def connect(
        self,
        source: str,
        target: str,
        factor: float | None = None,
        offset: float = 0.0,
        mapping: Mapping[int, int] | None = None,
    ) -> Self:
        """Let an output drive an input: input = factor * output + offset.

        Types may differ where no value is lost: Integer and Enumeration in both directions, Boolean
        to these, all of them to Real.

        Parameters
        ----------
        source, target : str
            Paths ``component.variable`` of the output and the input.
        factor : float, optional
            Default 1, for which the units must agree; a given one says that a difference is meant.
        offset : float
            In the unit of the input.
        mapping : mapping of int to int, optional
            Whole numbers that become others on their way; the rest stay.

        Returns
        -------
        Scene
            The scene itself; names, units and types are checked by `check` and `run`.
        """
        self.connections.append(Connection(source, target, factor, offset, mapping))
        return self

    def connect_matching(self, source: str, target: str) -> Self:
        """Connect every output of one component to the equally named input of another.

        Parameters
        ----------
        source, target : str
            Names of the components.

        Returns
        -------
        Scene
            The scene itself.
        """
        self.matches.append((source, target))
        return self

    def input(self, path: str, value: SignalLike, jumps: Sequence[float] = ()) -> Self:
        """Drive an input, or a tunable parameter, from the scene.

        It is evaluated at each communication point and held until the next one.

        Parameters
        ----------
        path : str
            ``component.variable``.
        value : float, callable, pair of sequences, str or Path
            A number; a function of time in s; (times, values); the path of a CSV file. In the unit
            of the variable.
        jumps : sequence of float
            Times in s at which a function jumps: macro steps end there, as they do where a table
            gives a time twice; a jump that is not told acts up to a step late.

        Returns
        -------
        Scene
            The scene itself.

        Raises
        ------
        CurveboundError
            The path is driven already.
        """
        if path in self.inputs:
            raise CurveboundError(f"{path} is given twice as an input of the scene {self.name}.")
        if jumps and callable(value):
            value = Jumping(value, list(jumps))
        self.inputs[path] = value
        return self

    def record(self, *paths: str) -> Self:
        """Record outputs. Without any call those that the scene needs, or else all.

        Parameters
        ----------
        *paths : str
            ``component.variable``; * stands for any part of a variable's name.

        Returns
        -------
        Scene
            The scene itself.
        """
        self.recorded.extend(paths)
        return self

    def variant(self, name: str, values: Mapping[str, Value]) -> Self:
        """Name other settings under which the scene is worth running.

        Parameters
        ----------
        name : str
            Of the variant.
        values : mapping of str to value
            As for `set`.

        Returns
        -------
        Scene
            The scene itself.
        """
        self.variants[name] = dict(values)
        return self

    # changing

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
