"""The one writer of HTML pages: one file each that loads nothing, and forbids the browser to try.

For studies, stability maps, the gallery, replays and the documentation in FMUs: the frame of a
page, tables, figures, data. Colours are in common.css, the look of pages to read in report.css.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..files import write_whole
from ..numbers import plain

__all__ = [
    "NARROW",
    "THEMES",
    "Html",
    "common_style",
    "document",
    "embedded_json",
    "figure",
    "filled",
    "palette",
    "report",
    "table",
    "themed",
    "write_page",
]


#: behind the name of a drawing that is for narrow screens
NARROW = "_narrow"
#: at the top of a page without a script: whoever reads it chooses its colours, see common.css
THEMES = (
    '<p class="themes" role="radiogroup" aria-label="Colours">'
    '<label><input type="radio" name="theme" checked>Auto</label>'
    '<label><input type="radio" name="theme" id="theme-light">Light</label>'
    '<label><input type="radio" name="theme" id="theme-dark">Dark</label></p>\n'
)


class Html(str):
    """Text that is HTML already and goes into a page as it is."""


def document(
    title: str,
    body: str,
    *,
    style: str,
    script: str = "",
    drawings: bool = False,
    connect: Sequence[str] = (),
) -> str:
    """A whole page.

    title: text, escaped here; body: HTML; style, script: what the page's own elements hold.
    drawings: whether the body holds drawings (SVG) with styles of their own.
    connect: addresses that the script may talk to.
    The content security policy allows exactly this script and style, pictures beside the page, and
    nothing else.
    """
    policy = "; ".join(
        (
            "default-src 'none'",
            "style-src 'unsafe-inline'" if drawings else f"style-src '{_digest(style)}'",
            f"script-src '{_digest(script)}'" if script else "script-src 'none'",
            "img-src 'self' data: file:",
            *([f"connect-src {' '.join(connect)}"] if connect else []),
            "base-uri 'none'",
            "form-action 'none'",
        )
    )
    end = f"<script>{script}</script>\n" if script else ""
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n<link rel="icon" href="data:,">\n'
        f"<title>{html.escape(title)}</title>\n<style>{style}</style>\n</head>\n"
        f"<body>\n{body.strip()}\n{end}</body>\n</html>\n"
    )


def report(title: str, body: str, footer: str = "") -> str:
    """A page to read, with drawings, tables and figures; body and footer are HTML."""
    style = common_style() + (files(__package__) / "report.css").read_text(encoding="utf-8")
    end = f"\n<footer>{footer}</footer>" if footer else ""
    return document(title, THEMES + body + end, style=style, drawings=True)


def common_style() -> str:
    """Colours of both themes, and what all pages share."""
    return (files(__package__) / "common.css").read_text(encoding="utf-8")


def palette(*, dark: bool = False) -> dict[str, str]:
    """The colours of a theme by their names in common.css: ink, paper, result-0 and so on."""
    block = common_style().split("{", 3)[2 if dark else 1].split("}", 1)[0]
    return dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block))


def themed(svg: str) -> str:
    """A drawing whose styles follow the theme of its page, or of the system where it stands alone.

    Colours of the light palette in styles become variables of common.css; what else is there stays.
    """
    names: dict[str, str] = {}
    for name, colour in palette().items():
        names.setdefault(colour, name)

    def variable(found: re.Match[str]) -> str:
        name = names.get(found[2].lower())
        return f"{found[1]}var(--{name}, {found[2]})" if name else found[0]

    text = re.sub(r"((?:fill|stroke): ?)(#[0-9a-fA-F]{6})", variable, svg)
    used = set(re.findall(r"var\(--([\w-]+)", text))
    values = ";".join(f"--{name}:{c}" for name, c in palette(dark=True).items() if name in used)
    # in a page it is not the root, and takes the colours from there
    style = f"<style>@media (prefers-color-scheme:dark){{svg:root{{{values}}}}}</style>"
    end = text.index(">", text.index("<svg")) + 1
    return text[:end] + style + text[end:]


def filled(template: str, parts: Mapping[str, str]) -> str:
    """`template` with each `{{name}}` replaced by that part, which goes in as it is."""
    # one pass, so that what is put in is never looked at again
    pieces = template.split("{{")
    out = [pieces[0]]
    for piece in pieces[1:]:
        name, rest = piece.split("}}", 1)
        out += [parts[name], rest]
    return "".join(out)


def table(
    head: Sequence[str], rows: Sequence[Sequence[Any]], *, words: Sequence[int] = (0,)
) -> str:
    """A table; cells are numbers, text, Html, or None, which is shown as a dash.

    words: the columns of text, to the left; those of numbers stand to the right.
    """

    def cell(tag: str, i: int, value: Any) -> str:
        return f"<{tag}{'' if i in words else ' class=n'}>{_shown(value)}</{tag}>"

    lines = ["".join(cell("th", i, text) for i, text in enumerate(head))]
    lines += ["".join(cell("td", i, value) for i, value in enumerate(row)) for row in rows]
    body = "\n".join(f"<tr>{line}</tr>" for line in lines)
    return f'<div class="scroll"><table>\n{body}\n</table></div>'


def figure(svg: Path, words: str) -> str:
    """The drawing in a file, as part of the page; nothing where there is no such file.

    words: what it shows, for those who do not see it. Where the drawing for narrow screens lies
    beside it, with NARROW behind the name, the width of the screen chooses.
    """
    if not svg.is_file():
        return ""
    narrow = svg.with_name(f"{svg.stem}{NARROW}.svg")
    if not narrow.is_file():
        return f"<figure>{_inline(svg, words)}</figure>"
    return (
        f'<figure><div class="wide">{_inline(svg, words)}</div>'
        f'<div class="narrow">{_inline(narrow, words)}</div></figure>'
    )


def _inline(svg: Path, words: str) -> str:
    text = svg.read_text(encoding="utf-8")
    text = text[text.index("<svg") :]
    # several drawings share the page: their names must not meet
    mark = svg.stem.replace(" ", "_")
    for old, new in (('id="', f'id="{mark}-'), ("url(#", f"url(#{mark}-"),
                     ('xlink:href="#', f'xlink:href="#{mark}-')):  # fmt: skip
        text = text.replace(old, new)
    label = f'<svg role="img" aria-label="{html.escape(words)}"'
    return text.replace("<svg", label, 1)


def embedded_json(value: Any) -> str:
    """`value` as JSON that cannot end the element which holds it."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def write_page(out: Path, text: str) -> Path:
    """Write `text` to `out`, whole or not at all; CurveboundError where that is impossible."""
    return write_whole(out, lambda path: path.write_text(text, encoding="utf-8", newline="\n"))


def _shown(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, Html):
        return value
    if isinstance(value, float):
        return plain(value)
    return html.escape(str(value))


def _digest(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return "sha256-" + base64.b64encode(digest).decode("ascii")
