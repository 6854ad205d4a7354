"""From measured figures to the blocks of the README and the documentation that state them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from curvebound.kernel.methods import METHODS
from curvebound.numbers import plain, quantity

__all__ = ["BLOCKS", "DOCUMENTS", "block", "blocks_in", "put"]

Data = dict[str, Any]
ROOT = Path(__file__).parents[2]
DOCUMENTS = (
    ROOT / "README.md",
    ROOT / "tests/benchmarks/README.md",
    *sorted((ROOT / "fmus").glob("*/documentation.html")),
)

#: on lines of its own, or within one
_BLOCK = re.compile(r"(<!-- measured: (\w+) -->\n?)(.*?)(<!-- end -->)", re.DOTALL)


def _demo(data: Data) -> str:
    fmu = data["fmu"]
    lines = [
        f"build/BeadOnWire.fmu: {fmu['how']}, {fmu['kB']} kB, {fmu['seconds']:.1f} s",
        "scene             simulated    wall  steps  |residual|    |drift|",
    ]
    for name, one in data["scenes"].items():
        drift = "" if one["drift"] is None else quantity(one["drift"], "m", 2)
        lines.append(
            f"{name:17} {one['simulated']:>7g} s {one['wall']:>5.2f} s {one['steps']:>6d}  "
            f"{quantity(one['residual'], 'J', 2):>10}  {drift:>9}".rstrip()
        )
    return "```text\n" + "\n".join(lines) + "\n```\n"


def _errors(data: Data) -> str:
    found = {name: plain(value, 2) for name, value in data.items()}
    form = "| bead | rk4, 1 ms, `lagrange_multiplier` with"
    return (
        "| system | setting | error |\n| --- | --- | --- |\n"
        f"| bead | rk4, 1 ms, `angle` | {found['angle']} |\n"
        f"{form} `projection` | {found['projection']} |\n"
        f"{form} `none` | {found['none']}, and growing |\n"
        f"| pendulum, nonlinear | rk4, 1 ms | {found['nonlinear']} |\n"
        "| pendulum, linear | `exact`, communication steps of 0.01, 1 or 10 s |"
        f" {found['exact']} |\n"
    )


def _models(data: Data) -> str:
    times = {name: f"{plain(value, 2)} times" for name, value in data.items()}
    return (
        f"- **Formulation:** at the same step of `rk4`, `projection` has {times['projection']} the "
        f"error of\n  `angle`, `baumgarte` {times['baumgarte']}, and `none` {times['none']}, which "
        "grows with the square of time.\n"
        f"- **Fidelity:** from u = angle = 0.5 the linear model is off by {data['linear']:.1g} (m, "
        "rad) within 10 s,\n  however exactly it is solved. Where it is enough, `exact` is free of "
        "numerical error at any\n  communication step.\n"
    )


def _cost(data: Data) -> str:
    """The targets, those alike but for the system in one line."""
    lines: dict[tuple[str, str], list[str]] = {}
    for target in data["times"]:
        name, _, system = target["name"].partition(": ")
        aim = f"{'at least' if target['at_least'] else 'at most'} {target['limit']:g}"
        measured = "-" if target["measured"] is None else f"{target['measured']:.3g}"
        lines.setdefault((name, aim), []).append(f"{system} {measured}".strip())
    rows = "".join(f"| {name} | {'; '.join(of)} | {aim} |\n" for (name, aim), of in lines.items())
    return "| what | measured | aim |\n| --- | --- | --- |\n" + rows


def _costs(system: str) -> Callable[[Data], str]:
    """The table of what an error costs each method, in microseconds per simulated second."""

    def render(data: Data) -> str:
        levels = "".join(f'<th class="n">1e-{power}' for power in (4, 6, 8, 10, 12))
        head = f'<div class="scroll"><table><tr><th>method{levels}</tr>\n'
        table = data["costs"][system]
        rows = [
            f"<tr><td>{method}"
            + "".join(
                '<td class="n">' + ("&ndash;" if x is None else plain(x)) for x in table[method]
            )
            + "</tr>\n"
            for method in METHODS
            if any(x is not None for x in table.get(method, ()))
        ]
        return f"{head}{''.join(rows)}</table></div>\n"

    return render


def _forms(data: Data) -> str:
    times = {name: plain(value, 2) for name, value in data.items()}
    return (
        f"At the same step of rk4\nprojection has {times['projection']} times the error of the "
        f"angle, baumgarte {times['baumgarte']} times and no stabilisation {times['none']} times.\n"
    )


def _fidelity(data: Data) -> str:
    return (
        f"From u = angle = 0.5 the linear\nmodel is off by {data['linear']:.1g} (m, rad) within "
        "10 s, however exactly it is solved.\n"
    )


def _exact(data: Data) -> str:
    return (
        "<p>linear: exact has no error at any communication step "
        f"({plain(data['exact'], 2)} after 10 s).</p>\n"
    )


def _points(data: Data) -> str:
    """Of each system the points of all seeds in one phrase, within a line."""
    phrases = []
    for system in dict.fromkeys(sample["system"] for sample in data["samples"]):
        of = [sample for sample in data["samples"] if sample["system"] == system]
        verdicts: Counter[str] = Counter()
        for sample in of:
            verdicts.update(sample["verdicts"])
        counts = ", ".join(f"{n} {verdict}" for verdict, n in verdicts.most_common())
        seeds = " and ".join(str(sample["seed"]) for sample in of)
        worst = plain(max(sample["worst"]["error"] for sample in of), 2)
        most = max(sample["most"]["evaluations"] for sample in of)
        phrases.append(
            f"`{system}`, {data['points']} of seed {seeds} each: {counts}; largest error {worst}, "
            f"at most {_thousands(most)} evaluations"
        )
    return ". ".join(phrases)


def _motions(data: Data) -> str:
    """Both plants, with and without hints, in one phrase, within a line."""
    verdicts: Counter[str] = Counter()
    for one in data["campaigns"]:
        verdicts.update(one["verdicts"])

    def number(verdict: str) -> str:
        return str(verdicts[verdict] or "none")

    runs = sum(verdicts.values())
    warned = sum(one["warned"] for one in data["campaigns"])
    needless = sum(one["needless"] for one in data["campaigns"])
    most = max(one["most"]["steps"] for one in data["campaigns"])
    return (
        f"of {runs} runs ({data['points']} motions per plant) {number('wrong')} wrong by more than "
        f"ten times tolerance times conditioning without a warning, {number('doubtful')} with a "
        f"warning at a conditioning below 100, {number('failed')} failed that the series takes in "
        f"1000 steps; {warned} warned, {needless} of them needlessly (conditioning below 100, "
        f"error below 1 % of that bound); at most {_thousands(most)} steps"
    )


def _thousands(n: int) -> str:
    return f"{n:,}".replace(",", " ")


#: the group that a block is made of, and how
BLOCKS: dict[str, tuple[str, Callable[[Data], str]]] = {
    "demo": ("demo", _demo),
    "errors": ("errors", _errors),
    "models": ("models", _models),
    "cost": ("cost", _cost),
    "costs_angle": ("cost", _costs("bead, angle")),
    "costs_cartesian": ("cost", _costs("bead, Cartesian")),
    "costs_pendulum": ("cost", _costs("pendulum")),
    "forms": ("models", _forms),
    "fidelity": ("models", _fidelity),
    "exact": ("errors", _exact),
    "random_points": ("points", _points),
    "random_motions": ("motions", _motions),
}


def block(name: str, entries: Data) -> str | None:
    """The text between the marks of a block; None where its group is not measured."""
    group, render = BLOCKS[name]
    entry = entries.get(group)
    if entry is None:
        return None
    text = render(entry["figures"])
    if name == group:  # in a README
        text += (
            f"\n<sub>{entry['date']}, {entry['machine']}: `python tests/measured {name}`</sub>\n"
        )
    return text


def blocks_in(text: str) -> dict[str, str]:
    """What stands between marks, by block."""
    return {found[2]: found[3] for found in _BLOCK.finditer(text)}


def put(text: str, entries: Data) -> str:
    """`text` with every measured block as its figures say."""

    def written(found: re.Match[str]) -> str:
        new = block(found[2], entries)
        return found[0] if new is None else found[1] + new + found[4]

    return _BLOCK.sub(written, text)
