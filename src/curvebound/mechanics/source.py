"""Expressions as lines of plain Python: powers as products, common parts once, no sympy in them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

import sympy
from sympy import Expr, Symbol

__all__ = ["Lines", "Printer", "identifier"]


def identifier(name: str) -> str:
    """A variable's name as a Python identifier."""
    return name.replace(".", "_")


class Printer:
    """Writes an expression in which every symbol has a name here.

    names: symbol -> Python expression. numbers are floats, functions those of module `functions`.
    """

    #: of sympy -> of Python's math
    FUNCTIONS: ClassVar[dict[str, str]] = {
        "sin": "sin", "cos": "cos", "tan": "tan", "exp": "exp", "log": "log", "Abs": "fabs",
        "asin": "asin", "acos": "acos", "atan": "atan", "atan2": "atan2",
        "sinh": "sinh", "cosh": "cosh", "tanh": "tanh",
    }  # fmt: skip

    def __init__(self, names: Mapping[Symbol, str], functions: str = "math.") -> None:
        self.names = names
        self.functions = functions

    def __call__(self, expression: Expr) -> str:
        return self.add(sympy.sympify(expression))

    def integer(self, n: int) -> str:
        """A whole number."""
        return f"{float(n)!r}"

    def ratio(self, p: int, q: int) -> str:
        """A fraction."""
        if q & (q - 1) == 0:
            return repr(p / q)
        return f"({float(p)!r} / {float(q)!r})"

    def number(self, x: Expr) -> str:
        """Any number."""
        if x.is_Integer:
            return self.integer(int(x))
        if x.is_Rational:
            return self.ratio(int(x.p), int(x.q))
        if x is sympy.pi:
            return self.pi()
        return repr(float(x))

    def pi(self) -> str:
        """The number pi."""
        return f"{self.functions}pi"

    def add(self, x: Expr) -> str:
        """A sum, or what is none."""
        if not x.is_Add:
            return self.mul(x)
        text = ""
        for term in sorted(x.args, key=lambda t: (t.could_extract_minus_sign(), str(t))):
            negative = term.could_extract_minus_sign()
            part = self.mul(-term if negative else term)
            if text:
                text += f" - {part}" if negative else f" + {part}"
            else:
                text = f"-{part}" if negative else part
        return text

    def mul(self, x: Expr) -> str:
        """A product, or what is none."""
        if not x.is_Mul:
            return self.power(x)
        if x.could_extract_minus_sign() and not (-x).is_Add:
            return f"-{self.factors(-x)}"
        return self.factors(x)

    def factors(self, x: Expr) -> str:
        """A product without a sign."""
        if not x.is_Mul:
            return self.power(x)
        above, below = [], []
        for factor in x.args:
            base, exponent = factor.as_base_exp()
            if factor.is_Rational and not factor.is_Integer and factor.p == 1:
                if factor.q & (factor.q - 1) == 0:
                    above.append(self.number(factor))
                else:
                    below.append(self.integer(int(factor.q)))
            elif exponent.is_number and exponent.is_negative:
                below.append(self.power(base**-exponent))
            else:
                above.append(self.power(factor))
        top = " * ".join(above) or self.integer(1)
        if not below:
            return top
        return f"{top} / {below[0]}" if len(below) == 1 else f"{top} / ({' * '.join(below)})"

    def power(self, x: Expr) -> str:
        """A power, or what is none."""
        if not x.is_Pow:
            return self.atom(x)
        base, exponent = x.args
        if exponent.is_Float:
            exponent = sympy.nsimplify(exponent)
        if exponent.is_negative:
            return f"({self.integer(1)} / {self.power(base**-exponent)})"
        if exponent.is_Integer:
            return f"({' * '.join([self.atom(base)] * int(exponent))})"
        if exponent.is_Rational and exponent.q == 2:
            root = f"{self.functions}sqrt({self.add(base)})"
            whole = int(exponent.p) // 2
            return f"({' * '.join([self.atom(base)] * whole + [root])})" if whole else root
        raise ValueError(f"{x} has no plain form: use whole powers, square roots, exp and log")

    def atom(self, x: Expr) -> str:
        """A symbol, a number, a function, or anything in parentheses."""
        if x.is_Symbol:
            return self.names[x]
        if x.is_number and not x.args:
            text = self.number(x)
            return f"({text})" if text.startswith("-") else text
        if x.is_Function:
            if isinstance(x, sympy.sign):  # the slope of a size; of no size it is 1
                return f"{self.functions}copysign({self.integer(1)}, {self.add(x.args[0])})"
            name = self.FUNCTIONS.get(type(x).__name__)
            if name is None:
                raise ValueError(f"{x} has no plain form: {type(x).__name__} is not known here")
            return f"{self.functions}{name}({', '.join(self.add(a) for a in x.args)})"
        return f"({self.add(x)})"


