"""Outputs reach inputs in initialization mode, by the dependencies declared for it."""

from __future__ import annotations

import pytest

from curvebound.cosim import Scene
from curvebound.errors import CurveboundError


@pytest.fixture(scope="module")
def latch_fmu(build_fmu):
    return build_fmu("latch")


def test_a_chain_is_consistent_when_initialization_ends(latch_fmu, gain_fmu):
    scene = Scene("chain", stop_time=1.0, step=0.5)
    for i in (3, 1, 2):  # in no helpful order
        scene.add(f"latch{i}", latch_fmu)
    scene.add("gain", gain_fmu, {"gain": 2.0})
    scene.input("gain.u", lambda t: 21.0 + t)
    scene.connect("gain.y", "latch1.u", 1.0)
    scene.connect("latch1.y", "latch2.u").connect("latch2.y", "latch3.u")
    result = scene.record("gain.y", "latch3.y").run()
    assert list(result["gain.y"]) == [42.0, 43.0, 44.0]
    assert list(result["latch3.y"]) == [42.0, 42.0, 42.0]
    # what is direct in initialization is a state's output afterwards
    system = scene.check()
    outputs = [("gain", "y"), ("latch1", "y"), ("latch2", "y"), ("latch3", "y")]
    assert [system.initial_levels[port] for port in outputs] == [1, 2, 3, 4]
    assert [system.levels[port] for port in outputs] == [1, 0, 0, 0]


def test_a_loop_of_initialization_alone_is_found(latch_fmu):
    scene = Scene("ring", stop_time=1.0, step=0.5).add("a", latch_fmu).add("b", latch_fmu)
    scene.connect("a.y", "b.u").connect("b.y", "a.u", 0.5, 1.0)
    with pytest.raises(CurveboundError, match="algebraic loop"):
        scene.check()
    scene.loop_tolerance = 1e-9
    assert list(scene.record("a.y").run()["a.y"]) == pytest.approx([2.0, 2.0, 2.0])


def test_jacobi_carries_a_value_one_component_per_step(latch_fmu, gain_fmu):
    """Without feedthrough each component hands on at the next communication point only."""
    scene = Scene("relay", stop_time=2.0, step=0.5, algorithm="jacobi")
    for i in range(3):
        scene.add(f"g{i}", gain_fmu, feedthrough=False)
        if i:
            scene.connect(f"g{i - 1}.y", f"g{i}.u", 1.0)
    scene.input("g0.u", lambda t: float(t >= 0.5))
    result = scene.record("g2.y").run()
    assert list(result["g2.y"]) == [0.0, 0.0, 0.0, 0.0, 1.0]
