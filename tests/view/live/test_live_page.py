"""The live page in a real browser."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from browsing import Tab
from legible import SCREENS
from serving import Serving, served

from curvebound.cosim import load_scene, read_csv
from curvebound.cosim.instance import Instance
from curvebound.view.live.plan import Plan

PlanOf = Callable[[str], Plan]

# Contrast of every text that is shown against what is behind it, the worst first.
CONTRAST = """(() => {
  const numbers = (colour) => (colour.match(/[\\d.]+/g) ?? []).map(Number);
  const light = ([r, g, b]) => {
    const part = (v) => ((v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
  };
  const behind = (one) => {
    for (; one; one = one.parentElement) {
      const [r, g, b, a = 1] = numbers(getComputedStyle(one).backgroundColor);
      if (a === 1) return [r, g, b];
    }
    return [255, 255, 255];
  };
  const found = [];
  for (const one of document.querySelectorAll("body *")) {
    const own = [...one.childNodes].some((node) => node.nodeType === 3 && node.data.trim());
    const field = ["INPUT", "SELECT"].includes(one.tagName) && one.type !== "range";
    const shown = one.checkVisibility() && !one.disabled && !one.closest(".hidden, script");
    if (!(own || field) || !shown) continue;
    const a = light(numbers(getComputedStyle(one).color)), b = light(behind(one));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    found.push([ratio, one.tagName, one.id, one.className, one.textContent.slice(0, 30)]);
  }
  return found.sort((a, b) => a[0] - b[0]).slice(0, 3);
})()"""

# Controls without a name for a screen reader.
NAMELESS = """[...document.querySelectorAll("button, input, select, summary")].filter((one) => (
  one.checkVisibility() && !one.getAttribute("aria-label") && !one.textContent.trim()
  && !one.labels?.[0]?.textContent.trim())).map((one) => one.outerHTML)"""
SLIDER = "document.querySelector('[aria-label=\"plant.slider.fx\"]')"


@pytest.fixture
def live(plan_of: PlanOf, tmp_path: Path) -> Iterator[Callable[[str], Serving]]:
    """Serves scenes by name until the test ends."""
    from contextlib import ExitStack

    with ExitStack() as stack:
        yield lambda name: stack.enter_context(served(plan_of(name), tmp_path))


def visit(tab: Tab, serving: Serving, play: int = 1) -> None:
    tab.visit(f"{serving.address}#play={play}")
    tab.wait("curvebound.samples[0]?.length")
    if play:
        tab.wait("curvebound.samples[0].last > curvebound.model.start + 0.1")


def pixel(tab: Tab, grip: int) -> tuple[float, float]:
    """Where a grip is on the screen."""
    tab.run("document.getElementById('scene').scrollIntoView({ block: 'center' })")
    found = tab.run(
        f"(() => {{ const box = document.getElementById('scene').getBoundingClientRect();"
        f"const {{ grips }} = curvebound, place = grips.place(grips.grips[{grip}]);"
        "const [x, y] = grips.pixel(place);"
        "return [box.left + x, box.top + y]; })()"
    )
    return found[0], found[1]


def value(tab: Tab, name: str, run: int = 0) -> float:
    column = f"curvebound.samples[{run}].columns[curvebound.model.columns.indexOf('{name}') + 1]"
    return float(tab.run(f"{column}[curvebound.samples[{run}].length - 1]"))


def press(tab: Tab, name: str) -> None:
    tab.run(f"document.getElementById('{name}').click()")


@pytest.mark.parametrize(
    "name", ["two_wires", pytest.param("inverted_balance", marks=pytest.mark.slow)]
)
def test_it_runs_without_an_error_and_asks_nobody_else(
    tab: Tab, live: Callable[[str], Serving], name: str
) -> None:
    serving = live(name)
    visit(tab, serving)
    paces = []
    while len(paces) < 10 and (not paces or abs(paces[-1] - 1.0) > 0.1):
        # on a busy machine it falls behind, and catches up later
        before = tab.run("[performance.now() / 1000, curvebound.time]")
        time.sleep(0.5)
        after = tab.run("[performance.now() / 1000, curvebound.time]")
        paces.append((after[1] - before[1]) / (after[0] - before[0]))
    assert abs(paces[-1] - 1.0) <= 0.1, paces
    assert tab.errors == []
    hosts = {urlsplit(url).netloc for url in tab.requests if not url.startswith("data:")}
    assert hosts == {serving.host}
    assert tab.run("document.querySelectorAll('.plot:not([hidden]) .u-wrap').length") >= 3
    assert tab.run("document.getElementById('trouble').hidden")


def test_a_slider_moves_what_is_drawn_and_undo_takes_it_back(
    tab: Tab, live: Callable[[str], Serving]
) -> None:
    visit(tab, live("pendulum_small"))
    tab.run(f"{SLIDER}.value = 8; {SLIDER}.dispatchEvent(new Event('input'))")
    tab.wait("curvebound.state.values['plant.slider.fx'] === 8")
    number = f"{SLIDER}.parentElement.querySelector('[type=number]').value"
    assert tab.run(number) == "8"
    tab.wait("curvebound.state.undo === 1")
    press(tab, "undo")
    tab.wait("curvebound.state.values['plant.slider.fx'] === 0")
    tab.wait(f"{number} === '0'")
    press(tab, "mark")
    tab.wait("!document.getElementById('back').disabled")
    at = tab.run("curvebound.state.mark")
    time.sleep(0.3)
    press(tab, "back")
    tab.wait(f"curvebound.time < {at} + 0.25")
    assert tab.errors == []


def test_play_pause_step_speed_reset_by_keyboard(tab: Tab, live: Callable[[str], Serving]) -> None:
    visit(tab, live("bead_on_wire"), play=0)
    assert tab.run("curvebound.state.playing") is False
    tab.key(".")
    tab.wait("curvebound.samples[0].last === 0.01")
    tab.key(" ")
    tab.wait("curvebound.state.playing && curvebound.time > 0.2")
    tab.key("]")
    tab.wait("curvebound.state.speed === 2")
    tab.key("[")
    tab.key("[")
    tab.wait("curvebound.state.speed === 0.5")
    # an answer that is under way when the next key comes does not undo it
    tab.run("curvebound.pace(5); curvebound.stand({ ...curvebound.state, speed: 0.5 })")
    assert tab.run("curvebound.state.speed") == 5
    tab.run("curvebound.pace(0.5)")
    tab.key("k")
    tab.wait("!curvebound.state.playing")
    tab.key("r")
    tab.wait("curvebound.time === 0")
    assert tab.errors == []


@pytest.mark.parametrize("mobile", [False, True])
def test_dragging_pulls_through_the_inputs(
    tab: Tab, live: Callable[[str], Serving], mobile: bool
) -> None:
    if mobile:
        tab.size(390, 844, mobile=True, ratio=2)
    serving = live("pendulum_small")
    visit(tab, serving)
    bob = tab.run("curvebound.grips.grips.findIndex(({ point }) => point === 'bob')")
    press(tab, "play")
    tab.wait("!curvebound.state.playing")
    x, y = pixel(tab, bob)
    if mobile:
        tab.run(
            "document.addEventListener('touchstart', "
            "(event) => window.held = event.defaultPrevented)"
        )
        tab.touch("touchStart", (x + 120, y - 120))
        tab.touch("touchEnd")
        assert tab.run("window.held") is False, "beside a grip the page scrolls"
        tab.touch("touchStart", (x, y))
        assert tab.run("window.held") is True
        tab.touch("touchMove", (x + 60, y - 30))
    else:
        tab.mouse("mousePressed", x, y, button="left", clickCount=1)
        tab.mouse("mouseMoved", x + 60, y - 30, button="left", buttons=1)
    tab.wait("curvebound.grips.pulling")
    tab.run("curvebound.toggle()")
    (session,) = serving.live.sessions
    force = session.runs.first.driven["plant.pendulum.fx"]
    serving.wait(lambda: force.held(1e9) > 1.0)
    if mobile:
        tab.touch("touchEnd")
    else:
        tab.mouse("mouseReleased", x + 60, y - 30, button="left", clickCount=1)
    serving.wait(lambda: force.held(1e9) == 0.0)
    assert tab.run("curvebound.state.playing"), "a drag is no tap"
    tab.wait("curvebound.state.undo === 1")
    assert tab.errors == []


def test_arrow_keys_pull_what_is_ringed(tab: Tab, live: Callable[[str], Serving]) -> None:
    serving = live("pendulum_small")
    visit(tab, serving)
    tab.key("g")
    tab.key("g")
    assert "arrows pull bob of plant" in tab.run("document.getElementById('hint').textContent")
    (session,) = serving.live.sessions
    force = session.runs.first.driven["plant.pendulum.fx"]
    tab.hold("ArrowLeft", down=True)
    serving.wait(lambda: force.held(1e9) < -1.0)
    tab.hold("ArrowLeft", down=False)
    serving.wait(lambda: force.held(1e9) == 0.0)


def test_a_variant_beside_with_one_click(tab: Tab, live: Callable[[str], Serving]) -> None:
    visit(tab, live("pumped_swing"))
    press(tab, "beside")
    tab.wait("curvebound.samples[1]?.length > 5")
    assert tab.run("curvebound.scene.actors.map(({ label }) => label)") == [
        "pumped_swing",
        "detuned",
    ]
    title = "document.querySelector('.plot h3').textContent"
    assert tab.run(title) == "Distance from pumped_swing m"
    tab.wait(
        "/^\\d/.test(document.querySelector('#readouts tr:nth-child(2) td:last-child').textContent)"
    )
    assert tab.run("document.getElementById('legend').textContent") == "pumped_swingdetuned"
    press(tab, "beside")
    tab.wait("curvebound.samples.length === 1")
    assert tab.run(title) != "Distance from pumped_swing m"
    assert tab.errors == []


def test_settings_restart_and_are_set_beside(tab: Tab, live: Callable[[str], Serving]) -> None:
    visit(tab, live("bead_on_wire"))
    field = (
        "curvebound.settings.fields.find(({ one }) => one.path === 'bead.bead.angle_start').input"
    )
    tab.run(f"document.getElementById('restarting').open = true; {field}.value = '90deg/3'")
    tab.run("document.querySelector('#settings [type=submit]').click()")
    angle = "curvebound.samples[0].columns[curvebound.model.columns.indexOf('bead.bead.angle') + 1]"
    tab.wait(f"Math.abs({angle}[0] - Math.PI / 6) < 1e-9")
    tab.run(f"{field}.value = '1'")
    press(tab, "beside")
    tab.wait("curvebound.runs.length === 2")
    assert tab.run("curvebound.runs[1].label") == "angle_start 1"
    tab.run(f"{field}.value = 'heavy'")
    tab.run("document.querySelector('#settings [type=submit]').click()")
    tab.wait("document.getElementById('notes').textContent.includes('heavy')")
    assert tab.run("curvebound.runs.length") == 2


def test_what_was_done_is_saved(tab: Tab, live: Callable[[str], Serving], tmp_path: Path) -> None:
    visit(tab, live("pendulum_small"))
    tab.run("curvebound.send({ do: 'set', path: 'plant.slider.fx', value: 3 })")
    time.sleep(0.3)
    press(tab, "record")
    tab.wait("document.getElementById('notes').textContent.includes('gave the same bits')")
    saved = load_scene(tmp_path / "pendulum_small_live_1.py")
    result = saved.run()
    table = read_csv(tmp_path / "pendulum_small_live_1.csv")
    assert [tuple(map(float, row)) for row in result.data] == [
        tuple(map(float, row)) for row in table
    ]


@SCREENS
def test_layout_contrast_and_names(
    tab: Tab, live: Callable[[str], Serving], size: tuple[int, int, bool], dark: bool
) -> None:
    width, height, mobile = size
    tab.size(width, height, mobile=mobile, ratio=2 if mobile else 1)
    tab.dark(dark)
    visit(tab, live("pumped_swing"))
    press(tab, "beside")
    tab.wait("curvebound.samples[1]?.length > 5")
    tab.run("for (const one of document.querySelectorAll('details')) one.open = true;"
            "document.getElementById('arrows-button').click()")  # fmt: skip
    assert tab.run("document.documentElement.scrollWidth") <= width
    worst = tab.run(CONTRAST)
    assert worst[0][0] >= 4.5, worst
    assert tab.run(NAMELESS) == []
    # the bar covers nothing: at the end of the page the last value stands above it
    tab.run("for (const one of document.querySelectorAll('details')) one.open = false")
    press(tab, "play")
    tab.wait("!curvebound.state.playing")  # numbers that grow make the page longer
    box = tab.run(
        "scrollTo(0, document.documentElement.scrollHeight);"
        "[document.querySelector('.transport').getBoundingClientRect().top,"
        "document.getElementById('panel').getBoundingClientRect().bottom,"
        "document.querySelector('.transport').getBoundingClientRect().height]"
    )
    assert box[1] <= box[0] + 1
    assert box[2] <= (110 if mobile else 60)
    # and the list of plots opens where it can be read
    tab.run("document.getElementById('choose').scrollIntoView({ block: 'center' });"
            "document.getElementById('choose').click()")  # fmt: skip
    box = tab.run(
        "(() => { const one = document.getElementById('chooser').getBoundingClientRect();"
        "return [one.left, one.right]; })()"
    )
    assert box[0] >= 0
    assert box[1] <= width
    assert tab.errors == []


def test_phase_and_arrows_follow_the_run(tab: Tab, live: Callable[[str], Serving]) -> None:
    """A push by the slider is seen as an arrow; the phase plot's marker goes where the run goes."""
    visit(tab, live("pendulum_small"))
    phase = "curvebound.plots.at(-1)"
    assert tab.run(f"{phase}.chosen") == ["pendulum.angle", "pendulum.angular_velocity"]
    tab.run("curvebound.nextArrows(); curvebound.nextArrows()")
    assert "applied force" in tab.run("[...curvebound.arrows.shown].map(({ name }) => name)")
    tab.run("curvebound.send({ do: 'set', path: 'plant.slider.fx', value: 4 })")
    force = "({ kind, at }) => kind[0] === 'applied force' && at === 'slider'"
    tab.wait(f"curvebound.scene.actors[0].arrows.find({force}).values[0].at(-1) === 4")
    press(tab, "play")
    tab.wait("!curvebound.state.playing")
    tab.run(f"{phase}.element.scrollIntoView()")
    tab.wait(f"!{phase}.away")
    tab.run("curvebound.dirty = true")
    tab.wait(f"{phase}.place && {phase}.time === curvebound.time")
    place = tab.run(
        f"(() => {{ const {{ x, y }} = {phase}.lines[0]; return [{phase}.place[0](x.values.at(-1)),"
        f"{phase}.place[1](y.values.at(-1))]; }})()"
    )
    marker = f"{phase}.marked[0].marker.style.transform.match(/-?[\\d.]+/g).map(Number)"
    assert tab.run(marker) == pytest.approx(place, abs=0.2)
    tab.run("curvebound.send({ do: 'beside', label: 'again', settings: {} })")
    tab.wait("curvebound.runs.length === 2 && curvebound.samples[1].length")
    assert len(tab.run("[...curvebound.arrows.shown]")) > 1, "what was asked for stays"
    assert tab.run(f"{phase}.lines.length") == 2
    assert tab.errors == []


def test_plots_mounted_at_the_first_sample_mark_no_later_ones(
    tab: Tab, live: Callable[[str], Serving]
) -> None:
    visit(tab, live("pendulum_small"), play=0)
    assert tab.run("curvebound.samples[0].length") == 1
    tab.run("curvebound.show(0)")  # hands them their sample
    tab.run("curvebound.redraw()")
    tab.run("curvebound.send({ do: 'play' })")
    tab.wait("curvebound.time > curvebound.model.start + 0.2")
    tab.run(
        "globalThis.lines = globalThis.marks = 0; for (const { chart } of curvebound.plots) {"
        "if (!chart?.over) continue; const { ctx } = chart, { stroke } = ctx;"
        "ctx.fill = () => { marks++; };"
        "ctx.stroke = (...path) => { lines++; stroke.apply(ctx, path); }; }"
    )
    tab.wait("lines > 20")
    assert tab.run("marks") == 0


def test_a_run_that_leaves_shrinks_nothing_until_all_is_asked_for(
    tab: Tab, live: Callable[[str], Serving]
) -> None:
    visit(tab, live("pendulum_small"), play=0)
    shown = "document.getElementById('see-all').checkVisibility()"
    assert not tab.run(shown)
    alone = tab.run("curvebound.scene.drawn.scale")
    away = {"plant.slider.u_start": 40.0}
    tab.run(f"curvebound.send({{ do: 'beside', label: 'away', settings: {away} }})")
    tab.wait(shown)
    assert tab.run("curvebound.scene.drawn.scale") == alone
    tab.key("f")
    tab.wait(f"curvebound.scene.drawn.scale < {alone}")
    assert tab.run("curvebound.scene.drawn.scale") > 0.2 * alone
    tab.key("e")
    tab.wait("document.getElementById('see-all').ariaPressed === 'true'")
    tab.wait(f"curvebound.scene.drawn.scale < {0.1 * alone}")
    # both keys before the next picture
    down = "new KeyboardEvent('keydown', { key, bubbles: true })"
    tab.run(f"for (const key of 'fe') document.body.dispatchEvent({down})")
    assert tab.run("curvebound.scene.whole")
    assert tab.run("document.getElementById('see-all').ariaPressed") == "true"
    both = "curvebound.placed.map((at) => curvebound.grips.pixel(at.point('slider')))"
    width = tab.run("curvebound.scene.width")
    assert all(0 <= x <= width for x, _ in tab.run(both))
    # and of the plots: the first run is not flattened, but on demand
    tab.run("curvebound.pace(10)")
    tab.run("curvebound.toggle()")
    plot = "curvebound.plots.find(({ spec }) => spec.title === 'Slider on the parabola')"
    high = f"{plot}.chart.scales.y.max"
    tab.run(f"{plot}.element.scrollIntoView()")
    tab.wait(f"{plot}.all.checkVisibility()")
    tab.run("curvebound.toggle()")
    tab.wait(f"{high} < 10")
    tab.run(f"{plot}.all.click()")
    tab.wait(f"{high} > 30")
    press(tab, "beside")
    tab.wait(f"!{shown}")
    assert tab.errors == []


def test_closing_the_page_frees_the_fmus(
    new_tab: Callable[[], Tab],
    live: Callable[[str], Serving],
    instances: list[Instance],
) -> None:
    serving = live("two_wires")
    one, other = new_tab(), new_tab()
    visit(one, serving)
    visit(other, serving)
    assert len(serving.live.sessions) == 2
    assert sum(instance.alive for instance in instances) == 6
    one.call("Page.navigate", url="about:blank")
    serving.wait(lambda: sum(instance.alive for instance in instances) == 3)
    other.call("Page.navigate", url="about:blank")
    serving.wait(lambda: not any(instance.alive for instance in instances))


def test_another_page_cannot_connect(
    tab: Tab, live: Callable[[str], Serving], tmp_path: Path
) -> None:
    serving = live("bead_on_wire")
    page = tmp_path / "other.html"
    page.write_text("<!doctype html><title>other</title>", encoding="utf-8")
    tab.open(page, ready=False)
    said = tab.run(
        f"new Promise((done) => {{ const socket = new WebSocket('ws://{serving.host}{serving.path}socket');"
        "socket.onopen = () => done('open'); socket.onerror = () => done('refused'); })"
    )
    assert said == "refused"
    assert not serving.live.sessions


def test_the_end_of_the_server_is_said(tab: Tab, plan_of: PlanOf, tmp_path: Path) -> None:
    with served(plan_of("bead_on_wire"), tmp_path) as serving:
        visit(tab, serving)
    tab.wait("document.getElementById('trouble').textContent.includes('has ended')")