class Lines:
    """Statements that compute expressions, common parts first.

    shared: abbreviations in the order of their definition, which expressions may contain.
    """

    def __init__(self, printer: Printer, shared: Mapping[Symbol, Expr] | None = None) -> None:
        self.printer = printer
        self.shared = dict(shared or {})

    def of(self, wanted: Iterable[tuple[str, Expr]], indent: str = "        ") -> list[str]:
        """Lines `target = expression` for pairs of target and expression, in their order."""
        pairs = [(target, sympy.sympify(e)) for target, e in wanted]
        needed = self._needed([e for _, e in pairs])
        names = dict(self.printer.names)
        calls = self._calls([*needed.values(), *(e for _, e in pairs)], names)
        everything = [*needed.values(), *(e for _, e in pairs)]
        everything = [_signed(e.xreplace(calls)) for e in everything]
        parts, rest = sympy.cse(everything, symbols=sympy.numbered_symbols("x"), order="none")
        definitions: list[tuple[Symbol, Expr]] = [(s, call) for call, s in calls.items()]
        definitions += [(s, e) for s, e in zip(needed, rest, strict=False)]
        definitions += parts
        for s, _ in definitions:
            names[s] = identifier(s.name)
        finals = list(zip((t for t, _ in pairs), rest[len(needed) :], strict=True))
        printer = type(self.printer)(names, self.printer.functions)
        lines = []
        for s, e in _hoisted(_ordered(definitions, [e for _, e in finals])):
            names.setdefault(s, identifier(s.name))
            lines.append(f"{indent}{names[s]} = {printer(e)}")
        for target, e in finals:
            before, e = _without_powers(e, target)
            for s, part in before:
                names[s] = identifier(s.name)
                lines.append(f"{indent}{names[s]} = {printer(part)}")
            lines.append(f"{indent}{target} = {printer(e)}")
        return lines

    def _needed(self, expressions: list[Expr]) -> dict[Symbol, Expr]:
        used = {s for e in expressions for s in e.free_symbols}
        found: dict[Symbol, Expr] = {}
        for symbol, e in reversed(list(self.shared.items())):
            if symbol in used:
                found[symbol] = e
                used |= e.free_symbols
        return dict(reversed(list(found.items())))

    @staticmethod
    def _calls(expressions: list[Expr], names: Mapping[Symbol, str]) -> dict[Expr, Symbol]:
        """Sines and cosines of symbols, by short names."""
        taken = set(names.values())
        found: dict[Expr, Symbol] = {}
        calls = {f for e in expressions for f in e.atoms(sympy.sin, sympy.cos)}
        for call in sorted(calls, key=str):
            (of,) = call.args
            if of.is_Symbol:
                name = f"{type(call).__name__}_{names[of].rpartition('.')[2]}"
                if name not in taken:
                    found[call] = Symbol(name, real=True)
        return found


def _signed(e: Expr) -> Expr:
    """The same, each sum in a product or power with the sign that it has elsewhere too."""
    if not e.args:
        return e
    args = [_signed(a) for a in e.args]
    if e.is_Mul:
        flipped = [-a if a.is_Add and a.could_extract_minus_sign() else a for a in args]
        if sum(a is not b for a, b in zip(args, flipped, strict=True)) % 2:
            flipped.insert(0, sympy.Integer(-1))
        return sympy.Mul(*flipped) if sum(a.is_Number for a in flipped) < 2 else e.func(*args)
    if e.is_Pow and args[0].is_Add and args[1].is_even and args[0].could_extract_minus_sign():
        args[0] = -args[0]
    return e.func(*args)


def _ordered(
    definitions: list[tuple[Symbol, Expr]], finals: list[Expr]
) -> list[tuple[Symbol, Expr]]:
    """The definitions that are used, each before its use."""
    of = dict(definitions)
    done: dict[Symbol, Expr] = {}

    def visit(e: Expr) -> None:
        for s in sorted(e.free_symbols & of.keys(), key=str):
            if s not in done:
                visit(of[s])
                done[s] = of[s]

    for e in finals:
        visit(e)
    return list(done.items())


def _hoisted(definitions: list[tuple[Symbol, Expr]]) -> list[tuple[Symbol, Expr]]:
    found = []
    for s, e in definitions:
        before, rest = _without_powers(e, s.name)
        found += [*before, (s, rest)]
    return found


def _without_powers(e: Expr, target: str) -> tuple[list[tuple[Symbol, Expr]], Expr]:
    """The bases of powers that are no symbols, as definitions of their own, and the rest."""
    before: list[tuple[Symbol, Expr]] = []
    stem = identifier(target.rpartition(".")[2].partition("[")[0])

    def walk(x: Expr) -> Expr:
        if not x.args:
            return x
        args = [walk(a) for a in x.args]
        if x.is_Pow and args[1].is_Integer and abs(args[1]) > 1 and not args[0].is_Symbol:
            symbol = Symbol(f"{stem}_part{len(before)}", real=True)
            before.append((symbol, args[0]))
            args[0] = symbol
        return x.func(*args)

    return before, walk(e)
