"""Orders of evaluation: levels of direct feedthrough, algebraic loops, orders of stepping.

Names here are any hashable; nothing is known of FMUs.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

__all__ = ["Loop", "components", "levels", "stepping_order", "two_groups"]

T = TypeVar("T", bound=Hashable)


@dataclass(frozen=True)
class Loop(Generic[T]):
    """Outputs that depend on one another at one time: all of them, and one circle to show."""

    members: list[T]
    circle: list[T]


def components(successors: Mapping[T, Iterable[T]]) -> list[list[T]]:
    """Strongly connected components, each after those that lead to it (Tarjan 1972).

    Written without recursion: chains of thousands of components are ordinary.
    """
    index: dict[T, int] = {}
    low: dict[T, int] = {}
    on_stack: set[T] = set()
    stack: list[T] = []
    found: list[list[T]] = []
    for root in successors:
        if root in index:
            continue
        index[root] = low[root] = len(index)
        stack.append(root)
        on_stack.add(root)
        work = [(root, iter(successors[root]))]
        while work:
            node, following = work[-1]
            for other in following:
                if other not in successors:
                    continue
                if other not in index:
                    index[other] = low[other] = len(index)
                    stack.append(other)
                    on_stack.add(other)
                    work.append((other, iter(successors[other])))
                    break
                if other in on_stack:
                    low[node] = min(low[node], index[other])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    group = []
                    while True:
                        member = stack.pop()
                        on_stack.discard(member)
                        group.append(member)
                        if member == node:
                            break
                    found.append(group[::-1])
    return found[::-1]


def levels(
    depends: Mapping[T, Iterable[T]], at_least: Mapping[T, int]
) -> tuple[dict[T, int], list[Loop[T]]]:
    """Level of each output, and the algebraic loops.

    depends: output -> outputs that it depends on through direct feedthrough.
    at_least: output -> smallest level (0 for a function of the state alone, 1 when an input that
        is driven enters).
    An output's level is above that of every output it depends on; those of one loop share theirs.
    """
    feeds: dict[T, list[T]] = {node: [] for node in depends}
    for node, sources in depends.items():
        for source in sources:
            feeds[source].append(node)
    result: dict[T, int] = {}
    loops: list[Loop[T]] = []
    for group in components(feeds):
        members = set(group)
        level = 0
        for node in group:
            level = max(level, at_least.get(node, 0))
            for source in depends[node]:
                if source not in members:
                    level = max(level, result[source] + 1)
        for node in group:
            result[node] = level
        if len(group) > 1 or group[0] in feeds[group[0]]:
            loops.append(Loop(group, _circle(group, feeds)))
    return result, loops


def _circle(group: Sequence[T], feeds: Mapping[T, Sequence[T]]) -> list[T]:
    """A shortest circle through the group's first member, in the order of driving."""
    members = set(group)
    start = group[0]
    came: dict[T, T] = {}
    frontier = [start]
    while frontier:
        following = []
        for node in frontier:
            for other in feeds[node]:
                if other == start:
                    circle = [node]
                    while circle[-1] != start:
                        circle.append(came[circle[-1]])
                    return circle[::-1]
                if other in members and other not in came:
                    came[other] = node
                    following.append(other)
        frontier = following
    return list(group)


def stepping_order(names: Sequence[T], edges: Mapping[T, Mapping[T, bool]]) -> list[T]:
    """Order in which to step: sources before what they drive, wherever there is no circle.

    edges: source -> target -> whether an output with direct feedthrough is among the connections.
    In a circle the components whose feedthrough outputs are used come before their users (their
    other outputs are known at the start of the step anyway); what is left goes by the given order.
    """
    rank = {name: i for i, name in enumerate(names)}

    def sort(group: Sequence[T], strong_only: bool) -> list[T]:
        members = set(group)
        successors = {
            a: sorted(
                (
                    b
                    for b, strong in edges.get(a, {}).items()
                    if b in members and b != a and (strong or not strong_only)
                ),
                key=rank.__getitem__,
                reverse=True,
            )
            for a in sorted(group, key=rank.__getitem__, reverse=True)
        }
        ordered: list[T] = []
        for part in components(successors):
            if len(part) == 1:
                ordered += part
            elif strong_only:
                ordered += sorted(part, key=rank.__getitem__)
            else:
                ordered += sort(part, True)
        return ordered

    return sort(names, False)


def two_groups(
    names: Sequence[T], edges: Mapping[T, Iterable[T]]
) -> tuple[list[T], list[T]] | None:
    """Two groups such that every edge leads from one to the other, or None; unjoined: the first."""
    neighbours: dict[T, set[T]] = {name: set() for name in names}
    for a, targets in edges.items():
        for b in targets:
            neighbours[a].add(b)
            neighbours[b].add(a)
    side: dict[T, int] = {}
    for root in names:
        if root in side:
            continue
        side[root] = 0
        work = [root]
        while work:
            node = work.pop()
            for other in neighbours[node]:
                if other not in side:
                    side[other] = 1 - side[node]
                    work.append(other)
                elif side[other] == side[node]:
                    return None
    return [n for n in names if side[n] == 0], [n for n in names if side[n] == 1]
