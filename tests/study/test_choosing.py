"""How tuning judges and chooses, on settings whose errors and costs follow known laws."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from benchmarks.promises import MOST

from curvebound.cosim import Scene, load_scene
from curvebound.cosim.scene_parts import ALGORITHMS
from curvebound.study.grid import couplings
from curvebound.study.reference.reference import Reference
from curvebound.study.reference.reference_set import judge
from curvebound.study.settings import Setting, space_of
from curvebound.study.tune.candidate import Candidate
from curvebound.study.tune.ensemble import _STUDENT, Ensemble
from curvebound.study.tune.macro_search import MacroSearch, fraction
from curvebound.study.tune.step_search import coarser, search_size
from curvebound.study.tune.tuner import Tuner

Law = Callable[[Setting], tuple[float, float]]
ORDERS = {"explicit_euler": 1, "semi_implicit_euler": 1, "rk4": 4, "implicit": 4}


def candidate(setting: Setting, miss: float, cpu: float, **more: Any) -> Candidate:
    return Candidate(setting, miss, cpu, miss, **more)


def family(method: str, step: float = 0.1) -> Setting:
    return Setting((), method, None, step, "gauss_seidel")


def followed(method: str, law: Law, give_up: float = math.inf, **more: Any) -> list[float]:
    """The sizes tried."""
    tried = search_size(family(method), lambda s: candidate(s, *law(s)), give_up, **more)
    return [c.setting.size for c in tried if c.setting.size is not None]


@pytest.mark.parametrize("method", ["explicit_euler", "rk4", "implicit"])
def test_a_method_of_known_order_takes_two_runs(method: str) -> None:
    """miss = (size / 1 ms)^order: the second run aims at 0.35 of the bound and meets that."""
    order = ORDERS[method]
    sizes = followed(method, lambda s: ((s.size / 1e-3) ** order, 1e-5))
    wanted = 0.35 ** (1.0 / order) * 1e-3
    assert sizes == [0.1, 0.1 / math.ceil(0.1 / wanted)]


def test_a_tolerance_is_taken_in_quarters_of_a_power_of_ten() -> None:
    sizes = followed("adaptive", lambda s: (s.size / 1e-6, 1e-5))
    assert sizes == pytest.approx([1e-3, 10.0**-6.5])


def test_an_order_other_than_expected_is_measured() -> None:
    """A method that lost an order, as one of order 4 does where its motion has kinks."""
    sizes = followed("rk4", lambda s: ((s.size / 1e-2) ** 3, 1e-5))
    wanted = 0.35 ** (1 / 3) * 1e-2
    assert sizes == [0.1, 0.1 / 8, 0.1 / math.ceil(0.1 / wanted)]


def test_a_family_that_would_cost_too_much_is_dropped() -> None:
    """1 us a step: at 1 ms it costs 1 ms per second, which is known after two runs."""

    def law(setting: Setting) -> tuple[float, float]:
        return (setting.size / 1e-5) ** 1, 1e-4 + 1e-6 / setting.size

    assert len(followed("explicit_euler", law, 1e-3)) == 1
    assert len(followed("explicit_euler", law, 1.0)) == 2
    assert len(followed("explicit_euler", lambda s: (math.inf, 0.1), 0.5)) > 1


def test_what_is_far_below_its_bound_is_made_coarser() -> None:
    first = family("rk4").with_size(1e-4)
    sizes = followed("rk4", lambda s: ((s.size / 1e-3) ** 4, 1e-5), first=first, floor=0.02)
    assert sizes == [1e-4, pytest.approx(1e-3 * 0.35**0.25, rel=0.02)]
    sizes = followed("rk4", lambda s: ((s.size / 1e-3) ** 4, 1e-5), first=first)
    assert sizes == [1e-4]
    assert followed("rk4", lambda s: (0.02, 1e-5), first=first, floor=0.02) == [1e-4]


def test_exact_is_run_once() -> None:
    assert len(search_size(family("exact"), lambda s: candidate(s, 2.0, 1.0), 1.0)) == 1


def test_one_notch_coarser() -> None:
    rk4, adaptive = family("rk4"), family("adaptive")
    notch = coarser(rk4.with_size(0.1 / 131))
    assert notch is not None
    assert notch.size == pytest.approx(0.1 / 99)
    two = coarser(rk4.with_size(0.05))
    assert two is not None
    assert two.size == 0.1
    assert coarser(rk4.with_size(0.1)) is None
    assert coarser(family("exact")) is None
    looser = coarser(adaptive.with_size(1e-5))
    assert looser is not None
    assert looser.size == pytest.approx(1e-4)
    assert coarser(adaptive.with_size(1e-2)) is None


# -- an ensemble of starts ------------------------------------------------------------------------


def ensemble(misses: list[float]) -> Ensemble:
    """Starts whose errors are these multiples of a bound of 1e-3."""

    def glance(setting: Setting, start: dict[str, float]) -> Any:
        outputs = {"x": misses[round(start["a"])]}
        return SimpleNamespace(failure="", times=[0.0, 1.0], cpu=1e-5, outputs=outputs)

    def errors(times: Any, outputs: Any, *, member: int, least: Any) -> Any:
        assert outputs["x"] == misses[member]
        return {"x": SimpleNamespace(worst=1e-3 * misses[member])}

    runner, truths = SimpleNamespace(glance=glance), SimpleNamespace(errors=errors)
    return Ensemble(runner, truths, {"a": np.arange(len(misses))})  # type: ignore[arg-type]


@pytest.mark.parametrize("members", [5, 7, 13])
def test_of_other_starts_is_expected_what_the_spread_says(members: int) -> None:
    """Of errors that are log-normal the next lies below it with a probability of about 0.99."""
    draw = np.random.default_rng(1)
    kept = 0
    for _ in range(1000):
        *misses, following = np.exp(draw.normal(-1.0, 0.5, members + 1))
        kept += following < ensemble(list(misses)).all(family("rk4"), {"x": 1e-3}).miss
    assert 0.975 < kept / 1000 < 0.999


def test_what_is_expected_keeps_in_proportion_to_the_bound() -> None:
    misses = [0.1, 0.2, 0.05, 0.12, 0.3, 0.07]
    made = ensemble(misses)
    found = made.all(family("rk4"), {"x": 1e-3})
    other = ensemble([3.0 * m for m in misses]).all(family("rk4"), {"x": 1e-3})
    assert other.miss == pytest.approx(3.0 * found.miss)
    assert found.seen == pytest.approx(0.3)
    assert found.starts == made.runs == 6
    assert not found.fits


def test_starts_that_come_out_far_better_do_not_make_others_worse() -> None:
    """What nearly vanishes at some starts is no sign that it grows at others."""
    for best in (0.5, 0.001, 0.0):
        misses = [0.5, 0.55, 0.6, best, 0.55, 0.6]
        assert 0.6 < ensemble(misses).all(family("rk4"), {"x": 1e-3}).miss < 0.75


def test_equal_starts_leave_a_margin_of_a_tenth_and_wild_ones_of_a_thousand() -> None:
    assert ensemble([0.5] * 6).all(family("rk4"), {"x": 1e-3}).miss == pytest.approx(0.55)
    wild = [0.5, 0.5e-6, 0.5e-9, 0.5e-3, 0.5e-12, 0.5]
    assert ensemble(wild).all(family("rk4"), {"x": 1e-3}).miss == pytest.approx(500.0)


def test_of_two_starts_nothing_is_expected() -> None:
    assert ensemble([0.5, 0.1]).all(family("rk4"), {"x": 1e-3}).miss == pytest.approx(0.5)


def test_a_setting_that_misses_by_far_at_the_first_starts_is_not_run_from_the_others() -> None:
    for worst, starts in ((31.0, 4), (29.0, 6)):
        found = ensemble([0.5, worst, 0.5, 0.5, 0.5, 0.5]).all(family("rk4"), {"x": 1e-3})
        assert found.starts == starts
        assert found.seen == pytest.approx(worst)


# -- the choice -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def bead() -> Iterator[Tuner]:
    scene = load_scene("bead_on_wire")
    scene.stop_time = 2.0
    tuner = Tuner(scene, list(scene.needs.errors), starts=4)
    yield tuner
    tuner.close()


class Truth:
    """In place of references: uncertain by `doubt` per second."""

    def __init__(self, doubt: float) -> None:
        self.doubt = doubt

    @property
    def reference(self) -> Truth:
        return self

    def uncertainty(self, path: str, times: Any) -> Any:
        return self.doubt * np.asarray(times)[:, None]


def obeying(tuner: Tuner, monkeypatch: pytest.MonkeyPatch, law: Law, doubt: float = 0.0) -> None:
    """Let a tuner meet errors and costs by `law`, the same at every start."""

    def one(setting: Setting, bounds: Any, member: int = 0) -> Candidate:
        tuner.ensemble.runs += 1
        return candidate(setting, *law(setting))

    def every(setting: Setting, bounds: Any) -> Candidate:
        miss, cpu = law(setting)
        return replace(candidate(setting, 1.1 * miss, cpu, starts=4), seen=miss)

    monkeypatch.setattr(tuner.ensemble, "one", one)
    monkeypatch.setattr(tuner.ensemble, "all", every)
    monkeypatch.setattr(tuner.runner, "cost", lambda setting: law(setting)[1])
    monkeypatch.setattr(tuner, "references", Truth(doubt))


def random_law(seed: int) -> Law:
    """Each structure and method with an error and a cost of its own."""

    @cache
    def drawn(structure: Any, method: str) -> Any:
        draw = np.random.default_rng([seed, *repr((structure, method)).encode()])
        return 10.0 ** draw.uniform([-3.5, -5.0, -8.0], [-1.0, -4.5, -6.5])

    def law(setting: Setting) -> tuple[float, float]:
        level, overhead, unit = drawn(setting.structure, setting.method)
        if setting.size is None:
            return 1e-9, overhead
        if setting.by_tolerance:
            return setting.size / level, overhead - 1e-6 * math.log10(setting.size)
        return (setting.size / level) ** ORDERS[setting.method], overhead + unit / setting.size

    return law


def cheapest(tuner: Tuner, law: Law) -> float:
    """By trying everything: at 0.9 of the bound, which leaves the margin for other starts."""
    costs = []
    for one in tuner.space.families(tuner.step, "gauss_seidel"):
        sizes = [10.0 ** (-n / 4) for n in range(8, 61)] if one.by_tolerance else []
        sizes = sizes or [tuner.step / round(1.02**n) for n in range(500)]
        costs.append(min(cpu for s in sizes for miss, cpu in [law(one.with_size(s))] if miss < 0.9))
    return min(costs)


@pytest.mark.parametrize("seed", range(4))
def test_the_choice_costs_little_more_than_the_cheapest_of_all(
    bead: Tuner, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    law = random_law(seed)
    obeying(bead, monkeypatch, law)
    choice = bead.tune(dict.fromkeys(bead.paths, 1e-6))
    assert choice.chosen is not None
    assert choice.chosen.fits
    assert choice.sure
    assert choice.runs < 120
    assert choice.until == 2.0
    # what the check of tuning allows
    assert choice.chosen.cpu < MOST * cheapest(bead, law)
    if choice.cheaper is not None:
        assert choice.cheaper.cpu < choice.chosen.cpu
        assert choice.cheaper.miss > 1.0


def test_of_nearly_equal_costs_the_more_accurate_is_chosen(
    bead: Tuner, monkeypatch: pytest.MonkeyPatch
) -> None:
    def law(setting: Setting) -> tuple[float, float]:
        if setting.structure != bead.space.structures[0]:
            return 2.0, 1e-4
        costs = {"rk4": 1.0e-5, "adaptive": 1.15e-5, "implicit": 1.25e-5}
        misses = {"rk4": 0.8, "adaptive": 0.3, "implicit": 0.1}
        return misses.get(setting.method, 2.0), costs.get(setting.method, 1e-4)

    obeying(bead, monkeypatch, law)
    choice = bead.tune(dict.fromkeys(bead.paths, 1e-6))
    assert choice.chosen is not None
    assert choice.chosen.setting.method == "adaptive"


@pytest.mark.parametrize(("cost", "followed"), [(1.9, True), (2.1, False)])
def test_a_family_is_followed_up_to_twice_the_cost_of_the_cheapest_so_far(
    bead: Tuner, monkeypatch: pytest.MonkeyPatch, cost: float, followed: bool
) -> None:
    """For one timing may be off by much: rk4 fits at once, adaptive at a smaller tolerance."""
    sizes = set()

    def law(setting: Setting) -> tuple[float, float]:
        if setting.method == "rk4":
            return 0.3, 1e-4
        if setting.method != "adaptive":
            return math.inf, 1.0
        sizes.add(setting.size)
        return setting.size / 1e-5, cost * 1e-4

    obeying(bead, monkeypatch, law)
    assert bead.tune(dict.fromkeys(bead.paths, 1e-6)).chosen is not None
    assert (len(sizes) > 1) is followed


def test_errors_that_spread_too_widely_are_judged_by_what_was_seen(
    bead: Tuner, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Starts of which each comes out a thousandfold apart, as those of a chaotic motion may."""
    law = random_law(1)
    obeying(bead, monkeypatch, law)

    def spread(setting: Setting, bounds: Any) -> Candidate:
        miss, cpu = law(setting)
        return replace(candidate(setting, 1000.0 * miss, cpu, starts=4), seen=miss)

    monkeypatch.setattr(bead.ensemble, "all", spread)
    monkeypatch.setattr(bead.ensemble, "members", 4)
    choice = bead.tune(dict.fromkeys(bead.paths, 1e-6))
    assert choice.chosen is not None
    assert choice.sure == (choice.chosen.miss <= 1.0)
    assert choice.chosen.seen <= 1.0
    assert choice.chosen.cpu < 1.4 * MOST * cheapest(bead, law)


