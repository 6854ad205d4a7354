"""What a step costs, as ratios in one run, and how cost grows with the number of components."""

from __future__ import annotations

import time
from statistics import median

import fmpy
import numpy as np
import pytest
from benchmarks.macro_step import costs

from curvebound.cosim import Scene, load_scene
from curvebound.cosim.fmu import extracted


@pytest.mark.slow
def test_a_macro_step_costs_less_than_half_of_simulate_ssp(monkeypatch):
    from benchmarks import macro_step as compare

    monkeypatch.setattr(compare, "TOOLS", {"simulate_ssp": compare.TOOLS["simulate_ssp"]})
    scene = load_scene("swaying_parabola")
    assert len(scene.check().recorded) == 8
    found = costs(scene, steps=5000, rounds=5)
    assert found["curvebound gauss_seidel"] < 0.5 * found["simulate_ssp"], found


def ring(mass_fmu, count):
    scene = Scene("ring", stop_time=0.05, step=1e-3)
    for i in range(count):
        scene.add(f"m{i}", mass_fmu, {"x_start": float(i % 7)})
    for i in range(count):
        scene.connect(f"m{i}.x", f"m{(i + 1) % count}.other")
    return scene.record("m0.x", f"m{count - 1}.v")


@pytest.mark.slow
def test_a_thousand_components(mass_fmu):
    """Set-up under 30 s; cost per macro step linear in the number of components."""
    counts = [10, 100, 1000]
    cost = []
    for count in counts:
        began = time.perf_counter()
        with ring(mass_fmu, count).prepare() as prepared:
            first = prepared.run(stop_time=1e-3)
            setup = time.perf_counter() - began
            assert setup < 30.0
            rounds = [prepared.run() for _ in range(3)]
            cost.append(min(r.stepping / r.steps for r in rounds))
            assert first.steps == 1
            assert len(rounds[0].names) == 2
    exponent = np.polyfit(np.log(counts), np.log(cost), 1)[0]
    # an interpreted slave costs somewhat more when a thousand of them do not fit into the cache
    assert 0.8 < exponent < 1.25, cost


@pytest.mark.slow
def test_prepared_runs_beat_simulate_fmu_by_name():
    """A sweep's throughput: instances reset and reused, against fmpy with a file name each time."""
    scene = load_scene("bead_on_wire")
    scene.stop_time = 0.5
    node = scene.check().nodes["bead"]
    output = [port[1] for port in scene.check().recorded]
    ours, fmpys = [], []
    with scene.prepare() as prepared:
        prepared.run()
        for i in range(5):
            angle = 0.1 * (i + 1)
            began = time.perf_counter()
            result = prepared.run({"bead.bead.angle_start": angle})
            ours.append(time.perf_counter() - began)
            began = time.perf_counter()
            reference = fmpy.simulate_fmu(
                str(node.fmu.path), stop_time=0.5, output_interval=0.01, output=output,
                start_values={**node.start, "bead.angle_start": angle},
            )  # fmt: skip
            fmpys.append(time.perf_counter() - began)
            assert np.max(np.abs(result["bead.bead.x"] - reference["bead.x"])) < 1e-12
    assert median(fmpys) > 5.0 * median(ours), (fmpys, ours)


@pytest.mark.parametrize("name", ["bead_on_wire", "active_damping", "vibrated_upright"])
def test_reuse_gives_the_same_bits_as_a_new_instance(name):
    scene = load_scene(name)
    scene.stop_time = 0.3
    path = "bead.bead.angle_start" if name == "bead_on_wire" else "plant.slider.u_start"
    fresh = [scene.copy().set(path, v).run() for v in (0.2, 0.3)]
    with scene.prepare() as prepared:
        prepared.run()
        for value, expected in zip((0.2, 0.3), fresh, strict=True):
            assert np.array_equal(prepared.run({path: value}).data, expected.data)


def test_an_fmu_is_unpacked_once(mass_fmu):
    fmu = ring(mass_fmu, 2).check().nodes["m0"].fmu
    assert extracted(fmu) == extracted(fmu)


def test_many_runs_leave_nothing_behind(mass_fmu):
    """Prepared calls are made once, not once per run."""
    with ring(mass_fmu, 3).prepare() as prepared:
        prepared.run(stop_time=5e-3)
        calls, kept = len(prepared.exchange._calls), len(prepared.exchange._kept)
        for _ in range(50):
            prepared.run(stop_time=5e-3)
        assert (len(prepared.exchange._calls), len(prepared.exchange._kept)) == (calls, kept)
