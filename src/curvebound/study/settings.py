"""What can be chosen in a scene: model, formulation, method, size and macro step."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..cosim.system import port_of
from ..errors import CurveboundError
from ..kernel.methods import METHODS, create
from ..numbers import plain, quantity
from .reference.equations import system_of

if TYPE_CHECKING:
    from ..cosim.fmu import Value
    from ..cosim.scene import Scene
    from ..cosim.system import System

__all__ = ["STEP_ORDERS", "Setting", "Space", "space_of", "study_outputs"]

_METHOD = "solver.method"
#: method -> order, where a given step decides the error; `adaptive` chooses it, `exact` has none
STEP_ORDERS = {
    name: method.ORDER
    for item, name in enumerate(METHODS, 1)
    if (method := create(item)).ORDER and not method.CHOOSES_STEP
}
#: rejected steps count too: as many as an integer of FMI holds, so that no choice meets the limit
_MAX_STEPS = 2_000_000_000


@dataclass(frozen=True)
class Setting:
    """One way to run a scene.

    structure: enumeration items by path, of every component that integrates.
    method: item of solver.method; size: solver.step in s, or solver.tolerance of `adaptive`, None
        for `exact`, which has neither.
    step: macro step in s; algorithm, hold: as in a scene.
    """

    structure: tuple[tuple[str, str], ...]
    method: str
    size: float | None
    step: float
    algorithm: str
    hold: str = "zero"

    @property
    def by_tolerance(self) -> bool:
        """Whether `size` is a tolerance."""
        return self.method == "adaptive"

    @property
    def key(self) -> str:
        """All of it as one word, the same in every process."""
        items = "/".join(f"{path}={item}" for path, item in self.structure)
        return f"{items}|{self.method}|{self.size!r}|{self.step!r}|{self.coupling}"

    @property
    def coupling(self) -> str:
        """How values go from one component to another, in words."""
        return self.algorithm + (", hold first" if self.hold == "first" else "")

    @property
    def form(self) -> str:
        """The structure in few words: items, without what all components share."""
        return _form(self.structure)

    @property
    def label(self) -> str:
        """In words, without macro step and algorithm."""
        parts = [part for part in (self.form, self.method) if part]
        if self.size is not None:
            size = plain(self.size, 2) if self.by_tolerance else quantity(self.size, "s", 2)
            parts.append(f"{'tolerance' if self.by_tolerance else 'step'} {size}")
        return ", ".join(parts)

    def with_size(self, size: float | None) -> Setting:
        """The same with another micro step or tolerance."""
        return replace(self, size=size)

    @property
    def family(self) -> Setting:
        """What it shares with the same choice at other micro steps or tolerances."""
        return replace(self, size=None)


def _form(structure: Iterable[tuple[str, str]]) -> str:
    words: dict[str, list[str]] = {}
    for path, item in structure:
        words.setdefault(path.partition(".")[0], []).append(item)
    sets = {tuple(items) for items in words.values()}
    if len(sets) == 1:
        return " ".join(next(iter(sets)))
    return "; ".join(f"{name}: {' '.join(items)}" for name, items in words.items())


class Space:
    """Every choice that a scene's FMUs offer.

    structures: values of enumerations by path, the most accurate model first; `exact` holds for
        each whether solver.method = exact works with it, `approximate` whether it is a simpler
        model.
    methods: items of solver.method but for exact.
    """

    def __init__(
        self,
        system: System,
        structures: list[tuple[tuple[str, str], ...]],
        exact: list[bool],
        approximate: list[bool],
        methods: list[str],
        plants: list[str],
    ) -> None:
        self.system = system
        self.structures = structures
        self.exact = exact
        self.approximate = approximate
        self.methods = methods
        self.plants = plants

    def start(self, setting: Setting) -> dict[str, Value]:
        """Start values by path that bring a setting about."""
        values: dict[str, Value] = dict(setting.structure)
        for name in self.plants:
            variables = self.system.nodes[name].fmu.variables
            values[f"{name}.{_METHOD}"] = setting.method
            if setting.size is not None:
                which = "solver.tolerance" if setting.by_tolerance else "solver.step"
                values[f"{name}.{which}"] = setting.size
            if "solver.max_steps" in variables:
                values[f"{name}.solver.max_steps"] = _MAX_STEPS
        return values

    def is_approximate(self, setting: Setting) -> bool:
        """Whether the setting computes a simpler model."""
        return self.approximate[self.structures.index(setting.structure)]

    def families(self, step: float, algorithm: str, hold: str = "zero") -> list[Setting]:
        """Every structure with every method, without size."""
        return [
            Setting(structure, method, None, step, algorithm, hold)
            for structure, exact in zip(self.structures, self.exact, strict=True)
            for method in [*self.methods, *(["exact"] if exact else [])]
        ]

    def model(self, setting: Setting) -> dict[str, str]:
        """Enumeration values that make out the model that a setting computes."""
        changed: dict[str, str] = {}
        for path, item in setting.structure:
            name, variable = port_of(path)
            entries = system_of(self.system.nodes[name].fmu).approximate
            if any(variable == of for of, _ in entries):
                changed[path] = item
        return changed

    @property
    def is_simpler(self) -> bool:
        """Whether even the most accurate model is a simpler one, as it was to be kept."""
        return self.approximate[0]

    @property
    def best_model(self) -> dict[str, str]:
        """Enumeration values of the most accurate model."""
        return self.model(Setting(self.structures[0], "", None, 1.0, ""))


def space_of(system: System, keep: Mapping[str, str] | None = None) -> Space:
    """The choices of a scene that was checked.

    keep: enumeration values by path that stay as given. Where they make a simpler model, that is
        what the scene is judged by: what the model itself is off by is the user's choice.
    Components of the same FMU share their structure, and all share method and size.
    """
    groups: dict[str, list[str]] = {}
    for name, node in system.nodes.items():
        if _METHOD in node.fmu.variables:
            groups.setdefault(node.fmu.model_name, []).append(name)
    if not groups:
        raise CurveboundError(
            f"The scene {system.scene.name} has no component with a variable {_METHOD}: there is "
            "nothing to choose."
        )
    plants = [name for names in groups.values() for name in names]
    methods: list[str] | None = None
    per_group = []
    for names in groups.values():
        known = system_of(system.nodes[names[0]].fmu)
        items = list(system.nodes[names[0]].fmu.variables[_METHOD].items or {})
        methods = items if methods is None else [m for m in methods if m in items]
        per_group.append([(known, structure, names) for structure in known.structures])
    structures, exact, approximate = [], [], []
    offered: dict[str, set[str]] = {}
    for combination in itertools.product(*per_group):
        values: dict[str, str] = {}
        all_exact, simpler = True, False
        for known, structure, names in combination:
            needed = known.exact_with
            all_exact = all_exact and needed is not None and needed.items() <= structure.items()
            simpler = simpler or any(structure.get(v) == item for v, item in known.approximate)
            for name in names:
                values |= {f"{name}.{variable}": item for variable, item in structure.items()}
        for path, item in values.items():
            offered.setdefault(path, set()).add(item)
        if any(values.get(path, item) != item for path, item in (keep or {}).items()):
            continue
        structures.append(tuple(values.items()))
        exact.append(all_exact)
        approximate.append(simpler)
    for path, item in (keep or {}).items():
        if item not in offered.get(path, ()):
            known_items = [f"{p}={i}" for p, items in offered.items() for i in sorted(items)]
            raise CurveboundError(
                f"The scene {system.scene.name} has no choice {path}={item} to keep; it has "
                f"{', '.join(known_items) or 'none'}."
            )
    if not structures:
        kept = ", ".join(f"{path}={item}" for path, item in (keep or {}).items())
        raise CurveboundError(f"No structure of the scene {system.scene.name} has all of {kept}.")
    plain = [m for m in methods or [] if m != "exact"]
    return Space(system, structures, exact, approximate, plain, plants)


def study_outputs(scene: Scene, system: System) -> list[str]:
    """The outputs that a scene is judged by: those it needs, else what stands for its motion."""
    needed = list(scene.needs.errors)
    if needed:
        return needed
    return [
        f"{name}.{output}"
        for name, node in system.nodes.items()
        for output in system_of(node.fmu).main
    ]
