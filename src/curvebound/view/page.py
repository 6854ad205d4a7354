"""Puts a page together as one file that loads nothing, and forbids the browser to try."""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Mapping
from typing import Any

from .files import asset

__all__ = ["embedded_json", "page"]


def page(template: str, *, title: str, styles: str, script: str, parts: Mapping[str, str]) -> str:
    """Fill the asset `template`.

    `{{title}}` is escaped; every other part goes in as it is. The content security policy
    allows exactly these styles and this script, pictures beside the page, and nothing else.
    """
    policy = "; ".join(
        (
            "default-src 'none'",
            f"style-src '{_digest(styles)}'",
            f"script-src '{_digest(script)}'" if script else "script-src 'none'",
            "img-src 'self' data: file:",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )
    text = asset(template)
    values = {"title": html.escape(title), "policy": policy, "styles": styles, "script": script}
    # One pass over the template, so that what is put in is never looked at again.
    pieces = text.split("{{")
    out = [pieces[0]]
    for piece in pieces[1:]:
        name, rest = piece.split("}}", 1)
        out += [{**values, **parts}[name], rest]
    return "".join(out)


def embedded_json(value: Any) -> str:
    """`value` as JSON that cannot end the element which holds it."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _digest(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return "sha256-" + base64.b64encode(digest).decode("ascii")
