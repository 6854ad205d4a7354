"""Everything that can be wrong in a scene is found before anything runs, and said usefully."""

from __future__ import annotations

import math

import pytest

from curvebound.cosim import Adaptive, Scene
from curvebound.errors import CurveboundError


def scene_of(*components, **settings):
    scene = Scene("checked", **{"stop_time": 1.0, "step": 0.1, **settings})
    for name, source, *rest in components:
        scene.add(name, source, *rest)
    return scene


def problems(scene):
    with pytest.raises(CurveboundError) as caught:
        scene.check()
    return str(caught.value)


def test_all_problems_are_listed_together(mass_fmu, gain_fmu):
    scene = scene_of(("one", mass_fmu), ("block", gain_fmu, {"gian": 2.0}))
    scene.connect("one.xx", "block.u").connect("bock.y", "one.other")
    scene.record("one.speed")
    text = problems(scene)
    assert "1 problem:" in text  # names are judged once all FMUs are read
    assert "block.gian" in text
    assert "gain" in text.split("did you mean")[1]
    scene.components["block"].start = {}
    text = problems(scene)
    assert "3 problems:" in text
    assert "one.xx names no variable of one that is an output; did you mean x" in text
    assert "there is no component 'bock'; did you mean block?" in text
    assert "one.speed" in text


def test_settings_are_checked(mass_fmu):
    scene = scene_of(
        ("one", mass_fmu), step=-0.1, stop_time=0.0, algorithm="gauss_seidl", tolerance=0.0
    )
    text = problems(scene)
    for part in ("step is -0.1", "stop_time is 0.0", "did you mean gauss_seidel?", "tolerance"):
        assert part in text
    assert "no components" in problems(scene_of())


SETTINGS = [
    ({"start_time": -math.inf}, "start_time is -inf; give a finite number of seconds"),
    ({"stop_time": math.inf}, "stop_time is inf; give a finite number of seconds"),
    ({"step": math.inf}, "step is inf; give a finite number of seconds"),
    ({"step": 0.0}, "step is 0.0 s; give a macro step above zero"),
    ({"start_time": 1.0}, "stop_time is 1.0 s; give one after start_time, 1.0 s"),
    ({"hold": "frist"}, "hold is 'frist'; did you mean first"),
    ({"hold": "first", "algorithm": "strang"}, "hold is 'first' with algorithm 'strang'"),
    ({"record_every": 0}, "record_every is 0; give a whole number, 1 or more"),
    ({"record_every": 2.5}, "record_every is 2.5; give a whole number, 1 or more"),
    ({"tolerance": math.inf}, "tolerance is inf; give a number above zero, or None"),
    ({"loop_tolerance": 0.0}, "loop_tolerance is 0.0; give a number above zero, or None"),
    ({"adaptive": Adaptive(0.0)}, "adaptive.tolerance is 0.0; give a number above zero"),
]


@pytest.mark.parametrize(("settings", "words"), SETTINGS, ids=lambda case: str(case)[:30])
def test_each_setting_alone_is_named(mass_fmu, settings, words):
    text = problems(scene_of(("one", mass_fmu), **settings))
    assert "has 1 problem:\n" in text
    assert words in text


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"step": 1e-300}, "which rounding loses beside the time 1.0 s"),
        ({"step": 1e-15}, "do not fit into memory: take a longer step"),
    ],
)
def test_steps_too_short_to_run_say_what_helps(mass_fmu, settings, words):
    with pytest.raises(CurveboundError, match=words):
        scene_of(("one", mass_fmu), stop_time=1.0, **settings).run()


def test_settings_at_the_edge_are_taken(mass_fmu):
    least = {"record_every": 1, "tolerance": 5e-324, "loop_tolerance": 5e-324, "step": 5e-324}
    scene_of(("one", mass_fmu), **least).check()


def test_units_must_agree_or_be_converted(gain_fmu):
    scene = scene_of(("a", gain_fmu, {"bias": 2.0}), ("b", gain_fmu))
    scene.connect("a.y", "b.u")
    assert "a.y -> b.u joins km to m; give the factor" in problems(scene)
    scene = scene_of(("a", gain_fmu, {"bias": 2.0}), ("b", gain_fmu))
    scene.connect("a.y", "b.u", 1000.0, 5.0).record("b.y")
    assert scene.run()["b.y"][0] == 2005.0


def test_types_must_agree(gain_fmu):
    scene = scene_of(("a", gain_fmu), ("b", gain_fmu))
    scene.connect("a.count", "b.flag_in")
    assert "joins Integer to Boolean" in problems(scene)