def test_a_budget_is_kept_by_another_choice_or_said_to_be_too_small(
    bead: Tuner, monkeypatch: pytest.MonkeyPatch
) -> None:
    def law(setting: Setting) -> tuple[float, float]:
        fine = setting.method == "adaptive" and setting.size is not None and setting.size < 2e-7
        return (0.5, 1e-4) if fine else (40.0 if setting.method == "rk4" else 60.0, 1e-5)

    obeying(bead, monkeypatch, law)
    bounds = dict.fromkeys(bead.paths, 1e-6)
    choice = bead.tune(bounds, budget=2e-4)
    assert choice.within_budget
    assert choice.affordable is None
    choice = bead.tune(bounds, budget=5e-5)
    assert choice.chosen is not None
    assert choice.chosen.cpu == 1e-4
    assert not choice.within_budget
    assert choice.affordable is None  # nothing that was run from every start costs so little


def test_the_bound_can_be_judged_as_long_as_the_reference_is_a_hundred_times_surer(
    bead: Tuner, monkeypatch: pytest.MonkeyPatch
) -> None:
    """1e-8 per second less 1 %: 100 times that exceeds 1e-6 after 1.01 s."""
    obeying(bead, monkeypatch, random_law(1), doubt=0.99e-8)
    choice = bead.tune(dict.fromkeys(bead.paths, 1e-6))
    assert choice.until == pytest.approx(1.01, abs=1e-9)


