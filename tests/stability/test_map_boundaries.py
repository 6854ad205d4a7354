"""Measured maps of the built FMUs: verdicts, boundaries against theory, what ends up on disk."""

from __future__ import annotations

import math
import os
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from benchmarks.catalogue import catalogue
from benchmarks.compact_picture import write_compact

from curvebound.cli import main
from curvebound.cosim import load_scene
from curvebound.errors import CurveboundError
from curvebound.study.stability.maps import Request, make_maps, values_of
from curvebound.study.stability.probe import Probe
from curvebound.study.stability.stability_map import map_column

RADIUS = "bead.wire.radius"
#: bisection, and steps met to about a percent
CLOSE = 0.035
#: semi-implicit Euler swings its energy by 1 / (1 - h w / 2): what is called growth, twenty-fold,
#: it shows 5 % before its end
SWINGING = {"rk4": CLOSE, "semi_implicit_euler": 0.07}


@pytest.fixture(scope="module")
def small_swing():
    """The bead in its angle, from 1e-3 rad: a linear oscillator of sqrt(9.81 / radius) rad/s."""
    scene = load_scene("bead_on_wire")
    scene.set("bead.model.formulation", "angle").set("bead.bead.angle_start", 1e-3)
    with Probe(scene, RADIUS, accuracy=1e-3) as probe:
        yield probe


def sizes(low: float, high: float, count: int = 5) -> list[float]:
    return [low * (high / low) ** (i / (count - 1)) for i in range(count)]


@pytest.mark.parametrize("radius", [pytest.param(0.01, marks=pytest.mark.slow), 0.5])
def test_small_swings_end_where_linear_theory_says(small_swing: Probe, radius: float) -> None:
    omega = math.sqrt(9.81 / radius)
    for method, y in (("rk4", 2.0 * math.sqrt(2.0)), ("semi_implicit_euler", 2.0)):
        column = map_column(small_swing, method, radius, sizes(0.3 / omega, 9.0 / omega))
        assert column.stable * omega == pytest.approx(y, rel=SWINGING[method])
        assert column.stable == pytest.approx(column.at_rest, rel=SWINGING[method])
        assert not column.accurate > 0.5 * column.stable
    grows = math.log(21.0) / (omega * omega * 10.0)  # (1 + (h w)^2)^(10 s/h) = 21
    column = map_column(small_swing, "explicit_euler", radius, sizes(0.1 * grows, 10.0 * grows))
    assert column.stable == pytest.approx(grows, rel=CLOSE)
    assert column.at_rest == pytest.approx(grows, rel=CLOSE)


def test_two_modes_end_with_the_faster() -> None:
    """The linear pendulum: 5.787 rad/s at the defaults, faster with a heavy bob."""
    request = Request(
        "pendulum_large",
        "plant.pendulum.mass=1,1e3",
        (("plant.model.fidelity", "linear"), ("plant.pendulum.angle_start", 0.5)),
        ("semi_implicit_euler", "rk4"),
        stop=100.0,
        steps=(3e-3, 1.0, 6),
    )
    ((_, maps),) = make_maps([request])
    for one, y in zip(maps, (2.0, 2.0 * math.sqrt(2.0)), strict=True):
        assert one.columns[0].at_rest == pytest.approx(y / 5.78735129803610, rel=2e-3)
        for column in one.columns:
            assert column.stable == pytest.approx(column.at_rest, rel=SWINGING[one.method])
    assert maps[0].columns[1].stable < 0.1 * maps[0].columns[0].stable


def test_every_verdict_is_given_its_name(small_swing: Probe) -> None:
    """By the size of the step alone: RK4 on an oscillator of 3.13 rad/s."""
    assert small_swing.run(1.0, "rk4", 1e-3).kind == "accurate"
    assert small_swing.run(1.0, "rk4", 0.5).kind == "inaccurate"
    grown = small_swing.run(1.0, "rk4", 0.95)
    assert grown.kind == "unstable"
    assert grown.energy > 10.0
    scene = load_scene("bead_on_wire").set("bead.bead.damping", 1e6)
    with Probe(scene, RADIUS, accuracy=1e-3) as probe:
        failed = probe.run(1.0, "explicit_euler", 0.01)
    assert failed.kind == "failed"
    assert "solver.step" in failed.message