def test_integers_and_booleans_travel(gain_fmu):
    scene = scene_of(("a", gain_fmu, {"count_in": 4, "flag_in": True}), ("b", gain_fmu))
    scene.connect("a.count", "b.count_in").connect("a.flag", "b.flag_in")
    scene.record("b.count", "b.flag")
    result = scene.run()
    assert result["b.count"].dtype.kind == "i"
    assert list(result["b.count"]) == [6] * 11
    assert result["b.flag"].dtype.kind == "b"
    assert result["b.flag"].all()


def test_an_input_is_driven_once(mass_fmu):
    scene = scene_of(("one", mass_fmu), ("two", mass_fmu))
    scene.connect("one.x", "two.other").connect("one.v", "two.other")
    assert "two.other is driven twice, by one.x and by one.v" in problems(scene)
    scene = scene_of(("one", mass_fmu), ("two", mass_fmu))
    scene.connect("one.x", "two.other").input("two.other", 1.0)
    assert "two.other is driven twice, by one.x and by the scene" in problems(scene)


@pytest.mark.parametrize("jumps", [[math.nan, 0.5], ["a"], 0.5, [None]], ids=str)
def test_jumps_are_times(mass_fmu, jumps):
    with pytest.raises(CurveboundError, match=r"jumps of input one\.other: .* list of times in s"):
        scene_of(("one", mass_fmu)).input("one.other", lambda t: 0.0, jumps=jumps)


def test_unconnected_inputs_are_listed_once(mass_fmu):
    scene = scene_of(("one", mass_fmu), ("two", mass_fmu))
    scene.connect("one.x", "two.other")
    assert scene.check().notes == ["Inputs left at their start values: one.other."]
    scene.set("one.other", 0.0)
    assert scene.check().notes == []


def test_start_values_have_their_types(gain_fmu):
    scene = scene_of(("a", gain_fmu, {"gain": "two", "failure": 1.5, "square": "perhaps"}))
    text = problems(scene)
    assert "a.gain: 'two' is not a number" in text
    assert "a.failure: 1.5 is not an integer" in text
    assert "a.square: 'perhaps' is not true or false" in text
    scene = scene_of(("a", gain_fmu, {"gain": "2", "failure": 2.0, "square": "true", "u": 3.0}))
    assert scene.record("a.y").run()["a.y"][-1] == 18.0


def test_outputs_take_no_start_value(mass_fmu):
    assert "takes no start value" in problems(scene_of(("one", mass_fmu, {"x": 1.0})))


def test_missing_fmu_is_named(tmp_path):
    assert "There is no FMU at" in problems(scene_of(("one", tmp_path / "absent.fmu")))
    broken = tmp_path / "broken.fmu"
    broken.write_bytes(b"no archive")
    assert "cannot be read as an FMU" in problems(scene_of(("one", broken)))


def test_algebraic_loop_is_printed(gain_fmu):
    scene = scene_of(("a", gain_fmu), ("b", gain_fmu))
    scene.connect("a.y", "b.u", 1.0).connect("b.y", "a.u", 1.0)
    text = problems(scene)
    assert "algebraic loop: " in text
    assert "a.y -> b.u" in text
    assert "b.y -> a.u" in text
    assert "set loop_tolerance" in text


@pytest.mark.parametrize("gain", [0.5, -0.9, -3.0, 20.0])
def test_loops_are_iterated_where_asked(gain_fmu, gain):
    """y_a = gain y_b + 1, y_b = y_a: y = 1 / (1 - gain), far beyond fixed-point convergence."""
    scene = scene_of(("a", gain_fmu, {"gain": gain, "bias": 1.0}), ("b", gain_fmu))
    scene.loop_tolerance = 1e-12
    scene.connect("a.y", "b.u", 1.0).connect("b.y", "a.u", 1.0).record("a.y", "b.y")
    result = scene.run()
    assert result["a.y"] == pytest.approx(1.0 / (1.0 - gain), rel=1e-10)
    assert result["b.y"] == pytest.approx(1.0 / (1.0 - gain), rel=1e-10)


def test_a_loop_without_solution_says_so(gain_fmu):
    """y = y^2 + 1 has no real solution."""
    scene = scene_of(("a", gain_fmu, {"square": True, "bias": 1.0}), ("b", gain_fmu))
    scene.loop_tolerance = 1e-9
    scene.connect("a.y", "b.u", 1.0).connect("b.y", "a.u", 1.0)
    with pytest.raises(CurveboundError, match=r"loop over .*a\.y.* did not converge"):
        scene.run()