@pytest.mark.parametrize(
    ("algorithm", "order"), [("strang", 2), ("midpoint", 2), ("gauss_seidel", 1)]
)
def test_a_macro_step_follows_from_the_order_of_the_algorithm(
    monkeypatch: pytest.MonkeyPatch, algorithm: str, order: int
) -> None:
    """100 times the bound at the scene's macro step: a little less than its 100th, or a tenth."""
    scene = load_scene("active_damping")
    scene.stop_time = 1.0
    if ALGORITHMS[algorithm].rolls_back:
        scene.algorithm = algorithm  # never tried where the scene has it not
    tuner = Tuner(scene, list(scene.needs.errors), continuous=True, starts=4)
    try:

        def law(setting: Setting) -> tuple[float, float]:
            p = ALGORITHMS[setting.algorithm].order
            dear = setting.algorithm != algorithm or setting.hold != "zero"
            miss = 100.0 * (setting.step / scene.step) ** p
            return miss, (1.0 if dear else 1e-5) * scene.step / setting.step

        obeying(tuner, monkeypatch, law)
        tried: list[Candidate] = []
        macro = tuner.coupling.search(dict.fromkeys(tuner.paths, 1e-3), tried, lambda _: None)
    finally:
        tuner.close()
    assert macro.algorithm == algorithm
    wanted = (0.8 / 100.0) ** (1.0 / order) * scene.step
    assert wanted / 1.1 < macro.step < wanted * (1.0 + 1e-9)
    assert 1.0 / macro.step == pytest.approx(round(1.0 / macro.step), rel=1e-9)
    mine = [c for c in tried if c.setting.coupling == macro.coupling]
    assert [c.starts for c in mine] == [1, 1, 4]  # twice at its own start, then at all


