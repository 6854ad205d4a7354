"""Lines of a kernel's methods: locals from fields, common parts once, constants as fields."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence

import sympy
from sympy import Expr, Symbol

from .derivation import Derivation
from .names import Names
from .source import Lines, Printer

__all__ = ["ACCELERATIONS", "FREE", "INVERSE", "PUSH", "Writer", "folded", "symbols_in"]

INVERSE = Symbol("inverse", real=True)
ACCELERATIONS = (Symbol("a0", real=True), Symbol("a1", real=True))
#: accelerations without a constraint, and C'' with them
FREE = (Symbol("free0", real=True), Symbol("free1", real=True))
PUSH = Symbol("push", real=True)
_WIDTH = 100


class Writer:
    """Writes expressions of a derivation as lines of a method of a model."""

    #: of the names of constants
    prefix = "k"

    def __init__(self, derivation: Derivation, names: Names) -> None:
        self.own_names: dict[Symbol, str] = {}
        self.d = derivation
        self.m = derivation.mechanics
        self.names = names
        self.shapes = self.m.shapes
        self.coordinates = list(zip(derivation.q, ("q0", "q1"), strict=False))
        self.rates = list(zip(derivation.v, ("v0", "v1"), strict=False))
        self.state = [*derivation.q, *derivation.v]
        #: products and sums of constants, computed once per communication step
        self.constants: dict[Expr, Symbol] = {}
        #: symbols of the frame, and of state: by the field that holds them
        self._fields: dict[Symbol, str] = dict(self.coordinates + self.rates)
        for symbols, names_of in (
            (derivation.gravity, ("gx", "gy")),
            (derivation.place, ("x", "y")),
            (derivation.motion, ("vx", "vy")),
            (derivation.field, ("ex", "ey")),
            (derivation.push, ("ax", "ay")),
        ):
            self._fields |= dict(zip(symbols, names_of, strict=True))
        #: symbols that are locals of the methods by their own name
        self.plain_locals = {INVERSE, PUSH, *FREE, *ACCELERATIONS}

    def field(self, s: Symbol) -> str:
        """The field that holds a symbol."""
        return self._fields.get(s) or self.local(s)

    def local(self, s: Symbol) -> str:
        """The local name of a symbol."""
        if s in self.own_names:
            return self.own_names[s]
        if s in self.plain_locals or s in self.constants.values():
            return str(s.name)
        if s in (*self.d.place, *self.d.motion, *self.d.push):
            return f"frame_{self._fields[s]}"
        if s in (*self.d.gravity, *self.d.field):
            return self._fields[s]
        return self.names[s]

    def body(
        self,
        pairs: Sequence[tuple[str, Expr]],
        known: Iterable[Symbol] = (),
        *,
        indent: str = "        ",
        hoist: Iterable[Symbol] = (),
        moving: bool = False,
    ) -> list[str]:
        """Lines that compute pairs of target and expression from the fields.

        known: symbols that are locals already. hoist: symbols that are constant over a
        communication step: their products and sums become fields. moving: whether frame and shapes
        are those of t s after the communication point.
        """
        constants = set(hoist)
        expressions = [self._hoisted(sympy.sympify(e), constants) for _, e in pairs]
        shared = {s: self._hoisted(e, constants) for s, e in self.d.shared.items()}
        used = symbols_in(expressions, shared)
        fetched = used - set(known)
        lines: list[str] = []
        if moving:
            lines, done = self._moved(fetched, indent)
            fetched -= done
        for s in sorted(fetched, key=self.local):
            lines.append(f"{indent}{self.local(s)} = self.{self.field(s)}")
        names = {s: self.local(s) for s in used}
        names |= {s: s.name.replace(".", "_") for s in shared}
        writer = Lines(Printer(names), shared)
        targets = [t for t, _ in pairs]
        text = writer.of(zip(targets, expressions, strict=True), indent)
        if targets[-1] == "return":
            text[-1] = text[-1].replace("return = ", "return ")
        return lines + text

    def _moved(self, used: set[Symbol], indent: str) -> tuple[list[str], set[Symbol]]:
        """Lines for what has moved t s after the communication point, and the symbols they give."""
        lines: list[str] = []
        done: set[Symbol] = set()
        for s in self.shapes:
            if used & {s, s.rate, s.acceleration}:
                a = self.names[s]
                lines += [
                    f"{a}_acceleration = self.{a}_acceleration",
                    f"{a}_rate = self.{a}_rate + t * {a}_acceleration",
                    f"{a} = self.{a} + 0.5 * t * (self.{a}_rate + {a}_rate)",
                ]
                done |= {s, s.rate, s.acceleration}
        for axis in (0, 1):
            n = "xy"[axis]
            if self.d.place[axis] in used:
                lines.append(f"frame_{n} = self.{n} + t * (self.v{n} + 0.5 * t * self.a{n})")
            if self.d.motion[axis] in used:
                lines.append(f"frame_v{n} = self.v{n} + t * self.a{n}")
            done |= {self.d.place[axis], self.d.motion[axis]}
        return [indent + line for line in lines], done

    def _hoisted(self, e: Expr, constants: set[Symbol]) -> Expr:
        if not e.args or not constants:
            return e
        if e.free_symbols and e.free_symbols <= constants:
            return self._constant(e)
        if not (e.is_Mul or e.is_Add):
            return e.func(*(self._hoisted(a, constants) for a in e.args))
        fixed = [a for a in e.args if a.free_symbols and a.free_symbols <= constants]
        numbers = [a for a in e.args if not a.free_symbols]
        rest = [a for a in e.args if not a.free_symbols <= constants]
        rest = [self._hoisted(a, constants) for a in rest]
        if not fixed:
            return e.func(*numbers, *rest)
        return e.func(self._constant(e.func(*fixed, *numbers)), *rest)

    def _constant(self, e: Expr) -> Expr:
        if e.is_Symbol or (-e).is_Symbol:
            return e
        if e.could_extract_minus_sign():
            return -self._constant(-e)
        if e not in self.constants:
            self.constants[e] = Symbol(f"{self.prefix}{len(self.constants)}", real=True)
        return self.constants[e]


def symbols_in(expressions: Iterable[Expr], shared: Mapping[Symbol, Expr]) -> set[Symbol]:
    """The symbols that are read where the expressions are computed; shared: common parts."""
    used: set[Symbol] = {s for e in expressions for s in e.free_symbols}
    for symbol, e in reversed(list(shared.items())):
        if symbol in used:
            used = (used - {symbol}) | e.free_symbols
    return used


def folded(lines: Iterable[str]) -> list[str]:
    """Lines within the usual width: longer expressions are put in parentheses."""
    found = []
    for line in lines:
        indent = line[: len(line) - len(line.lstrip())]
        equals = " = " if " = " in line else " "
        if line.lstrip().startswith("return "):
            equals = "return "
        target, _, value = line.partition(equals)
        is_def = line.lstrip().startswith("def ")
        if len(line) <= _WIDTH or (equals == " " and not is_def) or "{" in value:
            found.append(line)
            continue
        if is_def:
            head, _, rest = line.partition("(")
            arguments, _, tail = rest.partition(")")
            found += [f"{head}(", f"{indent}    {arguments}", f"{indent}){tail}"]
            continue
        deep = indent + "    "
        found.append(f"{target}{equals}(" if equals != " = " else f"{target} = (")
        found += textwrap.wrap(
            value, _WIDTH, initial_indent=deep, subsequent_indent=deep,
            break_long_words=False, break_on_hyphens=False,
        )  # fmt: skip
        found.append(f"{indent})")
    return found
