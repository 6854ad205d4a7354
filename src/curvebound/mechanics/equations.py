"""The equations as a Python module, for any kind of numbers: extended, of many digits, arrays.

Each function takes F, the functions and constants of the numbers, and s, the values of symbols by
name: those of the FMU's variables (coordinates, rates, shapes and their rates at the present time,
parameters, inputs), field.x, field.y (gravity less the frame's acceleration), frame.x, .y, .vx,
.vy and frame.ax, .ay. They return lists, `outputs` functions dictionaries by name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy
from sympy import Expr, Symbol

from .derivation import Derivation
from .linear import Linear
from .source import Lines, Printer, identifier

__all__ = ["equations_source"]


class _Numbers(Printer):
    """Numbers that are exact in any arithmetic."""

    def integer(self, n: int) -> str:
        return str(n)

    def ratio(self, p: int, q: int) -> str:
        return f"F.ratio({p}, {q})"


def equations_source(derivation: Derivation) -> str:
    """The module's text."""
    d = derivation
    q, v = d.q, d.v
    parts = [_TEXT]
    numerators, denominator = d.accelerations
    parts += _solved("accelerations", numerators, denominator, d.shared)
    parts += _jacobian("jacobian", numerators, denominator, [*q, *v], d)
    relative = sympy.Add(*(r.mass * d.velocity(r) ** 2 / 2 for r in d.raw))
    parts += _function("momenta", [relative.diff(x) for x in v])
    parts += _canonical(d, relative)
    parts += _turning(d)
    parts += _function("fed", d.fed)
    parts += _function("held", d.reactions.held, d.shared)
    parts += _outputs("places", _places(d))
    energies = {"kinetic": d.kinetic, "potential": sympy.Add(*d.potential_terms)}
    parts += _outputs("energies", {f"energy.{k}": e for k, e in energies.items()})
    parts += _outputs("reactions", _reactions(d), d.shared)
    if d.mechanics.linear_about is not None:
        linear = Linear(d)
        numerators, denominator = linear.accelerations
        parts += _solved("linear_accelerations", numerators, denominator)
        parts += _jacobian("linear_jacobian", numerators, denominator, [*q, *v], d)
        parts += _linear_canonical(linear, d)
        energies = {"kinetic": linear.kinetic, "potential": sympy.Add(*linear.potential_terms)}
        parts += _outputs("linear_energies", {f"energy.{k}": e for k, e in energies.items()})
        parts += _function("linear_fed", [linear.power, sympy.Integer(0)])
        parts += _function("linear_weights", linear.weights)
        parts += _newton(d)
    return "\n".join(parts)


_TEXT = '''"""Equations derived from a mechanics.py; do not edit."""
'''


def _begin(name: str, expressions: Sequence[Expr], extra: Mapping[Symbol, Expr]) -> list[str]:
    used = {s for e in expressions for s in sympy.sympify(e).free_symbols}
    for symbol, e in reversed(list(extra.items())):
        if symbol in used:
            used = (used - {symbol}) | e.free_symbols
    lines = ["", f"def {name}(F, s):"]
    lines += [f'    {identifier(n)} = s["{n}"]' for n in sorted(s.name for s in used)]
    return lines


def _names(expressions: Sequence[Expr], extra: Mapping[Symbol, Expr]) -> dict[Symbol, str]:
    everything = [*expressions, *extra.values()]
    used = {s for e in everything for s in sympy.sympify(e).free_symbols} | extra.keys()
    return {s: identifier(s.name) for s in used}


def _body(
    pairs: Sequence[tuple[str, Expr]], shared: Mapping[Symbol, Expr] | None = None
) -> list[str]:
    extra = shared or {}
    printer = _Numbers(_names([e for _, e in pairs], extra), "F.")
    return Lines(printer, extra).of(pairs, "    ")


def _function(
    name: str, expressions: Sequence[Expr], shared: Mapping[Symbol, Expr] | None = None
) -> list[str]:
    lines = _begin(name, expressions, shared or {})
    lines += _body([(f"y{i}", e) for i, e in enumerate(expressions)], shared)
    return [*lines, f"    return [{', '.join(f'y{i}' for i in range(len(expressions)))}]", ""]


