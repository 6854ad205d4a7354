"""An interrupt of the whole process group ends the workers, and they say nothing."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from curvebound.cli import main

SCRIPT = """
import os, signal, time
from curvebound.study.stability.workers import without_interrupts, workers
signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs in the background ignore it
try:
    with workers(2) as pool:
        with without_interrupts():
            futures = [pool.submit(time.sleep, 60) for _ in range(2)]
            os.killpg(0, signal.SIGINT)  # held back here; the workers are still starting
            print("submitted")
        print("not reached")
except KeyboardInterrupt:
    print("stopped")
"""


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="needs process groups")
def test_workers_leave_interrupts_to_their_parent() -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        capture_output=True,
        text=True,
        start_new_session=True,
        timeout=50,
        check=True,
    )
    assert (done.stdout, done.stderr) == ("submitted\nstopped\n", "")


def test_an_interrupted_command_claims_no_more_than_it_keeps(monkeypatch, capsys) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("curvebound.study.stability.sample.run_sample", interrupted)
    assert main(["sample", "--points", "2", "--out", "."]) == 1
    assert "nothing else is kept" in capsys.readouterr().err
    monkeypatch.setattr("curvebound.cosim.scene_names", interrupted)
    assert main(["list"]) == 1
    assert capsys.readouterr().err == "error: stopped by the keyboard\n"
