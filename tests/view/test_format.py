"""The page's small functions by themselves: numbers as text, the clock, the range of the plots."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from browsing import Tab
from motions import bead

import curvebound.view
from curvebound.view import write_replay

ASSETS = Path(curvebound.view.__file__).parent / "assets"
MINUS = "\u2212"


def evaluated(tab: Tab, *expressions: str) -> list[Any]:
    """Values of expressions in the functions of format.js and data.js."""
    sources = "\n".join((ASSETS / name).read_text("utf-8") for name in ("format.js", "data.js"))
    return list(tab.run(f"(() => {{ {sources}\nreturn [{', '.join(expressions)}]; }})()"))


@pytest.mark.parametrize(
    ("values", "error", "shown"),
    [
        ([0.5, 1.25], False, {0.5: "0.5000", -1.25: f"{MINUS}1.2500", 0: "0.0000"}),
        ([0.5, 123.4], False, {0.5: "0.50", 123.456: "123.46"}),
        ([0.5, 1234567.0], False, {1234567.5: "1234568", 0.4: "0"}),
        ([0.5, 12345678.0], False, {12345678.0: "1.2346e7", 0: "0"}),
        ([1.5e-4], False, {1.5e-4: "0.00015000"}),
        ([1.5e-5], False, {1.5e-5: f"1.5000e{MINUS}5"}),
        ([1, 2, 3e9], False, {3e9: "3000000000", 2: "2"}),
        ([1, 2, 3e14], False, {3e14: "300000000000000"}),
        ([1, 2, 3e15], False, {3e15: "3.0000e15"}),
        ([0.0123456], True, {0.0123456: "0.0123", 1234.5: "1.23e3", 0: "0", 999.4: "999"}),
        ([5e-9], True, {5e-9: f"5.00e{MINUS}9", 0.00999: f"9.99e{MINUS}3"}),
    ],
)
def test_numbers(tab: Tab, values: list[float], error: bool, shown: dict[float, str]) -> None:
    made = f"formatter({values}, {json.dumps(error)})"
    found = evaluated(tab, *(f"{made}({value})" for value in shown), f"{made}(NaN)")
    assert found == [*shown.values(), "\u2013"]


def test_ticks_and_units(tab: Tab) -> None:
    ticks = {0: "0", 99999: "99999", 1e5: "1e5", 123456: "1.235e5", 1.5e-4: f"1.5e{MINUS}4",
             0.001: "0.001", -2.5: f"{MINUS}2.5", 0.1 + 0.2: "0.3"}  # fmt: skip
    assert evaluated(tab, *(f"tickText({x!r})" for x in ticks)) == list(ticks.values())
    units = {"m/s2": "m/s\u00b2", "N.m.s/rad": "N\u00b7m\u00b7s/rad", "1": "", "": ""}
    assert evaluated(tab, *(f"prettyUnit({u!r})" for u in units)) == list(units.values())
    given = {"'1', 'm2'": "1 m\u00b2", "'1', '1'": "1", "'\u2013', 'm'": "\u2013"}
    assert evaluated(tab, *(f"withUnit({words})" for words in given)) == list(given.values())


def test_times_have_the_decimals_that_tell_samples_apart(tab: Tab) -> None:
    cases = {"[0, 0.01, 0.02]": "1.00", "[0, 2e-3, 4e-3]": "1.000", "[0, 1, 2]": "1.00",
             "[0, 2e-9]": "1.000000", "[0, 0]": "1.000", "[3]": "1.00"}  # fmt: skip
    found = evaluated(tab, *(f"timeFormatter({times})(1)" for times in cases))
    assert found == list(cases.values())


def test_samples_at_and_between_times(tab: Tab) -> None:
    """A cubic with the slopes of parabolas: exact for squares."""
    times = [0.0, 1.0, 1.5, 3.0, 3.0, 4.0]
    t = json.dumps(times)
    places = {-1.0: 0, 0.0: 0, 0.99: 0, 1.0: 1, 1.4: 1, 2.9: 2, 3.0: 4, 9.0: 5}
    assert evaluated(tab, *(f"indexAt({t}, {at})" for at in places)) == list(places.values())
    nearest = {-1.0: 0, 0.4: 0, 0.6: 1, 1.2: 1, 1.3: 2, 2.2: 2, 2.3: 3, 9.0: 5}
    assert evaluated(tab, *(f"nearestIndex({t}, {at})" for at in nearest)) == list(nearest.values())
    inside = {-4.01e-12: False, -3.99e-12: True, 2.0: True, 4 + 3.99e-12: True, 4 + 4.01e-12: False}
    assert evaluated(tab, *(f"during({t}, {at!r})" for at in inside)) == list(inside.values())
    even = [0.0, 1.0, 1.5, 3.0, 4.0]
    squares = json.dumps([x * x for x in even])
    at = [0.0, 0.3, 1.2, 1.5, 2.5, 3.7, 4.0]
    found = evaluated(tab, *(f"valueAt({even}, {squares}, indexAt({even}, {x}), {x})" for x in at))
    assert found == pytest.approx([x * x for x in at])
    assert evaluated(tab, "valueAt([0, 2], [1, 5], 0, 0.5)") == [2.0]
    assert evaluated(tab, f"slope({even}, {squares}, 0)", f"slope({even}, {squares}, 4)") == [
        None, None,
    ]  # fmt: skip
    # two samples at one time: a jump has no slope
    jump = "[0, 1, 1, 2], [0, 1, 5, 6]"
    slopes = (f"Number.isNaN(slope({jump}, {i}))" for i in (1, 2))
    assert evaluated(tab, *slopes) == [True, True]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("page") / "two.html"
    return write_replay([("long", bead(10.0, 0.05)), ("short", bead(4.0, 0.05))], out)


def test_zoom_of_the_time_axis(tab: Tab, page: Path) -> None:
    tab.open(page)
    for window, factor, about, expected in (
        ((0, 10), 2, 5.0, [2.5, 7.5]),
        ((0, 10), 2, 1.0, [0.5, 5.5]),
        ((2, 6), 0.5, 3.0, [1.0, 9.0]),
        ((5, 10), 5 / 6, 5.0, [4.0, 10.0]),
        ((0, 5), 5 / 6, 5.0, [0.0, 6.0]),
        ((2, 6), 0.1, 3.0, [0.0, 10.0]),
        ((2, 6), 1e12, 3.0, [2.0, 6.0]),
    ):
        # the window follows the time shown
        tab.run(f"curvebound.player.seek({about})")
        tab.run(f"curvebound.setWindow({window[0]}, {window[1]})")
        tab.run(f"curvebound.zoomTime({factor})")
        assert tab.run("curvebound.window") == pytest.approx(expected), (window, factor, about)


def test_a_result_that_is_over_says_so(tab: Tab, page: Path) -> None:
    tab.open(page)
    for time, ended in ((3.9, 0), (4.0, 0), (4.1, 1)):
        tab.run(f"curvebound.player.seek({time})")
        tab.run("curvebound.tell()")
        texts = tab.run("curvebound.cells.map(({ cell }) => cell.textContent)")
        assert len(texts) > 2
        assert (texts.count("ended") > 0) == bool(ended)
        assert texts.count("ended") in (0, len(texts) // 2)


def test_the_last_sample_of_a_short_result_is_in_it_at_a_frame_of_a_long_one(
    tab: Tab, tmp_path: Path
) -> None:
    """Times are packed in steps of 4e-11 s here: a frame at 10 s reads back as 10 + 1.8e-11 s."""
    results = [("long", bead(40.0, 0.05)), ("short", bead(10.0, 0.05))]
    tab.open(write_replay(results, tmp_path / "ends.html"))
    place = "curvebound.scene.place(curvebound.scene.actors[1], curvebound.player.time).outside"
    legends = "[...document.querySelectorAll('.plot output')].map((one) => one.textContent)"
    for before, over in ((9.97, False), (10.02, True)):
        tab.run(f"curvebound.player.seek({before}); curvebound.step(1); curvebound.tell()")
        told = tab.run("curvebound.cells.map(({ cell }) => cell.textContent)")
        assert told.count("ended") == over * len(told) // 2
        shown = [text for text in tab.run(legends) if text]
        assert len(shown) > 4  # as many of each, and the distance of the short one
        assert shown.count("\u2013") == over * (len(shown) + 1) // 2
        assert tab.run(place) is over


def test_a_result_that_has_not_begun_has_no_value(tab: Tab, tmp_path: Path) -> None:
    late = bead(4.0, 0.05)
    late["time"] += 1.0
    tab.open(write_replay([("long", bead(10.0, 0.05)), ("late", late)], tmp_path / "late.html"))
    for time, word in ((0.9, "\u2013"), (1.0, None), (5.0, None), (5.1, "ended")):
        tab.run(f"curvebound.player.seek({time})")
        tab.run("curvebound.tell()")
        texts = tab.run("curvebound.cells.map(({ cell }) => cell.textContent)")
        half = len(texts) // 2
        assert [texts.count(one) for one in ("\u2013", "ended")] == [
            half * (word == one) for one in ("\u2013", "ended")
        ], time


def test_pausing_and_another_pace_keep_the_time_that_has_passed(tab: Tab, page: Path) -> None:
    tab.open(page)
    script = (
        "(() => {{ const p = new curvebound.player.constructor(0, 100, () => {{}});"
        "p.playing = true; p.anchor(performance.now() - 2000); {act};"
        "return [p.time, p.playing, p.speed, performance.now() - p.anchored[0]]; }})()"
    )
    time, playing, _, _ = tab.run(script.format(act="p.pause()"))
    assert time == pytest.approx(2.0, abs=0.2)
    assert playing is False
    time, playing, speed, since = tab.run(script.format(act="p.pace(4)"))
    assert time == pytest.approx(2.0, abs=0.2)
    assert (playing, speed) == (True, 4)
    assert since < 200