def _outputs(
    name: str, expressions: Mapping[str, Expr], shared: Mapping[Symbol, Expr] | None = None
) -> list[str]:
    lines = _begin(name, list(expressions.values()), shared or {})
    lines += _body([(f"y{i}", e) for i, e in enumerate(expressions.values())], shared)
    items = ", ".join(f'"{n}": y{i}' for i, n in enumerate(expressions))
    return [*lines, f"    return {{{items}}}", ""]


def _solved(
    name: str,
    numerators: Sequence[Expr],
    denominator: Expr,
    shared: Mapping[Symbol, Expr] | None = None,
) -> list[str]:
    lines = _begin(name, [*numerators, denominator], shared or {})
    pairs = [("d", denominator), *((f"n{i}", e) for i, e in enumerate(numerators))]
    lines += _body(pairs, shared)
    return [*lines, f"    return [{', '.join(f'n{i} / d' for i in range(len(numerators)))}]", ""]


def _jacobian(
    name: str,
    numerators: Sequence[Expr],
    denominator: Expr,
    by: Sequence[Symbol],
    d: Derivation,
) -> list[str]:
    """Rows of d(acceleration)/d(by): n = a d, so n' - a d' over d."""
    a = [Symbol(f"a{i}", real=True) for i in range(len(numerators))]
    pairs = [("d", denominator), *((f"n{i}", e) for i, e in enumerate(numerators))]
    lines = _begin(name, [e for _, e in pairs], d.shared)
    lines += _body(pairs, d.shared)
    lines += [f"    a{i} = n{i} / d" for i in range(len(a))]
    slopes = [
        (f"y{i}_{k}", d.along(n, x) - a[i] * d.along(denominator, x))
        for i, n in enumerate(numerators)
        for k, x in enumerate(by)
    ]
    lines += _body(slopes, d.shared)
    rows = ("[" + ", ".join(f"y{i}_{k} / d" for k in range(len(by))) + "]" for i in range(len(a)))
    return [*lines, f"    return [{', '.join(rows)}]", ""]


def _canonical(d: Derivation, relative: Expr) -> list[str]:
    """Hamilton's equations: q' from q and p (symbols momentum.0, .1), p' from q and q'."""
    p = [Symbol(f"momentum.{i}", real=True) for i in range(len(d.q))]
    still = dict.fromkeys(d.v, sympy.Integer(0))
    over = [e - relative.diff(v).subs(still) for e, v in zip(p, d.v, strict=True)]
    determinant = d.determinant.expression().subs(d.shared)
    rates = _from_momenta(d, over, relative, determinant)
    lagrangian = relative + sympy.Add(*(r.mass * r.field * r.position for r in d.raw))
    lagrangian -= d.potential
    forces = []
    for k, c in enumerate(d.q):
        applied = sympy.Add(*((r.external + r.drag) * r.slopes[k] for r in d.raw))
        forces.append(lagrangian.diff(c) + applied + d.couples[k] + d.resisting[k])
    return _hamilton("", rates, forces)


def _linear_canonical(linear: Linear, d: Derivation) -> list[str]:
    """The same for the quadratic part of the Lagrangian."""
    p = [Symbol(f"momentum.{i}", real=True) for i in range(len(d.q))]
    relative = linear.second(sympy.Add(*(r.mass * d.velocity(r) ** 2 / 2 for r in d.raw)))
    still = dict.fromkeys(d.v, sympy.Integer(0))
    over = [e - relative.diff(v).subs(still) for e, v in zip(p, d.v, strict=True)]
    quadratic = relative
    determinant = linear.determinant.expression()
    rates = _from_momenta(d, over, quadratic, determinant)
    lagrangian = linear.second(
        relative + sympy.Add(*(r.mass * r.field * r.position for r in d.raw)) - d.potential
    )
    forces = []
    for k, c in enumerate(d.q):
        applied = sympy.Add(*((r.external + r.drag) * r.slopes[k] for r in d.raw))
        others = linear.first(applied + d.couples[k] + d.resisting[k])
        forces.append(lagrangian.diff(c) + others)
    momenta = _function("linear_momenta", [quadratic.diff(v) for v in d.v])
    return momenta + _hamilton("linear_", rates, forces)