def test_a_macro_step_leaves_room_at_all_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The scene's own start needs no finer one; another comes to twice as much."""
    scene = load_scene("active_damping")
    scene.stop_time = 1.0
    tuner = Tuner(scene, list(scene.needs.errors), continuous=True, starts=4)
    try:

        def law(setting: Setting) -> tuple[float, float]:
            if setting.coupling != "gauss_seidel, hold first":
                return math.inf, 1.0
            return 0.45 * (setting.step / scene.step) ** 2, 1e-5

        obeying(tuner, monkeypatch, law)
        every = tuner.ensemble.all

        def worse(setting: Setting, bounds: dict[str, float]) -> Candidate:
            found = every(setting, bounds)
            return replace(found, miss=2.0 * found.miss)

        monkeypatch.setattr(tuner.ensemble, "all", worse)
        macro = tuner.coupling.search(dict.fromkeys(tuner.paths, 1e-3), [], lambda _: None)
    finally:
        tuner.close()
    assert macro.coupling == "gauss_seidel, hold first"
    assert 0.7 < 1.1 * 2.0 * 0.45 * (macro.step / scene.step) ** 2 < 0.9


def pushed(**settings: Any) -> Scene:
    """A bead whose wire a smooth function moves."""
    scene = Scene("pushed", stop_time=1.0, step=0.1, **settings)
    start = {"model.formulation": "angle", "bead.angle_start": 0.3}
    scene.add("bead", "BeadOnWire", start)
    scene.input("bead.wire.ax", lambda t: 3.0 * math.sin(4.0 * t))
    return scene.record("bead.bead.angle")


