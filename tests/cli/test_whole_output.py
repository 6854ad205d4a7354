"""What commands print, word for word and number for number."""

from __future__ import annotations

import json
import math
from types import SimpleNamespace
from typing import Any

import pytest
from fingerprints import assert_same

from curvebound.cli import main, tune


@pytest.mark.parametrize(
    "words",
    [
        ["list"], ["list", "--json"], ["list", "BeadOnWire"], ["list", "inverted_balance"],
        ["show", "BeadOnWire"], ["show", "ParabolaDrive", "--json"], ["show", "ParabolaPendulum"],
        ["show", "inverted_balance"], ["show", "inverted_balance", "--json"],
        ["show", "sampled_feedback"], ["show", "bead_on_wire", "--json"],
        ["show", "two_wires"], ["show", "shaken_wire"],
        ["show", "model.formulation", "--json"], ["show", "model.formulation"],
        *(pytest.param(["show", name], marks=pytest.mark.slow)
          for name in ("bead.damping", "slider.fx", "pendulum.angle", "solver.tolerance")),
        ["linearize", "active_damping"], ["linearize", "active_damping", "--json"],
        ["linearize", "inverted_balance"],
    ],
    ids=" ".join,
)  # fmt: skip
def test_what_is_printed(
    words: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    status = main(words)
    heard = capsys.readouterr()
    assert_same(f"curvebound {' '.join(words)}", f"{status}\n{heard.out}\n{heard.err}")


def candidate(label: str, **more: Any) -> Any:
    values = {"step": 0.01, "algorithm": "jacobi", "hold": "first", "coupling": "jacobi"}
    setting = SimpleNamespace(label=label, **{**values, **more})
    return SimpleNamespace(
        setting=setting, cpu=0.25, seen=0.5, miss=3.0, starts=7,
        verdicts={"a.x": SimpleNamespace(worst=2e-4), "a.y": SimpleNamespace(worst=0.03)},
    )  # fmt: skip


CHOICES: dict[str, dict[str, Any]] = {
    "sure": {},
    "unsure": {"sure": False, "cheaper": None},
    "nothing fits": {"chosen": None, "advice": "a smaller step"},
    "nothing fits, no advice": {"chosen": None, "advice": "", "cheaper": None, "until": 4.0},
    "too dear": {"within_budget": False, "affordable": candidate("other", coupling="gauss_seidel")},
    "too dear, no other": {"within_budget": False},
}


@pytest.mark.parametrize("name", CHOICES)
def test_words_and_data_of_a_choice(name: str) -> None:
    best, cheaper = candidate("rk4 at 1 ms"), candidate("cheap")
    known = {"best": best, "chosen": best, "cheaper": cheaper, "affordable": None, "sure": True,
             "runs": 12, "until": 10.0, "within_budget": True, "advice": ""}  # fmt: skip
    choice = SimpleNamespace(**{**known, **CHOICES[name]})
    scene = SimpleNamespace(name="s", stop_time=10.0)
    bounds, units = {"a.x": 1e-3, "a.y": 0.1}, {"a.x": "m", "a.y": "rad"}
    for budget in (0.1, None):
        words = tune._words(scene, bounds, units, choice, budget)
        assert_same(f"tune {name} {budget}", "\n".join(words))
    data = tune._as_data(scene, bounds, choice, {"a.p": 1.0}, units)
    assert_same(f"tune {name} data", json.dumps(data))


@pytest.mark.parametrize(
    ("text", "expected"),
    [("1e-3", ("", 1e-3)), ("a.x=2", ("a.x", 2.0)), ("=1", None), ("0", None), ("a.x=-1", None),
     ("inf", None), ("a.x", None), ("a.x=nan", None)],
)  # fmt: skip
def test_bounds(text: str, expected: tuple[str, float] | None) -> None:
    if expected is None:
        with pytest.raises(Exception, match="finite bound above zero"):
            tune._bound(text)
    else:
        assert tune._bound(text) == expected
        assert math.isfinite(expected[1])
