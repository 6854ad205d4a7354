"""The page of a live scene: one answer that holds everything, and may talk to its server only."""

from __future__ import annotations

import html

from ...pages import document, filled
from ..asset_files import asset, scene_script, scene_style

__all__ = ["live_page"]

_OWN = (
    "live_samples.js",
    "live_grip.js",
    "live_controls.js",
    "live_keys.js",
    "live_view.js",
    "live_parts.js",
    "live.js",
    "live_main.js",
)


def live_page(name: str, port: int) -> str:
    """The page for a scene called `name`, served at a port of this machine."""
    body = filled(
        asset("live.html"), {"title": html.escape(name), "licence": asset("uPlot.LICENSE")}
    )
    return document(
        f"{name} (live)",
        body,
        style=scene_style("live.css"),
        script=scene_script(*_OWN),
        connect=[f"ws://127.0.0.1:{port}", f"ws://localhost:{port}"],
    )