@pytest.mark.parametrize(
    ("slopes", "hold"), [("better", "first"), ("unstable", "zero"), ("no better", "zero")]
)
@pytest.mark.parametrize("own", ["zero", "first"])
def test_a_hold_is_chosen_by_what_it_comes_to(
    monkeypatch: pytest.MonkeyPatch, own: str, slopes: str, hold: str
) -> None:
    """10 times the bound with values held, and with slopes a tenth, as much, or no end."""
    tuner = Tuner(pushed(hold=own), ["bead.bead.angle"], continuous=True, starts=4)
    try:

        def law(setting: Setting) -> tuple[float, float]:
            first = setting.hold == "first"
            size = setting.step / 0.1
            miss = 10.0 * size
            if first and slopes == "better":
                miss = 0.1 * size**2
            elif first and slopes == "unstable":
                miss = math.inf
            return miss, (0.9e-5 if first else 1e-5) / size

        obeying(tuner, monkeypatch, law)
        macro = tuner.coupling.search({"bead.bead.angle": 1e-3}, [], lambda _: None)
        families = tuner._families(macro)
    finally:
        tuner.close()
    assert macro.hold == hold
    assert macro.step == (0.1 if hold == "first" else 0.008)
    assert {f.hold for f in families} == {hold}


def test_scenes_with_slopes_have_a_hold_to_choose() -> None:
    for name, held, sloped in (
        ("active_damping", 3, 2),  # jacobi and gauss_seidel
        ("pendulum_large", 1, 0),
        ("shaken_wire", 1, 1),
    ):
        scene = load_scene(name)
        found = couplings(scene, space_of(scene.check()))
        assert found[0] == (scene.algorithm, scene.hold)
        assert [hold for _, hold in found].count("zero") == held, name
        assert [hold for _, hold in found].count("first") == sloped, name


@pytest.mark.parametrize(("share", "runs"), [(1.01, 2), (0.99, 1)])
def test_a_macro_step_whose_run_would_last_beyond_the_limit_is_not_tried(
    monkeypatch: pytest.MonkeyPatch, share: float, runs: int
) -> None:
    """A run of 2 s costs 1e-5 s a second, and as many times more as it has steps."""
    scene = load_scene("active_damping")
    scene.stop_time = 2.0
    finer = 125
    tuner = Tuner(
        scene, list(scene.needs.errors), continuous=True, starts=4, limit=share * 2e-5 * finer
    )
    try:

        def law(setting: Setting) -> tuple[float, float]:
            if (setting.algorithm, setting.hold) != ("gauss_seidel", "zero"):
                return math.inf, 1e9
            return 100.0 * setting.step / scene.step, 1e-5 * scene.step / setting.step

        obeying(tuner, monkeypatch, law)
        tried: list[Candidate] = []
        macro = tuner.coupling.search(dict.fromkeys(tuner.paths, 1e-3), tried, lambda _: None)
    finally:
        tuner.close()
    own = [c for c in tried if c.setting.coupling == "gauss_seidel" and c.starts == 1]
    assert len(own) == runs
    assert macro.step == pytest.approx(scene.step / (finer if runs == 2 else 1))


