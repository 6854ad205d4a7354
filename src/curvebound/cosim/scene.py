"""A scene as scripts use it: built part by part, checked, prepared, run.

What runs it is imported when it is asked for: to know a scene takes neither numpy nor fmpy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import CurveboundError, reading
from .scene_data import SceneData
from .scene_parts import Component, Connection, Jumping

if TYPE_CHECKING:
    from typing_extensions import Self

    from .fmu import Value
    from .prepared import Prepared
    from .results import Result
    from .signals import SignalLike
    from .system import System

__all__ = ["Scene"]


class Scene(SceneData):
    """A scene under construction, and what can be done with it."""

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
        with reading(f"jumps of input {path}", "Give a list of times in s."):
            times = [float(time) for time in jumps]
            if not all(map(math.isfinite, times)):
                raise ValueError(f"they are {times}, not all of them finite")
        if times and callable(value):
            value = Jumping(value, times)
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

    # using

    def check(self) -> System:
        """Resolve every name and check everything.

        Returns
        -------
        System
            The scene with its FMUs read, links, order and what will be recorded.

        Raises
        ------
        CurveboundError
            Lists all that is wrong.
        """
        from .resolution import resolve

        return resolve(self)

    def prepare(self) -> Prepared:
        """Load the FMUs, to run them many times: ``with scene.prepare() as prepared: ...``.

        Returns
        -------
        Prepared
            Its ``run(start, stop_time=, step=)`` runs from the start time with other values.

        Raises
        ------
        CurveboundError
            As `check`.
        """
        from .prepared import Prepared

        return Prepared(self)

    def run(self, *, progress: Callable[[float], None] | None = None) -> Result:
        """Run once and free everything.

        Parameters
        ----------
        progress : callable, optional
            Called some times a second with the time reached in s.

        Returns
        -------
        Result
            Arrays of shape (points,) by path.

        Raises
        ------
        CurveboundError
            As `check`.
        RunFailed
            A component failed; its ``result`` holds what was recorded until then.
        """
        with self.prepare() as prepared:
            return prepared.run(progress=progress)

    def main(self, arguments: Sequence[str] | None = None) -> None:
        """Run as ``python SCENE.py``: the options of ``curvebound run``, this scene as its subject.

        Parameters
        ----------
        arguments : sequence of str, optional
            Default: those of the process.

        Raises
        ------
        SystemExit
            Always, with the status.
        """
        from .command import main

        raise SystemExit(main(self, arguments))
