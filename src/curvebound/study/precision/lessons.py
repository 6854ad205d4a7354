"""What the rows of a study say: the cheapest for an error, the Pareto front, laws in sentences."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from typing import Any

from ...numbers import plain, quantity
from ...units import labelled

__all__ = [
    "LEVELS",
    "cheapest",
    "crossings",
    "equals",
    "lessons",
    "name_of",
    "order_of",
    "pareto",
    "ratio_of_forms",
    "size_of",
    "spread_of",
    "usable",
]

Row = dict[str, Any]

#: errors for which the cheapest setting is named
LEVELS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
_ROUNDING = 1e-12  # error of doubles, relative to the size of the motion
_LOW, _HIGH = 1e-12, 3e-2  # errors between rounding and nonsense, where laws can be seen


def usable(rows: Iterable[Row], purpose: str = "micro", error: str = "error") -> list[Row]:
    """Rows that ran to the end with a finite error."""
    return [
        row
        for row in rows
        if row["purpose"] == purpose and not row["failure"] and math.isfinite(row[error])
    ]


def pareto(rows: Sequence[Row], error: str = "error") -> list[Row]:
    """Rows that no other row beats in both cost and error, from cheap to dear.

    A row must be clearly better than a cheaper one, by 10 %: timings are not surer than that. One
    whose error is as large as the motion tells nothing of it, whatever it costs.
    """
    front: list[Row] = []
    best = math.inf
    for row in sorted(filter(_tells, rows), key=lambda r: (r["cpu"], r[error])):
        if row[error] < 0.9 * best:
            front.append(row)
            best = row[error]
    return front


def _tells(row: Row) -> bool:
    """Whether each error is below that of a result that stays in the middle of the motion."""
    sizes = {path: row[path] for path in row if path.startswith("amplitude.")}
    pairs = [(row[path.replace("amplitude", "total.worst", 1)], sizes[path]) for path in sizes]
    # a study of before knew the largest motion only
    pairs = pairs or [(row["error"], row.get("amplitude") or 0.0)]
    return all(error < 0.5 * size for error, size in pairs if size > 0.0)


def cheapest(rows: Sequence[Row], bound: float, error: str = "error") -> Row | None:
    """The cheapest row with an error below the bound."""
    good = [row for row in rows if row[error] <= bound]
    return min(good, key=lambda row: row["cpu"], default=None)


def equals(rows: Sequence[Row], bound: float, error: str = "error") -> list[Row]:
    """Rows of other forms and methods that timing does not tell from the cheapest one.

    Those whose lowest cost is below the highest of the cheapest: the best one of each.
    """
    best = cheapest(rows, bound, error)
    if best is None:
        return []
    found: dict[tuple[str, str], Row] = {(best["form"], best["method"]): best}
    for row in sorted(rows, key=lambda r: float(r["cpu"])):
        if row[error] <= bound and row.get("cpu_low", row["cpu"]) <= best.get("cpu_high", 0.0):
            found.setdefault((row["form"], row["method"]), row)
    return [row for row in found.values() if row is not best]


def _family(rows: Sequence[Row], form: str, method: str) -> dict[float, Row]:
    """Rows by micro step or tolerance, that of the longest macro step where there are several."""
    found: dict[float, Row] = {}
    for row in sorted(usable(rows, error="numerical"), key=lambda r: float(r["macro_step"])):
        if row["form"] == form and row["method"] == method and row["size"]:
            found[float(f"{row['size']:.6g}")] = row
    return found


def order_of(rows: Sequence[Row], form: str, method: str) -> float | None:
    """Exponent of the numerical error in micro step or tolerance, by a log-log fit.

    Micro steps are taken from the longest on while the error falls: where more of them bring more
    rounding, there is no law.
    """
    points: list[tuple[float, float]] = []
    for size, row in sorted(_family(rows, form, method).items(), reverse=True):
        error = row["numerical"]
        if (
            points
            and row["size_is"] == "step"
            and (error <= _LOW or math.log(error) >= points[-1][1])
        ):
            break
        if not _LOW < error < _HIGH:
            continue
        points.append((math.log(size), math.log(error)))
    if len(points) < 3:
        return None
    return statistics.linear_regression([x for x, _ in points], [y for _, y in points]).slope


def ratio_of_forms(rows: Sequence[Row], form: str, other: str, method: str) -> float | None:
    """Error in `form` over that in `other` at the same micro steps: the median."""
    a, b = _family(rows, form, method), _family(rows, other, method)
    ratios = [
        a[size]["numerical"] / b[size]["numerical"]
        for size in a.keys() & b.keys()
        if all(_LOW < of[size]["numerical"] < _HIGH for of in (a, b))
    ]
    return statistics.median(ratios) if len(ratios) >= 2 else None


def crossings(rows: Sequence[Row]) -> list[tuple[float, Row | None]]:
    """The cheapest row for each of LEVELS, over all macro steps that were studied."""
    good = usable(rows)
    return [(level, cheapest(good, level)) for level in LEVELS]


def name_of(row: Row) -> str:
    """Form and method of a row."""
    return f"{row['form']} {row['method']}".strip()


def size_of(row: Row) -> str:
    """Micro step or tolerance of a row; empty where it has none."""
    if not row["size"]:
        return ""
    if row["size_is"] == "tolerance":
        return f"tolerance {plain(row['size'])}"
    return f"step {quantity(row['size'], 's')}"


def spread_of(row: Row) -> str:
    """CPU time per simulated s, with the range of the timings where there are several."""
    cost = quantity(row["cpu"], "s")
    if "cpu_low" not in row:
        return cost
    return f"{cost} ({quantity(row['cpu_low'], 's')} to {quantity(row['cpu_high'], 's')})"


def lessons(rows: Sequence[Row], unit: str = "1") -> list[str]:
    """Sentences on formulation, method, step and model; `unit` is that of the errors."""
    good = usable(rows, error="numerical")
    forms = list(dict.fromkeys(row["form"] for row in good))
    methods = list(dict.fromkeys(row["method"] for row in good))
    said: list[str] = []
    if not good:
        return said
    simpler = {row["form"]: row["modelling"] for row in good if row["modelling"] > 0.0}
    for form, error in simpler.items():
        said.append(
            f"The {form} model itself is off by {labelled(plain(error, 2), unit)}, however it is "
            "integrated: it meets no bound below that."
        )
    full = [form for form in forms if form not in simpler]
    for form in full[1:]:
        ratio = ratio_of_forms(rows, form, full[0], "rk4")
        if ratio is not None:
            more = f"{plain(ratio, 2)} times the error of"
            if ratio < 1.0:
                more = f"{plain(1.0 / ratio, 2)} times less error than"
            said.append(f"At the same step of rk4, {form} has {more} {full[0]}.")
    exact = [row for row in good if row["method"] == "exact"]
    if exact:
        worst = max(row["numerical"] for row in exact)
        steps = ", ".join(quantity(step, "s") for step in sorted({r["macro_step"] for r in exact}))
        said_worst = labelled(plain(worst, 1), unit)
        free = worst < _ROUNDING * max(1.0, *(row.get("amplitude") or 0.0 for row in exact))
        said.append(
            f"exact is free of numerical error, {said_worst} at macro steps of {steps}: rounding."
            if free
            else f"exact has an error of {said_worst} at macro steps of {steps}."
        )
    measured = []
    for method in methods:
        order = order_of(rows, full[0], method) if full else None
        if order is not None:
            what = " in its tolerance" if method == "adaptive" else ""
            measured.append(f"{method} order {order:.2f}{what}")
    if measured:
        said.append(f"Numerical error ({full[0] or 'measured'}): {', '.join(measured)}.")
    said += _dearest(rows)
    return said


def _dearest(rows: Sequence[Row]) -> list[str]:
    """From which accuracy on which method is the cheapest."""
    found = [(level, row) for level, row in crossings(rows) if row is not None]
    if not found:
        return []
    parts: list[str] = []
    last = ""
    for level, row in found:
        label = " or ".join([name_of(row), *map(name_of, equals(usable(rows), level))])
        if label != last:
            parts.append(f"{label} from {plain(level)} on")
            last = label
    unmet = [level for level, row in crossings(rows) if row is None]
    text = "The cheapest: " + "; ".join(parts) + "."
    if any(" or " in part for part in parts):
        text += " (What `or` joins, the timings do not tell apart.)"
    if unmet:
        text += f" No setting reaches {plain(max(unmet))}."
    return [text]
