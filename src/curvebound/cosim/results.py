"""What a run gives back."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CurveboundError, nearest
from ..fmi.drawing import Drawing
from .formats import write_table
from .tables import Table

__all__ = ["Result", "RunFailed", "RunInterrupted"]


@dataclass(repr=False)
class Result:
    """A run of a scene.

    Attributes
    ----------
    data : structured array, shape (points,)
        Columns ``time`` (s) and ``component.variable`` in the units of `units`, one row for each
        recorded communication point, the initial one included.
    wall, stepping : float
        Seconds that the run took, loading and initialization included, and those spent between the
        initial point and the last, recording included.
    steps, trials, rejected : int
        Macro steps of the solution; those computed to find it (adaptive: every full and half step,
        rejected ones included, else `steps`); those taken back.
    units : dict of str to str
        Unit by path.
    drawings : dict of str to Drawing
        What to draw of each component, where its FMU tells.
    inputs : dict of str to array, shape (points,)
        Inputs and tunable parameters that these drawings show as arrows, by path.
    notes : list of str
        What the user should know once: warnings of the FMUs, inputs left at their start.
    settings : dict
        With what it was run.
    complete : bool
        False when the run ended before the stop time; `failure` then says why.
    """

    scene: str
    data: Table
    wall: float = 0.0
    stepping: float = 0.0
    steps: int = 0
    trials: int = 0
    rejected: int = 0
    units: dict[str, str] = field(default_factory=dict)
    drawings: dict[str, Drawing] = field(default_factory=dict)
    inputs: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    settings: dict[str, Any] = field(default_factory=dict)
    complete: bool = True
    failure: str = ""

    @property
    def time(self) -> NDArray[np.float64]:
        """Communication points in s, shape (points,)."""
        return np.asarray(self.data["time"], dtype=np.float64)

    @property
    def names(self) -> list[str]:
        """The recorded variables, `component.variable`."""
        return [name for name in self.data.dtype.names or () if name != "time"]

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name != "time" and name not in self.names:
            raise CurveboundError(
                f"The result of {self.scene} has no {name}, scene.record() says what it has; "
                + nearest(name, self.names)
            )
        return np.asarray(self.data[name])

    def __repr__(self) -> str:
        time = self.time
        span = f", {time[0]:g} to {time[-1]:g} s" if len(time) else ""
        return f"<Result of {self.scene}: {len(time)} points{span}, {', '.join(self.names)}>"

    def write(self, path: Path | str, *, with_units: bool = False) -> Path:
        """Keep the data as CSV, JSON, Parquet or NPZ: as the name ends, every digit kept.

        Parameters
        ----------
        path : Path or str
            The file, which appears whole or not at all: .csv, .json, .parquet or .npz.
        with_units : bool
            In a CSV, write units behind the names, as in ``a.x [m]``.

        Returns
        -------
        Path
            The same.

        Raises
        ------
        CurveboundError
            It cannot be written, or has another ending.
        """
        return write_table(self.data, Path(path), self.units, with_units=with_units)


class RunFailed(CurveboundError):
    """A run that ended before its time.

    Attributes
    ----------
    result : Result
        What was recorded up to there.
    component, cause : str
        Which component failed, and what it said.
    time : float
        When, in s.
    """

    def __init__(self, message: str, result: Result, component: str, time: float, cause: str):
        super().__init__(message)
        self.result = result
        self.component = component
        self.time = time
        self.cause = cause


class RunInterrupted(KeyboardInterrupt):
    """A run that the keyboard stopped; `time` in s, `result` holds what was recorded up to there.

    Not a RunFailed: what goes on after a failed run must stop here.
    """

    def __init__(self, failed: RunFailed):
        super().__init__(str(failed))
        self.result = failed.result
        self.time = failed.time
