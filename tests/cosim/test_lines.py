"""Inputs led along lines: where they are at each communication point, and what is set there."""

from __future__ import annotations

import math
import zipfile
from collections import Counter
from collections.abc import Callable
from ctypes import byref, c_double, c_size_t, c_uint
from pathlib import Path

import numpy as np
import pytest

from curvebound.cosim import Adaptive, Scene
from curvebound.cosim.instance import Library
from curvebound.cosim.prepared import Prepared
from curvebound.cosim.resolution import resolve
from curvebound.cosim.stepwise import Stepwise

STEP = 0.01
ULP = 2.0**-52
COUNTED = ("fmi2DoStep", "fmi2SetReal", "fmi2GetReal", "fmi2SetRealInputDerivatives")


class Watched:
    """Counts calls, and tells where an input is after each step; `after` may meddle with it."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, name: str = "wire.ax") -> None:
        self.calls: Counter[str] = Counter()
        self.inputs: list[float] = []  # before each step
        self.forgets = False
        function = Library.function

        def watching(library: Library, called: str) -> Callable[..., int]:
            real = function(library, called)
            if called not in COUNTED:
                return real

            def call(*arguments: object) -> int:
                self.calls[called] += 1
                if called != "fmi2DoStep":
                    return int(real(*arguments))
                reference = (c_uint * 1)(library.fmu.variables[name].reference)
                value = (c_double * 1)()
                rest = (arguments[0], byref(reference), c_size_t(1), byref(value))
                assert function(library, "fmi2GetReal")(*rest) == 0
                self.inputs.append(value[0])
                status = int(real(*arguments))
                if self.forgets:
                    assert function(library, "fmi2SetReal")(*rest) == 0
                return status

            return call

        monkeypatch.setattr(Library, "function", watching)


@pytest.fixture
def watched(monkeypatch: pytest.MonkeyPatch) -> Watched:
    return Watched(monkeypatch)


def pushed(drive: object, fmu: str | Path = "BeadOnWire", **settings: object) -> Scene:
    """A wire pushed along x for 2 s; its motion is an integral of the drive alone."""
    scene = Scene("pushed", stop_time=2.0, step=STEP, hold="first")
    scene.add("bead", fmu, {"model.formulation": "angle"}).input("bead.wire.ax", drive)
    for name, value in settings.items():
        setattr(scene, name, value)
    return scene.record("bead.wire.x", "bead.wire.vx", "bead.bead.angle")


def said(drive: Callable[[float], float]) -> list[float]:
    return [drive(n * STEP) for n in range(200)]


def smooth(t: float) -> float:
    return 2.0 + math.sin(3.0 * t)


def test_a_smooth_function_is_seldom_set_and_never_left(watched: Watched) -> None:
    """By 1e-6 of how it bends over a step, whatever the number of steps."""
    pushed(smooth).run()
    assert watched.calls["fmi2SetRealInputDerivatives"] == 200
    assert watched.calls["fmi2SetReal"] < 20
    bend = 1e-6 * 9.0 * STEP * STEP
    off = np.abs(np.array(watched.inputs) - said(smooth))
    assert 0.0 < np.max(off) <= bend
    assert np.max(off[-20:]) <= bend


def test_outputs_that_follow_inputs_are_read_once_and_anew_at_jumps(watched: Watched) -> None:
    """Where an input does not rise, a step is a held one, to the last bit."""
    forces = ("bead.constraint.force", "bead.wire.fx", "bead.wire.fy")
    pushed(smooth).record(*forces).run()
    assert watched.calls["fmi2GetReal"] < 225  # in 200 steps
    results = []
    for hold in ("zero", "first"):
        scene = pushed(lambda t: float(int(t / 0.1 + 1e-9) % 3), hold=hold).record(*forces)
        scene.input("bead.bead.fy", lambda t: 1.0 if t < 1.0 - 1e-9 else -2.0)
        results.append(scene.run().data)
    assert np.array_equal(*results)


@pytest.mark.parametrize("jump", [4.0 * ULP, 1e-12, 1e-6])
@pytest.mark.parametrize("drive", [lambda t: 1.0, lambda t: 1.0 + t], ids=["constant", "linear"])
def test_a_jump_that_nobody_tells_of_is_met(watched: Watched, drive, jump: float) -> None:
    def jumping(t: float) -> float:
        return drive(t) + (jump if t > 1.0 - 1e-9 else 0.0)

    pushed(jumping).run()
    assert watched.inputs == pytest.approx(said(jumping), rel=2.0 * ULP, abs=0.0)
    assert watched.inputs[100] == jumping(1.0)


def test_a_jump_of_a_smooth_function_is_met_beyond_what_it_bends(watched: Watched) -> None:
    def jumping(t: float) -> float:
        return smooth(t) + (3e-9 if t > 0.5 - 1e-9 else 0.0)

    pushed(jumping).run()
    assert watched.inputs[50] == jumping(0.5)


def test_a_table_is_met_at_every_point(watched: Watched) -> None:
    """A jump that is small beside the corner before it, too."""
    times = [0.0, 0.49, 0.5, 0.5, 1.0, 2.0]
    table = (times, [0.0, 0.0, 1.0, 1.0 + 1e-9, 7.0, 7.0])
    pushed(table).run()
    expected = np.interp(np.arange(200) * STEP, times, table[1])
    expected[50] = 1.0 + 1e-9
    assert watched.inputs == pytest.approx(list(expected), rel=1e-13, abs=1e-15)
    assert watched.calls["fmi2SetReal"] < 120  # not where it is constant


@pytest.mark.parametrize("step", [0.25, 0.1, 0.01, 0.0025])
def test_rising_with_time(step: float) -> None:
    """a = t for 2 s: 4/3 m, whatever the step; held, it comes to 1.2350 m at 0.1 s."""
    assert pushed(lambda t: t, step=step).run()["bead.wire.x"][-1] == pytest.approx(
        4.0 / 3.0, rel=1e-13
    )


def test_a_run_begins_anew(watched: Watched) -> None:
    """Where the last run left the input, an FMU that was reset is not."""
    with Prepared(pushed(lambda t: 3.0)) as prepared:
        results = [prepared.run() for _ in range(3)]
    assert set(watched.inputs) == {3.0}
    for result in results:
        assert result["bead.wire.vx"][-1] == pytest.approx(6.0, rel=1e-13)
        assert np.array_equal(result.data, results[0].data)


def test_going_back_gives_the_same_bits() -> None:
    """A saved state has the lines: what follows it is what follows without going back."""
    with Stepwise(pushed(smooth)) as scene:
        scene.begin()
        for _ in range(150):
            moment = scene.save()
            for _ in range(10):
                scene.step()
            scene.restore(moment)
            scene.step()
            scene.drop(moment)
        row = scene.row().copy()
    assert list(row) == list(pushed(smooth, stop_time=1.5).run().data[-1])


def test_trials_of_adaptive_steps_are_undone(watched: Watched) -> None:
    """Each step begins where the one before it, that was kept, has led."""
    result = pushed(smooth, adaptive=Adaptive(1e-6), stop_time=1.0).run()
    assert result.rejected > 0
    expected = 2.0 + (1.0 - math.cos(3.0)) / 3.0
    assert result["bead.wire.vx"][-1] == pytest.approx(expected, abs=1e-6)


def foreign(fmu: Path, folder: Path) -> Path:
    """The bead on a wire as if another tool had made it."""
    copy = folder / "Foreign.fmu"
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(copy, "w") as target:
        for entry in source.infolist():
            data = source.read(entry)
            if entry.filename == "modelDescription.xml":
                data = data.replace(b'generationTool="curvebound ', b'generationTool="other ')
            target.writestr(entry, data)
    return copy


@pytest.mark.parametrize("drive", [smooth, lambda t: 2.0 - t, lambda t: 5.0])
def test_an_fmu_that_does_not_say_that_it_keeps_its_inputs(
    watched: Watched, fmus: Path, tmp_path: Path, drive
) -> None:
    """FMI leaves open where an input is after a slope: it is set at every point."""
    ours = pushed(drive).run()
    watched.inputs.clear()
    watched.forgets = True  # back to where it was before the step
    others = pushed(drive, foreign(fmus / "BeadOnWire.fmu", tmp_path)).run()
    assert watched.inputs == said(drive)
    for name in ours.names:
        assert others[name] == pytest.approx(ours[name], rel=1e-8, abs=1e-9)


def test_several_inputs_of_one_fmu(watched: Watched) -> None:
    """Each is set on its own, and only where its function left the line."""
    scene = pushed(lambda t: 1.0).input("bead.wire.ay", lambda t: 3.0 - (t < 1.0 - 1e-9))
    scene.input("bead.bead.fx", smooth).record("bead.wire.vy").run()
    assert watched.inputs == [1.0] * 200
    assert watched.calls["fmi2SetReal"] < 40
    assert scene.run()["bead.wire.vy"][-1] == pytest.approx(5.0, rel=1e-13)


def test_outputs_that_are_connected_belong_to_their_inputs() -> None:
    """Gauss-Seidel hands on what follows the state alone: these go on being read apart."""
    scene = pushed(smooth).add("two", "BeadOnWire").connect("bead.wire.fy", "two.bead.fy")
    levels = resolve(scene.record("bead.wire.fx", "two.wire.fx")).levels
    assert levels["bead", "wire.fx"] == levels["bead", "wire.x"] == 0
    assert levels["bead", "wire.fy"] == 1
    assert levels["two", "wire.fx"] == 2


def test_an_input_beside_connected_ones(watched: Watched) -> None:
    """All are set together at every point; slopes that are set twice in a step are asked once."""
    asked: list[float] = []

    def drive(t: float) -> float:
        asked.append(t)
        return smooth(t)

    scene = pushed(drive, loop_tolerance=1e-10).add("two", "BeadOnWire", {"bead.angle_start": 1.0})
    scene.connect("two.bead.angle", "bead.wire.ay", factor=0.1)
    scene.connect("bead.wire.fy", "two.bead.fy", factor=0.1)
    scene.connect("two.wire.fx", "bead.bead.fx", factor=0.1)
    scene.run()
    assert said(smooth) in (watched.inputs[::2], watched.inputs[1::2])
    assert len(asked) <= 2 * 200 + 3
