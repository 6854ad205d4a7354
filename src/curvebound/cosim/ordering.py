"""From a checked scene to a system: levels of evaluation, loops, the order of stepping, groups."""

from __future__ import annotations

from collections.abc import Iterable

from .graph import Loop, components, levels, stepping_order, two_groups
from .scene_data import SceneData
from .signals import Signal
from .system import Link, Node, Port, System
from .system import path_of as _path

__all__ = ["Ordering"]


class Ordering:
    """Makes the system of a scene whose names are resolved; `problems` collects what is wrong."""

    def __init__(
        self,
        scene: SceneData,
        nodes: dict[str, Node],
        links: list[Link],
        signals: dict[Port, Signal],
    ) -> None:
        self.scene = scene
        self.nodes = nodes
        self.links = links
        self.signals = signals
        self.problems: list[str] = []

    def system(
        self, recorded: list[Port], controlled: dict[Port, float], notes: list[str]
    ) -> System:
        """The system; of use only where `problems` is still empty."""
        read = dict.fromkeys([*(link.source for link in self.links), *recorded, *controlled])
        plain, loops = self._levels(read, initial=False)
        initial, initial_loops = self._levels(read, initial=True)
        names = list(self.nodes)
        edges: dict[str, dict[str, bool]] = {}
        for link in self.links:
            a, b = link.source[0], link.target[0]
            strong = plain[link.source] > 0
            edges.setdefault(a, {})[b] = edges.get(a, {}).get(b, False) or strong
        order = self.scene.order
        if order is None:
            order = stepping_order(names, edges)
        elif sorted(order) != sorted(names):
            self.problems.append(
                f"order must name each component once: {', '.join(names)}; it is {', '.join(order)}"
            )
        groups = self._groups(names, edges) if self.scene.algorithm == "strang" else None
        if self.scene.loop_tolerance is None:
            for loop in loops or initial_loops:
                self.problems.append(self._loop_problem(loop))
        # outputs that follow inputs directly jump with them: their change is no error of the states
        controlled = {port: scale for port, scale in controlled.items() if plain[port] == 0}
        if self.scene.adaptive is not None and not controlled:
            self.problems.append(
                "adaptive macro steps have no output to control: record at least one continuous "
                "Real output that does not depend directly on an input"
            )
        self._tell_order(order, edges, notes)
        system = System(
            scene=self.scene,
            nodes=self.nodes,
            links=self.links,
            signals=self.signals,
            recorded=recorded,
            controlled=controlled,
            levels=plain,
            loops=loops,
            initial_levels=initial,
            initial_loops=initial_loops,
            order=list(order),
            passing=_passing(order, edges),
            groups=groups,
            notes=notes,
        )
        # what is recorded alone is read with the states where their inputs are those of that time
        connected = {link.source for link in self.links}
        alone = [p for p in plain if p[0] in system.led and p not in connected]
        plain.update(dict.fromkeys(alone, 0))
        return system

    def _tell_order(
        self, order: list[str], edges: dict[str, dict[str, bool]], notes: list[str]
    ) -> None:
        """Note where adaptive macro steps must be tiny: direct feedback, held, is of order 1."""
        scene = self.scene
        if scene.adaptive is None or scene.algorithm == "midpoint":
            return
        for group in components({name: list(edges.get(name, ())) for name in order}):
            if any(edges.get(a, {}).get(b) for a in group for b in group):
                notes.append(
                    f"Direct feedback around {', '.join(sorted(group))} is of first order under "
                    f"{scene.algorithm}: its adaptive macro steps are as short as the tolerance is "
                    "small; the algorithm midpoint is of second order."
                )

    def _levels(
        self, read: Iterable[Port], *, initial: bool
    ) -> tuple[dict[Port, int], list[Loop[Port]]]:
        source_of = {link.target: link.source for link in self.links}
        # what depends on an input at once may depend so on a tunable parameter: FMI does not say
        tuned = {port[0] for port in self.signals if self._causality(port) != "input"}
        depends: dict[Port, list[Port]] = {}
        at_least: dict[Port, int] = {}
        for port in read:
            node = self.nodes[port[0]]
            table = node.initial_dependencies if initial else node.dependencies
            targets = [(port[0], name) for name in table.get(port[1], ())]
            depends[port] = [source_of[t] for t in targets if t in source_of]
            driven = any(t in source_of or t in self.signals for t in targets)
            if driven or (targets and node.name in tuned):
                at_least[port] = 1
        return levels(depends, at_least)

    def _causality(self, port: Port) -> str:
        return self.nodes[port[0]].fmu.variables[port[1]].causality

    def _groups(
        self, names: list[str], edges: dict[str, dict[str, bool]]
    ) -> tuple[list[str], list[str]] | None:
        given = self.scene.groups
        if given is None:
            found = two_groups(names, edges)
            if found is None:
                self.problems.append(
                    "strang needs two groups of components with every connection between them, "
                    "and this scene has none; use gauss_seidel"
                )
            return found
        first, second = list(given[0]), list(given[1])
        if sorted([*first, *second]) != sorted(names):
            self.problems.append(
                f"groups must name each component once: {', '.join(names)}; "
                f"they are {', '.join(first)} and {', '.join(second)}"
            )
            return None
        for a, targets in edges.items():
            for b in targets:
                if (a in first) == (b in first):
                    self.problems.append(
                        f"strang is of second order only with every connection between its two "
                        f"groups, and {a} -> {b} stays within one; move {b} to the other group"
                    )
        return first, second

    def _loop_problem(self, loop: Loop[Port]) -> str:
        source_of = {link.target: link.source for link in self.links}
        steps = []
        for here, after in zip(loop.circle, [*loop.circle[1:], loop.circle[0]], strict=True):
            through = next(
                (t for t, s in source_of.items() if s == here and t[0] == after[0]), after
            )
            steps.append(f"{_path(here)} -> {_path(through)}")
        undeclared = sorted(
            {name for name, output in loop.members if output in self.nodes[name].fmu.undeclared}
        )
        message = (
            "there is an algebraic loop: "
            + " => ".join(steps)
            + f" => {_path(loop.circle[0])}; set loop_tolerance to iterate it"
        )
        if undeclared:
            message += (
                f", or, as {', '.join(undeclared)} declares no dependencies of its outputs (each "
                "then counts as depending on all inputs), say what they are with "
                "scene.add(..., feedthrough=...)"
            )
        return message


def _passing(order: list[str], edges: dict[str, dict[str, bool]]) -> set[str]:
    """Components whose outputs go on within the step in gauss_seidel.

    Those that are in a circle with everything they drive later on. What a mere source puts out is
    held from the start of the step, and so is all that a component gives whose outputs follow
    their inputs directly: the values that a component gets from another belong to one time.
    """
    circles = {
        name: i
        for i, group in enumerate(components({name: list(edges.get(name, ())) for name in order}))
        for name in group
    }
    rank = {name: i for i, name in enumerate(order)}
    return {
        name
        for name in order
        if all(
            circles[target] == circles[name] and not strong
            for target, strong in edges.get(name, {}).items()
            if rank[target] > rank[name]
        )
    }
