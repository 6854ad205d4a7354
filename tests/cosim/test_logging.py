"""What FMUs say reaches the scene that they belong to, and other users of fmpy undisturbed."""

from __future__ import annotations

import subprocess
import sys

from curvebound.cosim import Scene

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
