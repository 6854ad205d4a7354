"""Each check fails, and says why, on a system with the fault that it is there for."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from curvebound import checks
from curvebound.checking.points import pushes
from curvebound.fmi.folder import find

#: the acceleration as it comes with its derivatives
WITH_THEM = "a0 = self.uy * s + self.ux * c - k * v0"
FAULTS: dict[Callable[[Path], None], tuple[str, str, str]] = {
    checks.kernel_follows_mechanics: (
        "a0 -= k * v0",
        "a0 -= 1.0001 * k * v0",
        "the acceleration of bead.angle is",
    ),
    checks.derivatives_follow_accelerations: (
        "self.a0_q0 = self.uy * c - self.ux * s",
        "self.a0_q0 = self.uy * c",
        r"jacobian\(\) sets a0_q0 to \S+, but differences of acceleration\(\) are",
    ),
    checks.changes_follow_outputs: (
        "normal = self.ex * math.sin(self.q0)",
        "normal = self.ex * self.ex * math.sin(self.q0)",
        "wire.fx changes by",
    ),
    checks.rates_follow_outputs: (
        "return unwind(self.q0, self.turns), self.v0, 0.0",
        "return unwind(self.q0, self.turns), self.v0 - self.vx, 0.0",
        "bead.angle changes by",
    ),
    checks.keeps_the_balance_of_energy: (
        "along = r * a0",
        "along = 1.0001 * r * a0",
        "energy.residual reaches",
    ),
    checks.methods_have_their_orders: (
        "a0 = self.uy * math.sin(q0)",
        "a0 = self.uy * math.sin(q0) + (1.0 if q0 > 1.2 else 0.0)",
        "rk4 has order 4, but its error falls as",
    ),
    checks.saves_its_whole_state: (
        "k = self.k\n        if k",
        "self.k += 1e-6\n        k = self.k\n        if k",
        "differ after fmi2SetFMUstate",
    ),
}


@pytest.mark.usefixtures("short_reference")
@pytest.mark.parametrize("check", FAULTS, ids=lambda check: check.__name__)
def test_a_fault_is_found(check: Callable[[Path], None], tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("curvebound.fmi.compile.why_not", lambda *_, **__: "it takes too long here")
    folder = tmp_path / "bead_on_wire"
    shutil.copytree(find("BeadOnWire").path, folder)
    old, new, said = FAULTS[check]
    source = folder / "angle.py"
    text = source.read_text()
    assert text.count(old) == 1
    text = text.replace(old, new)
    if check is checks.methods_have_their_orders:
        text = text.replace(f"self.{WITH_THEM}", f"self.{WITH_THEM} + (1.0 if q0 > 1.2 else 0.0)")
    source.write_text(text)
    with pytest.raises(AssertionError, match=said) as caught:
        check(folder)
    assert "model.formulation = angle: " in str(caught.value)


@pytest.mark.usefixtures("short_reference", "sampled_here")
def test_a_fault_is_found_at_random_points(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("curvebound.fmi.compile.why_not", lambda *_, **__: "it takes too long here")
    monkeypatch.setattr(checks, "_POINTS", 3)
    folder = tmp_path / "bead_on_wire"
    shutil.copytree(find("BeadOnWire").path, folder)
    source = folder / "angle.py"
    old = "a0 = self.uy * math.sin(q0)"
    text = source.read_text().replace(old, f"{old} * 1.001")
    source.write_text(text.replace("self.uy * s +", "self.uy * s * 1.001 +"))
    with pytest.raises(AssertionError, match="points of its ranges are not accurate") as caught:
        checks.is_right_at_random_points(folder)
    assert "wrong, error" in str(caught.value)


def test_each_input_is_pushed_by_a_sine_of_its_own() -> None:
    pushed = pushes(find("BeadOnWire").fmu())
    at = {name: push(0.5) for name, push in pushed.items()}
    assert at == pytest.approx({
        "wire.ax": math.sin(0.3 * math.pi), "wire.ay": math.sin(0.47 * math.pi),
        "bead.fx": 0.5 * math.sin(0.64 * math.pi), "bead.fy": 0.5 * math.sin(0.81 * math.pi),
    })  # fmt: skip