def _from_momenta(d: Derivation, over: list[Expr], relative: Expr, determinant: Expr) -> list[Expr]:
    """q' from momenta less what they are at q' = 0."""
    m = [[relative.diff(a, b) for b in d.v] for a in d.v]
    if len(over) == 1:
        return [over[0] / m[0][0]]
    return [
        (m[1][1] * over[0] - m[0][1] * over[1]) / determinant,
        (m[0][0] * over[1] - m[0][1] * over[0]) / determinant,
    ]


def _hamilton(prefix: str, rates: list[Expr], forces: list[Expr]) -> list[str]:
    return _function(f"{prefix}velocities", rates) + _function(f"{prefix}pushes", forces)


def _newton(d: Derivation) -> list[str]:
    """Reactions in exact geometry of a motion with accelerations acceleration.0, .1."""
    a = [Symbol(f"acceleration.{i}", real=True) for i in range(len(d.q))]
    forces = {}
    for r in d.raw:
        moved = sympy.Add(*(j * x for j, x in zip(r.slopes, a, strict=True)))
        forces[r.of.reaction[r.axis]] = r.mass * (moved + r.left - r.field) - r.external
    found: dict[str, Expr] = {}
    if d.mechanics.frame:
        for axis, n in enumerate("xy"):
            total = sympy.Add(*(forces[m.reaction[axis]] for m in d.mechanics.masses))
            found[f"{d.mechanics.frame}.f{n}"] = -total
    for name, e in d.mechanics.observed.items():
        found[name] = sympy.sympify(e).subs(forces)
    return _outputs("linear_reactions", found)


def _turning(d: Derivation) -> list[str]:
    """Squares of the rates at which the motion turns the slopes, and scales of the coordinates.

    turning: |J_k'|^2 and |J_k|^2 of each mass and coordinate. scales: |J_k|^2 and |dJ_k/dq_k|^2,
    whose ratio is the square of a natural size of the coordinate.
    """
    turning: list[Expr] = []
    scales: list[Expr] = []
    for k, c in enumerate(d.q):
        for m in d.mechanics.masses:
            rows = [r for r in d.raw if r.of == m]
            along = [
                sympy.Add(*(r.slopes[k].diff(x) * v for x, v in zip(d.q, d.v, strict=True)))
                for r in rows
            ]
            turning.append(sympy.Add(*(a**2 for a in along)))
            turning.append(sympy.Add(*(r.slopes[k] ** 2 for r in rows)))
        scales.append(sympy.Add(*(r.slopes[k] ** 2 for r in d.raw)))
        scales.append(sympy.Add(*(r.slopes[k].diff(c) ** 2 for r in d.raw)))
    return _function("turning", turning) + _function("scales", scales)


def _places(d: Derivation) -> dict[str, Expr]:
    """World positions and velocities of the masses."""
    found = {}
    for r in d.raw:
        axis = "xy"[r.axis]
        found[f"{r.of.name}.{axis}"] = d.place[r.axis] + r.position
        found[f"{r.of.name}.v{axis}"] = d.motion[r.axis] + d.velocity(r)
    return found


def _reactions(d: Derivation) -> dict[str, Expr]:
    """Forces on the frame, and what the statement observes."""
    found: dict[str, Expr] = {}
    if d.mechanics.frame:
        found = {f"{d.mechanics.frame}.f{a}": -d.reactions.held[i] for i, a in enumerate("xy")}
    for name, e in d.mechanics.observed.items():
        found[name] = d.reactions.observed(sympy.sympify(e))
    constraint = d.constraint
    if constraint is not None:
        found["constraint.multiplier"] = constraint.multiplier
        found["constraint.force"] = constraint.force
        found["constraint.drift"] = sympy.Integer(0)
    return found