def test_states_that_grow_are_unstable_where_the_energy_balance_is_kept() -> None:
    """A loop sampled more slowly than every 0.434 s drives its plant away: the plant's own energy
    balance, the work of the drive included, holds all the same."""
    scene = load_scene("active_damping").set("drive.limit.acceleration", 1e300)
    scene.set("plant.model.fidelity", "linear")
    with Probe(scene, "plant.pendulum.length", accuracy=1e-2) as probe:
        assert probe.run(1.0, "implicit", 2e-3).kind == "accurate"
        assert probe.run(1.0, "implicit", 0.3).kind == "inaccurate"
        found = probe.run(1.0, "implicit", 0.5)
    assert found.kind == "unstable"
    assert found.energy < 0.1


def test_adaptive_is_mapped_over_its_tolerance(small_swing: Probe) -> None:
    column = map_column(small_swing, "adaptive", 1.0, [1e-8, 1e-5, 1e-2])
    assert column.accurate > 1e-5
    assert column.stable == math.inf
    assert math.isnan(column.at_rest)


#: by FMU and variable: the least and the largest value that its map must hold
RANGES = {
    ("BeadOnWire", "wire.radius"): (1e-3, 1e3),
    ("BeadOnWire", "bead.damping"): (0.0, 1e6),
    ("BeadOnWire", "bead.angular_velocity_start"): (0.0, 1e3),
    ("BeadOnWire", "gravity.y"): (-1e3, 1e3),
    ("ParabolaPendulum", "pendulum.mass"): (1e-8, 1e8),
    ("ParabolaPendulum", "parabola.coefficient_start"): (-1e4, 1e4),
    ("ParabolaPendulum", "pendulum.length"): (1e-3, 1e3),
    ("ParabolaPendulum", "slider.damping"): (0.0, 1e6),
    ("ParabolaPendulum", "pendulum.damping"): (0.0, 1e6),
    ("ParabolaPendulum", "slider.u_rate_start"): (0.0, 1e3),
    ("ParabolaPendulum", "pendulum.angular_velocity_start"): (0.0, 1e3),
    ("ParabolaPendulum", "gravity.y"): (-1e3, 1e3),
}


def test_the_catalogue_covers_the_ranges() -> None:
    found = {(one.fmu, one.axis.path.partition(".")[2]): values_of(one) for one in catalogue()}
    assert {key: (min(v), max(v)) for key, v in found.items()} == RANGES
    for key in found:
        if "gravity" in key[1] or "coefficient" in key[1]:
            assert 0.0 in found[key]


def test_the_documented_picture_is_small_and_whole(tmp_path) -> None:
    one = catalogue(("rk4",))[0]
    few = [Request.axis.fget(one).items[i] for i in (2, 3)]  # type: ignore[attr-defined]
    short = type(one)(
        **{
            **one.__dict__,
            "vary": f"{RADIUS}={few[0]},{few[1]}",
            "durations": (0.5, 1.0),
            "steps": (1e-2, 0.3, 3),
        }
    )
    found = list(make_maps([short]))
    assert [c.duration for c in found[0][1][0].columns] == [0.5, 1.0]
    (path,) = write_compact(found, tmp_path)
    assert path == tmp_path / "bead_on_wire" / "stability.svg"
    root = ElementTree.fromstring(path.read_text())
    assert root.tag.endswith("svg")
    assert path.stat().st_size < 4000
    assert "var(--ink, " in path.read_text()
    assert "NaN" not in path.read_text()
    assert "inf" not in path.read_text()


class Deadly(Request):
    """A request whose map ends every process but this one."""

    def probe(self) -> Probe:
        if os.getpid() != int(os.environ["CURVEBOUND_TEST_MAIN"]):
            os._exit(3)
        return super().probe()


@pytest.mark.slow
def test_processes_give_the_same_maps_and_their_end_is_told(tmp_path, monkeypatch) -> None:
    vary = ["--vary", "bead.wire.radius=0.5:2:3", "--method", "rk4", "--no-plots"]
    for jobs in ("1", "2"):
        out = ["--jobs", jobs, "--out", str(tmp_path / jobs)]
        assert main(["stability", "bead_on_wire", *vary, *out]) == 0
    for path in (tmp_path / "1" / "bead_on_wire").iterdir():
        assert path.read_bytes() == (tmp_path / "2" / "bead_on_wire" / path.name).read_bytes()
    monkeypatch.setenv("CURVEBOUND_TEST_MAIN", str(os.getpid()))
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
    monkeypatch.setattr(Deadly, "__module__", Path(__file__).stem)
    monkeypatch.setitem(sys.modules, Path(__file__).stem, sys.modules[__name__])
    request = Deadly("bead_on_wire", "bead.wire.radius=1:2:2")
    with pytest.raises(CurveboundError, match=r"made the map of bead\.wire\.radius ended"):
        list(make_maps([request], jobs=2))
