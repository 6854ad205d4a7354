"""The page of a live scene: one answer that holds everything, and may talk to its server only."""

from __future__ import annotations

import html

from ...pages import common_style, document, filled
from ..asset_files import asset

__all__ = ["live_page"]

_SCRIPTS = (
    "data.js",
    "format.js",
    "formula.js",
    "ruler.js",
    "scene.js",
    "shared.js",
    "bounds.js",
    "saving.js",
    "plots.js",
    "gestures.js",
    "live_samples.js",
    "live_grip.js",
    "live_controls.js",
    "live_keys.js",
    "live_parts.js",
    "live.js",
    "live_main.js",
)


def live_page(name: str, port: int) -> str:
    """The page for a scene called `name`, served at a port of this machine."""
    ours = "\n".join(asset(script) for script in _SCRIPTS)
    body = filled(
        asset("live.html"), {"title": html.escape(name), "licence": asset("uPlot.LICENSE")}
    )
    return document(
        f"{name} (live)",
        body,
        style="\n".join(
            (asset("uPlot.min.css"), common_style(), asset("replay.css"), asset("live.css"))
        ),
        script=f'{asset("uPlot.iife.min.js")}\n(() => {{\n"use strict";\n{ours}}})();\n',
        connect=[f"ws://127.0.0.1:{port}", f"ws://localhost:{port}"],
    )
