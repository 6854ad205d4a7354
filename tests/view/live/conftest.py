"""Scenes to touch, and the FMU instances that they make."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from curvebound.cosim import load_scene
from curvebound.cosim.instance import Instance
from curvebound.view.live.plan import Plan


@pytest.fixture(scope="session")
def plan_of() -> Callable[[str], Plan]:
    """The plan of a scene by name; made once, as sessions do not change it."""
    plans: dict[str, Plan] = {}

    def of(name: str) -> Plan:
        if name not in plans:
            plans[name] = Plan(load_scene(name))
        return plans[name]

    return of


@pytest.fixture
def instances(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Instance]]:
    """Every instance that is made meanwhile; at the end all of them must have been freed."""
    made: list[Instance] = []

    class Counted(Instance):
        def __init__(self, *arguments: object) -> None:
            super().__init__(*arguments)  # type: ignore[arg-type]
            made.append(self)

    monkeypatch.setattr("curvebound.cosim.prepared.Instance", Counted)
    yield made
    assert made
    assert not any(one.alive for one in made)
