"""What FMUs say reaches the scene that they belong to, and other users of fmpy undisturbed."""

from __future__ import annotations

import ctypes
import subprocess
import sys

from curvebound.cosim import Scene
from curvebound.cosim.instance import DISCARD, ERROR, FATAL, WARNING, Log, status_name

AFTER = """
import gc, sys
import fmpy
from curvebound.cosim import Scene
scene = Scene("first", stop_time=1.0, step=0.5)
scene.add("a", "BeadOnWire", {"solver.method": "explicit_euler", "solver.step": 0.1})
path = str(scene.check().nodes["a"].fmu.path)
assert any("energy.residual" in note for note in scene.run().notes)
del scene
gc.collect()
said = []
start = {"solver.method": 1, "solver.step": 0.1}
settings = {"stop_time": 1.0, "output_interval": 0.5, "start_values": start, "debug_logging": True}
fmpy.simulate_fmu(path, **settings)
fmpy.simulate_fmu(path, logger=lambda *message: said.append(message[4]), **settings)
assert any(b"energy.residual" in text for text in said), said
print("still there")
"""


def test_fmpy_works_after_a_scene_has_gone():
    """Its logger is one for the process: no scene leaves its own behind in it."""
    done = subprocess.run(
        [sys.executable, "-c", AFTER], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, (done.returncode, done.stderr[-2000:])
    assert "energy.residual" in done.stdout  # fmpy prints what it is told
    assert "still there" in done.stdout


def test_two_scenes_at_once_keep_their_messages_apart():
    def warned(name, step):
        scene = Scene(name, stop_time=1.0, step=0.5)
        start = {"solver.method": "explicit_euler", "solver.step": step}
        return scene.add(name, "BeadOnWire", start).record("*.bead.x")

    with warned("one", 0.1).prepare() as one, warned("two", 1e-4).prepare() as two:
        for _ in range(2):
            coarse, fine = one.run(), two.run()
            assert any(note.startswith("one: energy.residual") for note in coarse.notes)
            assert not any("energy.residual" in note for note in fine.notes)


def test_a_log_gives_an_fmu_memory_and_takes_it_back() -> None:
    callbacks = Log().callbacks
    for function in (callbacks.allocateMemory, callbacks.freeMemory, callbacks.logger):
        assert ctypes.cast(function, ctypes.c_void_p).value
    place = callbacks.allocateMemory(4, 8)
    assert ctypes.string_at(place, 32) == bytes(32)
    callbacks.freeMemory(place)


def test_messages_go_to_the_log_of_their_scene() -> None:
    one, other = Log(), Log()
    for log, text in ((one, b"mine "), (other, b"yours")):
        environment = log.callbacks.componentEnvironment
        log.callbacks.logger(environment, b"plant", WARNING, b"logStatusWarning", text)
    assert one.entries == [("plant", WARNING, "mine")]
    assert other.entries == [("plant", WARNING, "yours")]


def test_what_is_kept_of_messages() -> None:
    """Different ones, from warnings on, 200 of them and why it failed in any case."""
    log = Log()
    log.write(b"plant", 0, b"all is well")
    for _ in range(2):
        log.write(b"plant", WARNING, b"once")
    log.write(b"other", WARNING, b"once")
    log.write(b"plant", DISCARD, b"no further")
    log.write(b"plant", ERROR, b"broken \xff")
    assert log.warnings() == ["plant: once", "other: once"]
    assert log.cause("plant") == "broken \ufffd"
    assert log.cause("plant", FATAL) == ""
    assert log.cause("other") == ""
    assert log.cause("other", WARNING) == "once"
    for k in range(300):
        log.write(b"plant", WARNING, b"%d" % k)
    assert len(log.entries) == 200
    log.write(b"plant", DISCARD, b"at last")
    assert log.entries[-1] == ("plant", DISCARD, "at last")
    log.clear()
    assert log.entries == []


def test_names_of_status() -> None:
    assert [status_name(k) for k in (-1, 0, 1, 2, 3, 4, 5, 6)] == [
        "fmi2-1", "fmi2OK", "fmi2Warning", "fmi2Discard", "fmi2Error", "fmi2Fatal", "fmi2Pending",
        "fmi26",
    ]  # fmt: skip
