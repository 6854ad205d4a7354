"""The FMU of a system for one use: some variables only, with the start values of that use."""

from __future__ import annotations

from dataclasses import dataclass

from .declaration import CHOICE, COUNT_PARAMETER, PARAMETER, Fmu, Variable
from .declared import check_starts
from .folder import Folder

__all__ = ["Specialised"]


@dataclass(frozen=True)
class Specialised(Folder):
    """A system's folder whose FMU has another name and other defaults, and shows some variables.

    start: start values by name, of the variables' types (enumerations by number); shown: the names
    of the variables in the model description; stop_time, step_size: of its DefaultExperiment, s.
    Everything that is not shown keeps its start value and costs nothing. The FMU carries neither a
    reference result nor the statement of the physics, which studies need beside all variables.
    """

    fmu_name: str = ""
    start: tuple[tuple[str, float], ...] = ()
    shown: tuple[str, ...] = ()
    stop_time: float = 10.0
    step_size: float = 0.01

    @property
    def name(self) -> str:
        """The name of its FMU."""
        return self.fmu_name

    def declaration(self) -> Fmu:
        """The system's, changed; CurveboundError for a start value outside its domain."""
        fmu = super().declaration()
        given = dict(self.start)
        made = fmu._replace(
            name=self.fmu_name,
            variables=tuple(_started(v, given) for v in fmu.variables),
            stop_time=self.stop_time,
            step_size=self.step_size,
            reference_inputs={},
            shown=self.shown,
        )
        check_starts(made, f"{self.fmu_name}, with the start values of its scene")
        return made

    def statement(self) -> dict[str, bytes]:
        """Nothing."""
        return {}


def _started(variable: Variable, given: dict[str, float]) -> Variable:
    if variable.name not in given or variable.kind not in (PARAMETER, CHOICE, COUNT_PARAMETER):
        return variable
    value = given[variable.name]
    return variable._replace(start=value if variable.kind == PARAMETER else int(value))