@pytest.mark.parametrize("whole", [0.04, 20.0])
def test_macro_steps_divide_a_time_and_are_round_where_that_costs_little(whole: float) -> None:
    for longest in np.geomspace(1e-6, 0.04, 300):
        step = fraction(whole, longest)
        parts = whole / step
        assert parts == pytest.approx(round(parts), rel=1e-9)
        assert whole / longest * (1.0 - 1e-9) <= parts <= 1.1 * math.ceil(whole / longest)


def test_a_round_macro_step() -> None:
    assert fraction(20.0, 0.0085) == 0.008
    assert fraction(20.0, 0.04) == fraction(0.04, 0.04) == 0.04
    assert fraction(20.0, 0.0279) == 20.0 / 717
    assert fraction(0.04, 0.0279) == 0.02


@pytest.mark.parametrize("limit", [5.0, 1e6])
def test_a_macro_step_at_which_runs_fail_is_shortened_by_degrees(
    monkeypatch: pytest.MonkeyPatch, limit: float
) -> None:
    """Unstable beyond 20 ms: what fails there is no sign of an error that a law would tell."""
    scene = pushed()
    tuner = Tuner(scene, ["bead.bead.angle"], continuous=True, starts=4, limit=limit)
    try:

        def law(setting: Setting) -> tuple[float, float]:
            if setting.step > 0.02 or setting.hold == "first":
                return math.inf, 1e-7
            return 0.5 * setting.step / 0.02, 1e-6 / setting.step

        obeying(tuner, monkeypatch, law)
        macro = tuner.coupling.search({"bead.bead.angle": 1e-3}, [], lambda _: None)
    finally:
        tuner.close()
    assert 0.01 < macro.step <= 0.02


def test_where_every_run_fails_the_failure_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    tuner = Tuner(pushed(), ["bead.bead.angle"], continuous=True, starts=4)
    try:
        obeying(tuner, monkeypatch, lambda setting: (math.inf, 1e-5))
        monkeypatch.setattr(
            tuner.ensemble,
            "one",
            lambda setting, *_: candidate(setting, math.inf, 1e-5, failure="it fell"),
        )
        monkeypatch.setattr(
            tuner.ensemble, "errors", lambda s, _: (candidate(s, math.inf, 1e-5), np.zeros(1))
        )
        choice = tuner.tune({"bead.bead.angle": 1e-3})
    finally:
        tuner.close()
    assert choice.chosen is None
    assert choice.advice == "it fell"


def test_macro_steps_keep_to_the_points_at_which_a_law_samples() -> None:
    """A period of 20 ms is a whole number of them, however fine."""
    scene = load_scene("sampled_feedback")
    tuner = Tuner(scene, list(scene.needs.errors), continuous=True, starts=4)
    try:
        assert tuner.coupling.whole == scene.step
    finally:
        tuner.close()


# -- errors that cancel ---------------------------------------------------------------------------

TIMES = np.linspace(0.0, 10.0, 201)


