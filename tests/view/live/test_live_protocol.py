"""What a page may ask for, and what is refused."""

from __future__ import annotations

import json
import random
from contextlib import suppress
from typing import Any

import pytest

from curvebound.view.live.protocol import Malformed, parse

GOOD: list[dict[str, Any]] = [
    {"do": "play"},
    {"do": "speed", "value": 2},
    {"do": "set", "path": "drive.feedback.slider_u", "value": -3.5},
    {"do": "set", "path": "drive.flag", "value": True},
    {"do": "restart", "settings": {"step": "0.01", "plant.slider.mass": 2}},
    {"do": "pull", "grip": 0, "x": 0.5, "y": -1},
]


@pytest.mark.parametrize("command", GOOD)
def test_commands(command: dict[str, Any]) -> None:
    name, fields = parse(json.dumps(command))
    assert {"do": name, **fields} == command


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (b"\x00\x01", "text"),
        ("", "JSON"),
        ("{", "JSON"),
        ("[" * 60_000, "JSON"),
        ('{"do":"speed","value":NaN}', "NaN is no number"),
        ('{"do":"speed","value":-Infinity}', "no number"),
        ('{"do":"speed","value":1e999}', "finite"),
        ('{"do":"speed","value":1' + "0" * 400 + "}", "finite"),
        ('{"do":"speed","value":1' + "0" * 9000 + "}", "JSON"),
        ('{"do":"speed","value":"1"}', "finite"),
        ('{"do":"speed","value":true}', "finite"),
        ('{"do":"speed"}', "tells value"),
        ('{"do":"play","more":1}', "tells nothing"),
        ('{"do":"__init__"}', "no command"),
        ('{"do":["play"]}', "no command"),
        ('{"do":null}', "no command"),
        ('["play"]', "object"),
        ("3", "object"),
        ('{"do":"set","path":3,"value":1}', "text"),
        ('{"do":"set","path":"a.b","value":[1]}', "number"),
        ('{"do":"restart","settings":[1]}', "settings"),
        ('{"do":"restart","settings":{"a":{"b":1}}}', "settings"),
        (json.dumps({"do": "restart", "settings": {"a": "x" * 1000}}), "settings"),
    ],
)
def test_what_is_malformed_is_told_why(message: str | bytes, said: str) -> None:
    with pytest.raises(Malformed, match=said) as refused:
        parse(message)
    assert len(str(refused.value)) < 500


def test_noise_is_refused_and_nothing_else_happens() -> None:
    random.seed(1)
    good = [json.dumps(one) for one in GOOD]
    for _ in range(3000):
        text = list(random.choice(good))
        for _ in range(random.randrange(1, 4)):
            text[random.randrange(len(text))] = chr(
                random.choice([0, 34, 44, 58, 93, 123, 125, 233])
            )
        with suppress(Malformed):
            parse("".join(text))
