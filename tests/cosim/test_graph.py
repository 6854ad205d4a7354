"""Orders of evaluation and of stepping, on graphs small and large."""

from __future__ import annotations

import random

from curvebound.cosim.graph import components, levels, stepping_order, two_groups


def test_components_come_in_topological_order():
    graph = {"a": ["b"], "b": ["c"], "c": ["b", "d"], "d": [], "e": ["a"]}
    found = components(graph)
    assert sorted(map(sorted, found)) == [["a"], ["b", "c"], ["d"], ["e"]]
    place = {node: i for i, group in enumerate(found) for node in group}
    assert place["e"] < place["a"] < place["b"] == place["c"] < place["d"]


def test_components_of_random_graphs_agree_with_reachability():
    rng = random.Random(3)
    for _ in range(50):
        n = rng.randint(1, 12)
        graph = {i: [j for j in range(n) if rng.random() < 0.15] for i in range(n)}
        reach = {i: {i} for i in graph}
        for _ in range(n):
            for i in graph:
                for j in list(reach[i]):
                    reach[i] |= set(graph[j])
        place = {node: i for i, group in enumerate(components(graph)) for node in group}
        for i in graph:
            for j in graph:
                assert (place[i] == place[j]) == (j in reach[i] and i in reach[j])
                if j in reach[i]:
                    assert place[i] <= place[j]


def test_a_chain_of_ten_thousand_is_no_trouble():
    n = 10_000
    depends = {i: [i - 1] if i else [] for i in range(n)}
    level, loops = levels(depends, {})
    assert level[n - 1] == n - 1
    assert not loops
    level, loops = levels({**depends, 0: [n - 1]}, {})
    assert len(loops) == 1
    assert len(loops[0].circle) == n


def test_levels_respect_what_enters_from_outside():
    level, loops = levels({"a": [], "b": [], "c": ["a", "b"]}, {"b": 1})
    assert level == {"a": 0, "b": 1, "c": 2}
    assert loops == []


def test_loops_show_a_shortest_circle():
    _, loops = levels({"a": ["c", "b"], "b": ["a"], "c": ["b"]}, {})
    assert sorted(loops[0].members) == ["a", "b", "c"]
    assert len(loops[0].circle) == 2


def test_feedthrough_decides_where_a_circle_begins():
    # a controller (feedthrough to the plant) and a plant whose states go back to it
    edges = {"plant": {"drive": False}, "drive": {"plant": True}}
    assert stepping_order(["plant", "drive"], edges) == ["drive", "plant"]
    assert stepping_order(["b", "a"], {"a": {"b": False}, "b": {"a": False}}) == ["b", "a"]
    assert stepping_order(["c", "b", "a"], {"a": {"b": False}, "b": {"c": False}}) == list("abc")


def test_two_groups():
    assert two_groups("abc", {"a": "b", "b": "c"}) == (["a", "c"], ["b"])
    assert two_groups("abc", {"a": "b", "b": "c", "c": "a"}) is None
    assert two_groups("ab", {"a": "a"}) is None
