"""What a system must say about itself to be judged.

Values are numpy arrays of extended precision whose last axis runs over the members of an ensemble
(several starts at once); an axis before it may run over times. Formulas are written with ufuncs, so
that they do not care.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....mechanics.derived import Derived

__all__ = ["Array", "Equations", "Inputs", "Number", "System", "Witness"]

Number = np.longdouble
Array = NDArray[Any]  # of Number
Inputs = Mapping[str, Array]  # every input of the FMU, by name


class Equations:
    """A component in generalised coordinates.

    parameters: every parameter of the FMU by name: Real ones as arrays that broadcast to
        (members,), enumerations as the names of their items.
    """

    #: start values of what a control law measures that its gains are made for: not motion, shape
    DESIGNED_FOR: ClassVar[tuple[str, ...]] = ()

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        self.parameters = parameters

    def start(self) -> list[Array]:
        """The initial state, one array per component; none for a control law."""
        return []

    def rates(self, time: Array, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        """Time derivative of the state, per s."""
        return []

    def outputs(
        self, names: Sequence[str], time: Array, state: Sequence[Array], inputs: Inputs
    ) -> dict[str, Array]:
        """The outputs `names` in the FMU's units; KeyError for one that has no exact value."""
        raise NotImplementedError

    def period(self) -> float:
        """s between the samples of a control law, 0 where it acts all the time."""
        return 0.0

    def breaks(self) -> list[float]:
        """Times (s) at which the outputs are not smooth functions of time and inputs."""
        return []

    def set_points(self) -> dict[str, float]:
        """The values at which a control law holds its inputs, by name; none without feedback."""
        return {}


class Witness:
    """The same component in other coordinates, to be integrated beside Equations.

    Its state is brought back to that of Equations by `common`.
    """

    def __init__(self, equations: Equations) -> None:
        self.equations = equations

    def start(self) -> list[Array]:
        """The initial state."""
        raise NotImplementedError

    def rates(self, time: Array, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        """Time derivative of the state, per s."""
        raise NotImplementedError

    def common(self, state: Sequence[Array]) -> list[Array]:
        """The state of Equations that this one stands for."""
        raise NotImplementedError


#: closed form: (equations, inputs held from the start on, times (n,)) -> states (components, n,
#: members), or None where the formula does not apply
ClosedForm = Callable[[Equations, Inputs, Sequence[float]], "Array | None"]


@dataclass(frozen=True)
class System:
    """All about one FMU's equations.

    equations: makes them of the parameters.
    derived: what follows from its statement, None for a control law.
    structures: ways in which the FMU can compute the same thing, as values of its enumerations,
        the most accurate model first.
    approximate: enumeration values that change the model itself, not only how it is computed.
    main: outputs that stand for the whole motion where a scene does not say what it needs.
    closed_form: see ClosedForm; `closed_form_name` says what it is.
    exact_with: enumeration values under which solver.method = exact works, None where never.
    """

    model_name: str
    equations: Callable[[Mapping[str, Any]], Equations]
    witness: type[Witness] | None = None
    derived: Derived | None = None
    structures: tuple[Mapping[str, str], ...] = ({},)
    approximate: tuple[tuple[str, str], ...] = ()
    main: tuple[str, ...] = ()
    closed_form: ClosedForm | None = None
    closed_form_name: str = ""
    exact_with: Mapping[str, str] | None = None
