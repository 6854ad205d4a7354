"""Ctrl-C while an FMU computes: it reaches the host, and the FMU has made whole steps."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

_HOST = """
import os, random, signal, sys, threading
from pathlib import Path
from harness import Extracted, Instance

signal.signal(signal.SIGINT, signal.default_int_handler)
fmu, settings, longest = Extracted(Path(sys.argv[1])), eval(sys.argv[2]), float(sys.argv[3])
count, traced = int(sys.argv[4]), sys.argv[5] == "interpreted"
H = 1 / 128
random.seed(1)


def new():
    instance = Instance(fmu)
    return instance.start(settings)


steady, expected = new(), []
expected.append(steady.bits())


def interrupt():
    os.kill(os.getpid(), signal.SIGINT)


# An interrupt after a time: it arrives wherever the process is then. The timer's thread has its
# turn when the host's gives it up, which may be outside the FMU's code each time.
class Timer(threading.Timer):
    def __init__(self):
        super().__init__(random.random() * longest, interrupt)


# An interrupt at one of the next calls within the FMU's own code.
class Call:
    def __init__(self):
        self.left = random.randrange(1, 1000)

    def start(self):
        sys.settrace(self.called)

    def called(self, frame, *_):
        self.left -= frame.f_code.co_filename.startswith(str(fmu.folder))
        if not self.left:
            interrupt()

    def join(self):
        sys.settrace(None)
        assert len(instance.errors) == 1


instance, arrived, inside = new(), 0, 0
while arrived < count:
    sender = Call() if traced and arrived % 2 else Timer()
    try:
        sender.start()
        while True:
            time = instance.slave.getRealStatus(2)
            instance.slave.doStep(time, H)
    except KeyboardInterrupt:
        arrived += 1
    sender.join()
    inside += len(instance.errors)
    assert all("interrupted by KeyboardInterrupt" in text for text in instance.errors)
    instance.messages.clear()
    done = round(instance.slave.getRealStatus(2) / H)
    while len(expected) <= done:
        steady.slave.doStep((len(expected) - 1) * H, H)
        expected.append(steady.bits())
    assert instance.bits() == expected[done], (arrived, done)
print(arrived, inside, done)
"""


def run(path: Path, settings: dict[str, object], longest: float, count: int, how: str) -> int:
    """Send `count` interrupts and check each; the number that arrived in the FMU's code."""
    done = subprocess.run(
        [sys.executable, "-c", _HOST, str(path), repr(settings), str(longest), str(count), how],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parent)},
        capture_output=True,
        text=True,
        timeout=300,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    assert done.returncode == 0, f"{done.stdout[-1000:]}\n{done.stderr[-3000:]}"
    arrived, inside, steps = map(int, done.stdout.split())
    assert arrived == count
    assert steps > 0
    return inside


PLANTS = {
    "BeadOnWire": {"solver.step": 1e-5},
    "ParabolaPendulum": {"solver.method": "adaptive", "solver.tolerance": 1e-12},
}
CASES = pytest.mark.parametrize(
    ("name", "count"),
    [
        ("BeadOnWire", 20),
        *(pytest.param(name, 100, marks=pytest.mark.slow) for name in PLANTS),
    ],
)


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent as on POSIX")
@CASES
def test_every_interrupt_arrives_where_the_code_is_compiled(fmus, name: str, count: int) -> None:
    run(fmus / f"{name}.fmu", PLANTS[name], 0.004, count, "compiled")


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent as on POSIX")
@CASES
def test_every_interrupt_arrives_where_the_code_is_interpreted(
    interpreted_fmus, name: str, count: int
) -> None:
    settings = {**PLANTS[name], **({"solver.step": 1e-4} if name == "BeadOnWire" else {})}
    inside = run(interpreted_fmus / f"{name}.fmu", settings, 0.01, count, "interpreted")
    assert inside >= count // 2, "half of them are sent there"
