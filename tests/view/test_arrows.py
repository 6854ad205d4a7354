"""Arrows of velocities and forces: where they point, how long they are, what is said of others."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import Tab
from legible import SCREENS, SIZES
from motions import bead, without

from curvebound.cosim import Scene
from curvebound.errors import CurveboundError
from curvebound.fmi.drawing import Arrow, Drawing, mass_arrows
from curvebound.fmi.folder import find, shipped_drawings
from curvebound.view import write_picture, write_replay
from curvebound.view.actors import find_actors
from curvebound.view.arrows import kinds_of, vectors_of, wanted
from curvebound.view.quivers import Quivers, _round, strip_for
from curvebound.view.reading import opened, with_inputs
from curvebound.view.stage import Cast, Stage, colour_of, figure

#: the shafts of the first kind of arrow at time t: begin, end, colour; the camera and the height
SHAFTS = """((t) => {
  const scene = curvebound.scene, real = scene.context, lines = [];
  let from = null, to = null;
  scene.context = new Proxy(real, {
    get(c, key) {
      if (key === "moveTo") return (...at) => { from = at; c.moveTo(...at); };
      if (key === "lineTo") return (...at) => { to = at; c.lineTo(...at); };
      if (key === "stroke") return () => { lines.push([from, to, c.strokeStyle]); c.stroke(); };
      return typeof c[key] === "function" ? c[key].bind(c) : c[key];
    },
    set(c, key, value) { c[key] = value; return true; },
  });
  try { scene.draw(t); } finally { scene.context = real; }
  const { actors } = curvebound.colours;
  return [lines.filter(([, , colour]) => colour === actors[6]), scene.drawn, scene.full];
})"""


def shown(data: Any) -> list[tuple[str, Any, Any]]:
    (result,) = opened(data, shipped_drawings())
    return [("it", actor, result.data) for actor in find_actors(result.data, result.drawings)]


def known(name: str) -> Drawing:
    return find(name).drawing()._replace(known=True)


def test_every_force_and_velocity_is_that_of_the_motion() -> None:
    """Mass times acceleration is the sum of the arrows: constraint, gravity, applied."""
    data = bead(2.0, 1e-3)
    ((_, actor, _),) = shown(data)
    actor = type(actor)(known("BeadOnWire"), actor.prefix, actor.size, actor.places)
    found = {one.arrow.name: one for one in vectors_of(actor, data)}
    assert set(found) == {"velocity", "gravity", "constraint force"}  # bead.fx is not recorded
    inner = slice(2, -2)
    for axis, force in (("x", lambda one: one.x), ("y", lambda one: one.y)):
        velocity = np.gradient(data[f"bead.bead.{axis}"], data["time"])
        assert force(found["velocity"])[inner] == pytest.approx(velocity[inner], abs=1e-4)
        pushed = np.gradient(data[f"bead.bead.v{axis}"], data["time"])  # of 1 kg
        total = force(found["gravity"]) + force(found["constraint force"])
        assert total[inner] == pytest.approx(pushed[inner], abs=1e-3)


def test_the_forces_on_two_bodies_move_them(fmus: Path) -> None:
    scene = Scene("moved", stop_time=1.0, step=1e-3)
    start = {"slider.mass": 2.0, "pendulum.mass": 0.5, "solver.method": "adaptive"}
    scene.add("plant", fmus / "ParabolaPendulum.fmu", start)
    scene.input("plant.parabola.ax", lambda t: 2.0)
    scene.input("plant.pendulum.fx", lambda t: 1.0)
    ((_, actor, data),) = shown(scene.run())
    vectors = vectors_of(actor, data)
    for point, body, mass in (("slider", "slider", 2.0), ("bob", "pendulum", 0.5)):
        for axis in "xy":
            acting = [one for one in vectors if one.arrow.at == point and one.arrow.unit == "N"]
            assert len(acting) == (4 if point == "slider" else 3)
            total = sum(one.x if axis == "x" else one.y for one in acting)
            moved = mass * np.gradient(data[f"plant.{body}.v{axis}"], data["time"])
            assert total[2:-2] == pytest.approx(moved[2:-2], abs=1e-3)


def test_what_is_not_recorded_is_said_and_not_guessed() -> None:
    data = without(bead(1.0, 0.01), "bead.constraint.force")
    kinds = {kind.name: kind for kind in kinds_of(shown(data))}
    assert kinds["velocity"].drawn
    assert not kinds["constraint force"].drawn
    assert kinds["constraint force"].lacks == ("constraint.force not recorded",)
    # of columns alone nobody knows the mass: that of the declaration may be another
    assert kinds["gravity"].lacks == ("bead.mass, gravity.x, gravity.y not recorded",)
    with pytest.raises(CurveboundError, match=r"gravity: bead\.mass, .* not recorded"):
        wanted("velocity, Gravity", list(kinds.values()))
    with pytest.raises(CurveboundError, match="There is no arrow 'lift': choose of velocity"):
        wanted("lift", list(kinds.values()))
    assert [one.name for one in wanted("all", list(kinds.values()))] == ["velocity"]


def test_a_run_knows_its_masses_and_what_acts_on_its_inputs(fmus: Path) -> None:
    scene = Scene("pushed", stop_time=1.0, step=0.1)
    scene.add("plant", fmus / "BeadOnWire.fmu", {"bead.mass": 3.0, "bead.fy": 2.0})
    scene.input("plant.bead.fx", ([0.0, 0.5, 0.5], [0.0, 0.0, 4.0]))
    result = scene.run()
    (told,) = shown(result)
    found = {one.arrow.name: one for one in vectors_of(*told[1:])}
    assert found["gravity"].y == pytest.approx(-3.0 * 9.81)
    assert found["applied force"].x.tolist() == [0.0] * 5 + [4.0] * 6
    assert found["applied force"].y.tolist() == [2.0] * 11
    assert "plant.bead.fx" in (with_inputs(result).dtype.names or ())
    assert "plant.bead.fx" not in result.names, "the result itself stays as it was asked for"


def test_a_link_drives_an_arrow_where_its_source_is_recorded(fmus: Path) -> None:
    def built(*recorded: str) -> list[str]:
        scene = Scene("linked", stop_time=0.5, step=0.1)
        scene.add("one", fmus / "BeadOnWire.fmu")
        scene.add("other", fmus / "BeadOnWire.fmu")
        scene.connect("one.wire.fx", "other.bead.fx")
        scene.record("one.bead.*", "other.bead.*", *recorded)
        result = scene.run()
        if recorded:
            assert result.inputs["other.bead.fx"].tolist() == result["one.wire.fx"].tolist()
        return [name for name in result.inputs if name == "other.bead.fx"]

    assert built("one.wire.fx") == ["other.bead.fx"]
    assert built() == []


def test_declared_arrows_are_checked() -> None:
    from curvebound.fmi.drawing import complete

    fmu = find("BeadOnWire").fmu()
    for arrow, said in (
        (Arrow("lift", "L", "bead", "bead.fx", "bead.fz"), "names 'bead.fz'"),
        (Arrow("lift", "L", "wing", "bead.fx", "bead.fy"), "names 'wing'"),
    ):
        bare = Drawing(points=find("BeadOnWire").drawing().points, arrows=(arrow,))
        with pytest.raises(CurveboundError, match=said):
            complete(bare, fmu)
    assert [one.name for one in mass_arrows("bead")] == ["velocity", "applied force", "gravity"]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("arrows") / "bead.html"
    return write_replay([("bead", BEAD)], out)


BEAD = bead(4.0, 0.02)


def test_keys_draw_arrows_to_scale(tab: Tab, page: Path) -> None:
    """From the body, along its velocity; the greatest usual one a share of the height."""
    tab.open(page)
    assert tab.run(f"{SHAFTS}(1)")[0] == []
    tab.key("w")
    kinds = {one["name"]: one for one in tab.run("[...curvebound.arrows.shown]")}
    assert set(kinds) == {"velocity"}
    i = 77
    lines, camera, height = tab.run(f"{SHAFTS}({float(BEAD['time'][i])!r})")
    (begin, end, _), key = lines  # the other is in the legend
    scale = 0.22 * height / kinds["velocity"]["size"]
    x, y, vx, vy = (BEAD[f"bead.bead.{name}"][i] for name in ("x", "y", "vx", "vy"))
    at = [camera["left"] + x * camera["scale"], camera["bottom"] - y * camera["scale"]]
    assert begin == pytest.approx(at, abs=0.1)
    along = np.array(end) - begin
    assert math.atan2(-along[1], along[0]) == pytest.approx(math.atan2(vy, vx), abs=0.02)
    length = scale * math.hypot(vx, vy)
    assert np.hypot(*along) == pytest.approx(length - min(9, 0.6 * length), abs=0.5)
    assert key[0][0] == 12
    assert key[0][1] > tab.run("curvebound.scene.height") > height - 40
    # not overwritten by what is to be said of the time once the page rests
    said = "document.getElementById('spoken').textContent"
    assert tab.run(said) == "arrows: velocity"
    tab.run("curvebound.announce(1); curvebound.nextArrows()")
    heard = tab.run(f"new Promise((r) => setTimeout(() => r({said}), 600))")
    assert heard == "arrows: constraint force"


def test_a_long_arrow_is_cut_and_says_so(tab: Tab, page: Path) -> None:
    tab.open(page)
    tab.run("curvebound.nextArrows(); curvebound.arrows.kinds[0].size /= 100")
    texts = tab.run(
        "(() => { const said = [], c = curvebound.scene.context, real = c.fillText.bind(c);"
        "c.fillText = (text, ...at) => { said.push(text); real(text, ...at); };"
        "curvebound.scene.draw(1.5); delete c.fillText; return said; })()"
    )
    assert any(text.startswith("v \u00d7") for text in texts)


@SCREENS
def test_the_row_of_arrows_is_read_and_covers_nothing(
    tab: Tab, page: Path, size: tuple[int, int, bool], dark: bool
) -> None:
    width, height, mobile = size
    tab.size(width, height, mobile=mobile, ratio=2 if mobile else 1)
    tab.dark(dark)
    tab.open(page)
    below = "document.getElementById('plot-area').getBoundingClientRect().top"
    before = tab.run(below)
    tab.run("document.getElementById('arrows-button').click()")
    assert tab.run("document.getElementById('arrows-button').ariaExpanded") == "true"
    assert tab.run(below) > before, "what is below makes room"
    assert tab.run("document.documentElement.scrollWidth") <= width
    labels = tab.run(
        "[...document.querySelectorAll('#arrows label')].map((one) => "
        "[one.textContent, one.control.disabled])"
    )
    told = dict(labels)
    assert told["velocity (v, m/s)"] is False
    assert told["constraint force (C, N)"] is False
    assert told["gravity (G, N): bead.mass, gravity.x, gravity.y not recorded"] is True
    tab.run("document.querySelector('#arrows label').control.click()")
    assert tab.run("[...curvebound.arrows.shown].map(({ name }) => name)") == ["velocity"]
    assert tab.errors == []


def test_pictures_show_what_is_asked_for(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    image = pytest.importorskip("PIL.Image")
    drawn = write_picture(bead(1.0, 0.02), tmp_path / "a.png", arrows="velocity,constraint force")
    picture = np.asarray(image.open(drawn).convert("RGB")).astype(int)
    for number, there in ((6, True), (5, True), (4, False)):  # the last is gravity
        colour = [int(colour_of(number)[i : i + 2], 16) for i in (1, 3, 5)]
        assert ((np.abs(picture - colour).max(axis=2) < 8).sum() > 25) == there


#: the texts of a drawing, and where its legend is
STRIP = """(() => { const { scene } = curvebound, c = scene.context, ratio = scene.ratio;
  const texts = [], fill = c.fillText.bind(c);
  c.fillText = (text, x, y) => {
    texts.push([text, x, y, c.measureText(text).width]);
    fill(text, x, y);
  };
  scene.draw(scene.drawn.time); delete c.fillText;
  return { texts, top: scene.height, full: scene.full, width: scene.width }; })()"""


@pytest.mark.parametrize("size", SIZES)
def test_the_legend_has_a_strip_of_its_own(
    tab: Tab, page: Path, size: tuple[int, int, bool]
) -> None:
    """Zoomed in, curves and rods cross the whole drawing, but not what tells the arrows."""
    width, height, mobile = size
    tab.size(width, height, mobile=mobile, ratio=2 if mobile else 1)
    tab.open(page)
    fitted = tab.run("curvebound.scene.drawn.scale")
    tab.run("curvebound.scene.arrows.shown = new Set(curvebound.arrows.kinds)")
    told = tab.run(STRIP)
    assert 0.6 * fitted < tab.run("curvebound.scene.drawn.scale") < fitted, "it makes room"
    keys = [one for one in told["texts"] if one[2] > told["top"]]
    assert len(keys) == len(tab.run("curvebound.arrows.kinds"))
    assert all(x >= 0 and x + wide <= told["width"] for _, x, _, wide in keys)
    assert all(told["top"] + 8 < y < told["full"] for *_, y, _ in keys)
    strip = (
        "(() => { const { scene } = curvebound, { ratio } = scene; scene.draw(scene.drawn.time);"
        "return [...scene.context.getImageData(0, Math.ceil((scene.height + 1) * ratio),"
        "scene.canvas.width, Math.floor((scene.full - scene.height - 1) * ratio)).data]; })()"
    )
    before = np.array(tab.run(strip))
    for _ in range(3):
        tab.run("curvebound.scene.zoomBy(2)")
        assert np.abs(np.array(tab.run(strip)) - before).max() <= 2


@pytest.mark.parametrize("film", [False, True])
def test_the_legend_of_a_picture_stands_below_its_axes(film: bool) -> None:
    pytest.importorskip("matplotlib")
    from matplotlib.quiver import QuiverKey

    cast = Cast([("bead", BEAD)])
    drawn = figure(4.2, 4.2, 100)
    axes = drawn.add_axes((0.02, 0.02, 0.96, 0.96) if film else (0.1, 0.1, 0.85, 0.8))
    stage = Stage(axes, [one.actor for one in cast.actors], strip_for(cast, "all"))
    axes.tick_params(labelbottom=not film)
    Quivers(stage, cast, "all").move(1.0)
    drawn.canvas.draw()
    keys = [one for one in axes.get_children() if isinstance(one, QuiverKey)]
    boxes = [one.text.get_window_extent() for one in keys]
    assert len(boxes) == 2
    ticks = [] if film else [one.get_window_extent().y0 for one in axes.get_xticklabels()]
    assert max(box.y1 for box in boxes) < min([axes.get_window_extent().y0, *ticks])
    assert min(box.y0 for box in boxes) >= 0


@pytest.mark.parametrize(
    ("least", "rounded"),
    [(1.0, 1.0), (1.01, 2.0), (2.0, 2.0), (2.1, 5.0), (5.0, 5.0), (5.1, 10.0), (9.9, 10.0),
     (0.03, 0.05), (4.9e-7, 5e-7), (1.2e6, 2e6), (1.0 + 1e-7, 1.0), (1.0 + 1e-5, 2.0)],
)  # fmt: skip
def test_keys_are_one_two_or_five_times_a_power_of_ten(least: float, rounded: float) -> None:
    assert _round(least) == pytest.approx(rounded, rel=1e-12)
