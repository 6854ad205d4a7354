"""One page with a card per scene: what it looks like, what it shows, what it costs."""

from __future__ import annotations

import html
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote

from ..pages import THEMES, common_style, document, filled, write_page
from .asset_files import asset
from .picture import dark_of

__all__ = ["Card", "write_gallery"]


@dataclass(frozen=True)
class Card:
    """A scene in the gallery.

    `picture` is a PNG, beside which its dark variant may lie. `links` leads from words to pages;
    those that do not exist are left out.
    `settings`, `error` and `cost` are shown as they are, with their units.
    """

    title: str
    shows: str
    picture: Path | None = None
    settings: Mapping[str, str] = field(default_factory=dict)
    error: str = ""
    cost: str = ""
    links: Mapping[str, Path] = field(default_factory=dict)


def write_gallery(
    cards: Sequence[Card],
    out: Path,
    title: str = "Bodies bound to curves",
    introduction: str = "",
    links: Mapping[str, Path] | None = None,
) -> Path:
    """Write the gallery of `cards` to the HTML file `out`; links and pictures are relative to it.

    `links` are pages about all scenes (studies, stability maps), listed under the introduction.
    """
    body = filled(
        asset("gallery.html"),
        {
            "title": html.escape(title),
            "introduction": f"<p>{html.escape(introduction)}</p>" if introduction else "",
            "links": _links(links or {}, out),
            "cards": "\n".join(_card(card, out) for card in cards)
            or "<p>No scene has been run yet.</p>",
        },
    )
    style = common_style() + asset("gallery.css")
    return write_page(out, document(title, THEMES + body, style=style))


def _card(card: Card, out: Path) -> str:
    said = html.escape
    main = next((path for path in card.links.values() if path.exists()), None)
    picture = ""
    if card.picture and card.picture.exists():
        dark = dark_of(card.picture)
        variants = {"on-light": card.picture, "on-dark": dark}
        if not dark.exists():
            variants = {"on-white": card.picture}
        # those that are not shown are not loaded
        picture = "".join(
            f'<img class="{kind}" src="{_address(path, out)}" alt="{said(_alternative(card))}" '
            'loading="lazy">'
            for kind, path in variants.items()
        )
        if main:
            picture = f'<a href="{_address(main, out)}" tabindex="-1">{picture}</a>'
    rows = [*card.settings.items()]
    rows += [(name, value) for name, value in (("error", card.error), ("cost", card.cost)) if value]
    table = "".join(f"<dt>{said(name)}</dt><dd>{said(value)}</dd>" for name, value in rows)
    return (
        f"<article>{picture}<div><h2>{said(card.title)}</h2><p>{said(card.shows)}</p>"
        + (f"<dl>{table}</dl>" if table else "")
        + _links(card.links, out)
        + "</div></article>"
    )


def _alternative(card: Card) -> str:
    return f"{card.title}: drawing of the motion, and plots over time"


def _links(links: Mapping[str, Path], out: Path) -> str:
    made = [
        f'<a href="{_address(path, out)}">{html.escape(words)}</a>'
        for words, path in links.items()
        if path.exists()
    ]
    return f"<nav>{''.join(made)}</nav>" if made else ""


def _address(path: Path, out: Path) -> str:
    """`path` as seen from the page, as an address."""
    relative = os.path.relpath(path.resolve(), out.resolve().parent)
    return html.escape(quote(Path(relative).as_posix()))