def signed(tuner: Tuner, monkeypatch: pytest.MonkeyPatch, seed: int, *, alike: bool = True) -> Law:
    """Errors over bounds that are sums of coupling's and the method's, of any sign and course.

    alike: the same at all starts; otherwise, the method's has the other sign at some.
    """

    @cache
    def course(*key: str) -> tuple[Any, Any]:
        draw = np.random.default_rng([seed, *repr(key).encode()])
        level, overhead, unit = 10.0 ** draw.uniform([-3.5, -5.0, -8.0], [-1.0, -4.5, -6.5])
        # mostly one course of time for all, as where one drive makes all errors
        shape = draw.choice([-1.0, 1.0]) * np.sin(TIMES) + 0.05 * draw.normal() * np.cos(TIMES)
        return (level, overhead, unit), shape

    def parts(setting: Setting, sign: float = 1.0) -> Any:
        p = 2 if setting.hold == "first" else 1
        coupling = 15.0 * (setting.step / tuner.step) ** p * course(setting.hold)[1]
        (level, overhead, unit), shape = course(str(setting.structure), setting.method)
        steps = overhead / setting.step
        if setting.size is None:
            return coupling, steps
        if setting.by_tolerance:
            own = setting.size / level * 1e-3
            return coupling + sign * own * shape, steps * (2.0 - 0.1 * math.log10(setting.size))
        own = (setting.size / level) ** ORDERS[setting.method]
        return coupling + sign * own * shape, steps + unit / setting.size

    def law(setting: Setting) -> tuple[float, float]:
        error, cpu = parts(setting)
        return float(np.abs(error).max()), cpu

    obeying(tuner, monkeypatch, law)
    one = tuner.ensemble.one
    monkeypatch.setattr(
        tuner.ensemble, "errors", lambda setting, bounds: (one(setting, bounds), parts(setting)[0])
    )
    if not alike:
        every = tuner.ensemble.all

        def worst(setting: Setting, bounds: Any) -> Candidate:
            other = float(np.abs(parts(setting, -1.0)[0]).max())
            found = every(setting, bounds)
            return replace(found, miss=max(found.miss, 1.1 * other), seen=max(found.seen, other))

        monkeypatch.setattr(tuner.ensemble, "all", worst)
    return law


