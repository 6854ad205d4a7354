"""Colours that stand out from their paper, and from one another for the colour-blind too."""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np
import pytest

from curvebound.pages import common_style

# Machado, Oliveira and Fernandes (2009), severity 1, on linear RGB
BLINDNESS = {
    "none": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "tritanopia": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}


def themes() -> dict[str, dict[str, str]]:
    blocks = re.findall(r"(:root[^{]*)\{([^}]*)\}", common_style())
    found = [dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block)) for _, block in blocks]
    assert len(found) == 3
    assert found[1] == found[2], "dark by choice is dark by system"
    return {"light": found[0], "dark": found[1]}


def linear(colour: str) -> np.ndarray:
    c = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def luminance(colour: str) -> float:
    return float(linear(colour) @ [0.2126, 0.7152, 0.0722])


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIE L*a*b*, D65."""
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    x, y, z = np.cbrt(np.clip(to_xyz @ rgb / [0.9505, 1.0, 1.089], 1e-6, None))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_contrast(theme: str) -> None:
    """WCAG 2.1: 4.5 for text, 3 for what must be seen."""
    colours = themes()[theme]
    for ground in ("paper", "page"):
        assert contrast(colours["ink"], colours[ground]) > 7
        assert contrast(colours["muted"], colours[ground]) > 4.5
    assert contrast(colours["accent"], colours["on-accent"]) > 4.5
    assert contrast(colours["curve"], colours["paper"]) > 3
    for number in range(8):
        assert contrast(colours[f"result-{number}"], colours["paper"]) > 3, number


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("blindness", BLINDNESS)
def test_results_are_told_apart_by_all(theme: str, blindness: str) -> None:
    """A difference of 2 is just seen (CIE 1976), one of 10 at a glance."""
    colours = [linear(themes()[theme][f"result-{number}"]) for number in range(8)]
    seen = [lab(np.clip(BLINDNESS[blindness] @ colour, 0, 1)) for colour in colours]
    for (i, one), (k, other) in combinations(enumerate(seen), 2):
        assert np.linalg.norm(one - other) > (20 if k < 4 else 11), (i, k)
