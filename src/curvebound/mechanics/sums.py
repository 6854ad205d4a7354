"""Short sums in which no ratio of masses cancels.

A numerator of the accelerations is a polynomial in the masses (and forces). Terms of one monomial
are summed and made shorter by sin^2 + cos^2 = 1; those of different monomials are left apart: they
may be of any ratio, and rounding of one must not reach the other.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

import sympy
from sympy import Expr, Integer, Symbol

__all__ = ["ONE", "ZERO", "Sum", "over", "shorter"]

ONE = Integer(1)
ZERO = Integer(0)

#: monomial of masses, and what the term is of
Key = tuple[Expr, str]
#: operations beyond which an expression is not factored: that takes long and gains little
_LARGE = 60


@lru_cache(maxsize=1024)  # of one system a third are asked for again
def shorter(expression: Expr) -> Expr:
    """The shortest of a few forms of an expression of trigonometric polynomials."""
    expression = sympy.sympify(expression)
    best, least = expression, sympy.count_ops(expression)
    if least == 0:
        return best
    plain = sympy.expand(expression)
    for angle in _angles(plain):
        plain = _without_squares(plain, angle)
    for form in (lambda x: x, sympy.factor_terms, sympy.factor):
        if form is sympy.factor and sympy.count_ops(plain) > _LARGE:
            continue
        candidate = form(plain)
        count = sympy.count_ops(candidate)
        if count < least:
            best, least = candidate, count
    return best


def _angles(expression: Expr) -> list[Expr]:
    return sorted({f.args[0] for f in expression.atoms(sympy.sin, sympy.cos)}, key=str)


def _without_squares(expression: Expr, angle: Expr) -> Expr:
    """The expanded expression with sin(angle)^2 written as 1 - cos(angle)^2."""
    s, c = Symbol("_s"), Symbol("_c")
    plain = expression.subs({sympy.sin(angle): s, sympy.cos(angle): c})
    if not plain.is_polynomial(s, c):  # a quotient or a root of them
        return expression
    polynomial = sympy.Poly(plain, s)
    total = sympy.Add(
        *(of * s ** (n % 2) * (1 - c**2) ** (n // 2) for (n,), of in polynomial.as_dict().items())
    )
    return sympy.expand(total).subs({s: sympy.sin(angle), c: sympy.cos(angle)})


class Sum:
    """Terms by (monomial of masses, what they are of): those of one key are summed and shortened.

    The value is the sum of monomial times term over all keys.
    """

    def __init__(self, terms: Iterable[tuple[Key, Expr]] = ()) -> None:
        self.of: dict[Key, Expr] = {}
        for key, term in terms:
            self.add(*key, term)

    def add(self, monomial: Expr, what: str, term: Expr) -> None:
        """Add monomial * term."""
        if term != 0:
            before = self.of.get((monomial, what), sympy.Integer(0))
            self.of[monomial, what] = before + term

    def times(self, factor: Expr) -> Sum:
        """The product with a factor that holds no mass."""
        return Sum((key, factor * term) for key, term in self.of.items())

    def plus(self, other: Sum) -> Sum:
        """The sum with another one."""
        return Sum([*self.of.items(), *other.of.items()])

    def short(self) -> Sum:
        """The same with each of its sums in its shortest form."""
        return Sum((key, shorter(term)) for key, term in self.of.items())

    def expression(self) -> Expr:
        """As one expression."""
        return sympy.Add(*(monomial * term for (monomial, _), term in self.of.items()))


def over(numerators: list[Sum], denominator: Sum) -> tuple[list[Expr], Expr]:
    """Numerators and denominator as expressions, divided by what all terms of the latter share."""
    common = _content(denominator.expression())
    return [_divided(n, common) for n in numerators], _divided(denominator, common)


def _divided(of: Sum, common: Expr) -> Expr:
    return sympy.Add(*(t / common for t in sympy.Add.make_args(of.expression())))


def _content(expression: Expr) -> Expr:
    """The largest monomial of symbols that divides each term as it is written."""
    common: Expr | None = None
    for term in sympy.Add.make_args(expression):
        powers = {b: e for b, e in term.as_powers_dict().items() if b.is_Symbol and e.is_Integer}
        here = sympy.Mul(*(b**e for b, e in powers.items() if e > 0))
        common = here if common is None else sympy.gcd(common, here)
    return common if common is not None else sympy.Integer(1)