@pytest.mark.parametrize("seed", range(8))
def test_a_coupling_and_what_integrates_in_it_cost_little_more_than_the_cheapest_of_all(
    monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """Against every macro step, hold, method and size, at 0.9 of the bound."""
    scene = pushed()
    tuner = Tuner(scene, ["bead.bead.angle"], continuous=True, starts=4, limit=1e3)
    try:
        law = signed(tuner, monkeypatch, seed)
        choice = tuner.tune({"bead.bead.angle": 1e-3})
        assert choice.chosen is not None
        assert choice.chosen.fits
        costs = []
        for count in np.unique(np.round(np.geomspace(10, 400, 30))):
            for hold in ("zero", "first"):
                for one in tuner.space.families(1.0 / count, "gauss_seidel", hold):
                    sizes = [10.0 ** (-n / 4) for n in range(8, 61)] if one.by_tolerance else []
                    sizes = sizes or list(one.step / np.unique(np.round(1.1 ** np.arange(80))))
                    costs += [c for s in sizes for m, c in [law(one.with_size(s))] if m < 0.9]
        assert choice.chosen.cpu < MOST * min(costs)
        assert choice.runs < 250
    finally:
        tuner.close()


@pytest.mark.parametrize("seed", range(4))
def test_what_cancels_at_the_scenes_own_start_only_is_not_taken(
    monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    scene = pushed()
    tuner = Tuner(scene, ["bead.bead.angle"], continuous=True, starts=4, limit=1e3)
    try:
        signed(tuner, monkeypatch, seed, alike=False)
        bounds = {"bead.bead.angle": 1e-3}
        choice = tuner.tune(bounds)
        assert choice.chosen is not None
        assert tuner.ensemble.all(choice.chosen.setting, bounds).seen <= 1.0
    finally:
        tuner.close()


def test_couplings_that_cost_less_are_tried_from_long_to_short() -> None:
    """Values held cost half of slopes, so they are tried to half the macro step, and some more."""
    tuner = Tuner(pushed(), ["bead.bead.angle"], continuous=True, starts=4, frame_rate=10.0)
    try:
        search = tuner.coupling
        held, sloped = (replace(search.given, step=0.05, hold=hold) for hold in ("zero", "first"))
        tried = [candidate(held, 1.0, 1e-5), candidate(sloped, 0.5, 2e-5)]
        steps = {s[0].hold: [x.step for x in s] for s in search.cheaper(sloped, tried)}
        assert steps == {"zero": [0.1, 0.05, 0.1 / 3, 0.025, 0.02], "first": [0.1]}
    finally:
        tuner.close()


def test_errors_have_a_sign_and_follow_the_order_of_their_outputs() -> None:
    times = np.array([0.0, 1.0, 2.0])
    true = {"x": np.array([[1.0], [2.0], [3.0]]), "y": np.zeros((3, 1))}
    outputs = {"x": np.array([1.5, 2.0, 1.0]), "y": np.array([0.0, -0.02, 0.01])}
    doubts = {"x": np.zeros((3, 1)), "y": np.array([[0.0], [0.0], [1.0]])}
    outcome = SimpleNamespace(failure="", times=times, cpu=1e-5, outputs=outputs)
    verdict = SimpleNamespace(worst=1.0)
    references = SimpleNamespace(
        model={},
        reference=SimpleNamespace(uncertainty=lambda path, _: doubts[path]),
        values=lambda *_: true,
        errors=lambda *_, **__: {"x": verdict, "y": verdict},
    )
    runner = SimpleNamespace(glance=lambda *_: outcome)
    made = Ensemble(runner, references, {})  # type: ignore[arg-type]
    found, errors = made.errors(family("rk4"), {"x": 0.5, "y": 0.01})
    assert errors.tolist() == [1.0, 0.0, -4.0, 0.0, -2.0, 0.0]  # of the last nothing is known
    assert found.miss == 100.0
    outcome.failure = "it fell"
    assert made.errors(family("rk4"), {"x": 0.5, "y": 0.01})[0].miss == math.inf


# -- what a reference can judge -------------------------------------------------------------------


def test_the_doubt_at_a_time_is_that_of_the_next_comparison() -> None:
    parts: Any = SimpleNamespace(members=1, end=2.0)
    doubts = {"x": np.array([[1.0], [2.0], [3.0]])}
    made = Reference(parts, parts, ["x"], [0.0, 1.0, 2.0], doubts, "")
    times = [0.0, 0.5, 1.0, 1.0 + 1e-13, 1.5, 2.0, 5.0]
    assert made.uncertainty("x", times)[:, 0].tolist() == [1.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0]


def test_an_error_is_judged_as_long_as_the_reference_is_a_hundred_times_surer() -> None:
    times = np.linspace(0.0, 10.0, 11)
    error = np.array([0.0, 1.0, -3.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 4.0, 1.0])
    sure = judge(times, error, np.full(11, 0.0101))
    assert (sure.worst, sure.final, sure.until, sure.judged) == (4.0, 1.0, 10.0, True)
    assert sure.bound == pytest.approx(4.0101)
    # the running maximum 3 is 100 times 0.03, until the doubt exceeds it
    grown = judge(times, error, np.array([0.0, *[0.03] * 5, *[0.0301] * 3, 0.05, 0.05]))
    assert (grown.worst, grown.final, grown.until, grown.judged) == (3.0, 1.0, 5.0, True)
    known = judge(times, error, np.full(11, 0.05), least=5.0)
    assert (known.worst, known.until, known.judged) == (4.0, 10.0, True)
    unknown = judge(times, error, np.array([0.0, *[1.0] * 10]))
    assert (unknown.worst, unknown.final, unknown.until) == (4.0, 1.0, 10.0)
    assert not unknown.judged
    # known until less than a tenth of the time
    little = judge(np.array([0.0, 0.9, 10.0]), np.ones(3), np.array([1.0, 0.005, 1.0]))
    assert (little.until, little.judged) == (10.0, False)
    assert judge(times, np.where(times > 5, np.nan, 0.0), np.zeros(11)).worst == math.inf


def test_one_slow_timing_does_not_decide_between_couplings() -> None:
    """Held values cost 3, slopes 1: but for the first run, which was disturbed."""
    held, sloped = (replace(family("adaptive"), hold=hold) for hold in ("zero", "first"))
    timings = {"zero": iter((3.0, 3.1)), "first": iter((1.1, 1.0))}
    ensemble: Any = SimpleNamespace(
        one=lambda setting, _: candidate(setting, 0.4, next(timings[setting.hold]))
    )
    none: Any = None
    search = MacroSearch(none, none, ensemble, step=0.1, whole=1.0, sampled=True, dearest=math.inf)
    options = [candidate(held, 0.4, 3.2), candidate(sloped, 0.4, 9.0)]
    assert search._cheapest(options, {}) == sloped
    assert search._cheapest(options[:1], {}) == held  # nothing to compare with: not run again


def test_points_of_students_distribution() -> None:
    stats = pytest.importorskip("scipy.stats")
    assert list(_STUDENT) == list(range(2, 17))
    for freedom, point in _STUDENT.items():
        assert point == pytest.approx(stats.t.ppf(0.995, freedom), abs=6e-4)