def test_declared_dependencies_can_be_overruled(gain_fmu):
    scene = scene_of(stop_time=0.3)
    scene.add("a", gain_fmu, {"bias": 1.0}, feedthrough=False).add("b", gain_fmu)
    scene.connect("a.y", "b.u", 1.0).connect("b.y", "a.u", 1.0).record("a.y", "b.y")
    # a counts as a state: initialization and each step carry the value once around
    assert list(scene.run()["a.y"]) == [2.0, 3.0, 4.0, 5.0]
    scene.components["a"].feedthrough = {"y": ["uu"]}
    assert "feedthrough of a names uu; did you mean u?" in problems(scene)


def test_feedthrough_chains_are_evaluated_in_dependency_order(gain_fmu):
    """A value passes through a long chain at one communication point, against the given order."""
    scene = scene_of(step=0.5)
    for i in reversed(range(20)):
        scene.add(f"c{i}", gain_fmu, {"gain": 2.0})
        if i < 19:
            scene.connect(f"c{i}.y", f"c{i + 1}.u", 1.0)
    scene.input("c0.u", lambda t: 1.0 + t)
    result = scene.record("c19.y").run()
    assert list(result["c19.y"]) == [2.0**20 * (1.0 + t) for t in (0.0, 0.5, 1.0)]


def test_strang_needs_two_groups(mass_fmu):
    scene = scene_of(("a", mass_fmu), ("b", mass_fmu), ("c", mass_fmu), algorithm="strang")
    for source, target in ("ab", "bc", "ca"):
        scene.connect(f"{source}.x", f"{target}.other")
    assert "strang needs two groups" in problems(scene)
    scene.groups = (["a"], ["b", "c"])
    assert "b -> c stays within one" in problems(scene)


def test_order_names_every_component(mass_fmu):
    scene = scene_of(("a", mass_fmu), ("b", mass_fmu), order=["a"])
    assert "order must name each component once: a, b" in problems(scene)


def test_connect_matching_takes_equal_names(mass_fmu, gain_fmu):
    scene = scene_of(("one", mass_fmu), ("block", gain_fmu)).connect_matching("one", "block")
    assert "no output of one has the name of an input of block" in problems(scene)
    scene = scene_of(("one", mass_fmu)).connect_matching("one", "tow")
    assert "there is no component 'tow'" in problems(scene)


def test_setting_by_name(mass_fmu):
    scene = scene_of(("one", mass_fmu))
    scene.set("one.k", 3.0).set("step", "0.05").set("algorithm", "jacobi")
    assert scene.components["one"].start == {"k": 3.0}
    assert (scene.step, scene.algorithm) == (0.05, "jacobi")
    with pytest.raises(CurveboundError, match="no component on; did you mean one"):
        scene.set("on.k", 1.0)
    with pytest.raises(CurveboundError, match="did you mean step"):
        scene.set("stepp", 1.0)


def test_a_component_is_no_variable(mass_fmu):
    with pytest.raises(CurveboundError, match=r"one is a component: name a variable of it, one\."):
        scene_of(("one", mass_fmu)).set("one", 3.0)


def test_copies_are_independent(mass_fmu):
    scene = scene_of(("one", mass_fmu, {"k": 1.0})).record("one.x").variant("soft", {"one.k": 0.1})
    other = scene.copy("other")
    other.set("one.k", 2.0).record("one.v")
    assert scene.components["one"].start == {"k": 1.0}
    assert scene.recorded == ["one.x"]
    assert scene.with_variant("soft").components["one"].start == {"k": 0.1}
    with pytest.raises(CurveboundError, match=r"no variant 'sof'; did you mean soft"):
        scene.with_variant("sof")


def test_only_recorded_outputs_are_read(mass_fmu):
    scene = scene_of(("one", mass_fmu), ("two", mass_fmu))
    scene.connect("one.x", "two.other").record("two.v")
    system = scene.check()
    assert set(system.levels) == {("one", "x"), ("two", "v")}
    assert scene.run().names == ["two.v"]


def test_nothing_asked_for_records_what_is_needed_or_all(mass_fmu):
    scene = scene_of(("one", mass_fmu))
    assert scene.run().names == ["one.x", "one.v"]
    scene.needs.errors["one.v"] = 1e-3
    assert scene.run().names == ["one.v"]
