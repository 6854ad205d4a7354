"""Functions of Python's `math` that compiled code takes from the C library.

Each gives the bits of Python's, which calls the same library, and raises what Python's raises where
a result is no number or not finite. Others of `math` are called as Python functions.
"""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["C_FUNCTIONS", "TO_WHOLE", "definitions"]

_LIBC = ("fabs", "isfinite", "copysign", "atan", "atan2", "tanh")

#: name -> (condition on argument x and result y at which Python raises, what it raises)
_CHECKED = {
    "sin": ("y != y and x == x", "ValueError"),
    "cos": ("y != y and x == x", "ValueError"),
    "tan": ("y != y and x == x", "ValueError"),
    "sqrt": ("y != y and x == x", "ValueError"),
    "exp": ("y == INFINITY and x != INFINITY", "OverflowError"),
    "cosh": ("y == INFINITY and fabs(x) != INFINITY", "OverflowError"),
    "sinh": ("fabs(y) == INFINITY and fabs(x) != INFINITY", "OverflowError"),
    "log": ("x <= 0.0", "ValueError"),
}

#: rounding to a whole number that is wanted as a float: float(math.floor(x))
TO_WHOLE = ("floor", "ceil")

_CONVERTED = """\
cdef inline long long checked_int(double x) except? -1:
    if not -9.2e18 < x < 9.2e18:
        raise OverflowError("cannot convert float to integer")
    return <long long>x
"""

#: function of `math` (or "int", "float floor") -> name in compiled code
C_FUNCTIONS = {
    **{name: name for name in _LIBC},
    **{name: f"checked_{name}" for name in (*_CHECKED, *TO_WHOLE, "int")},
}


def definitions(used: Iterable[str]) -> str:
    """Cython text that defines the names in `used`, those of C_FUNCTIONS."""
    libc = {"INFINITY", "NAN", "fabs"}
    text = ""
    for name in sorted(used):
        plain = name.removeprefix("checked_")
        if plain == "int":
            text += _CONVERTED
            continue
        libc.add(plain)
        if plain in TO_WHOLE:
            text += (
                f"cdef inline double {name}(double x) except? -3.3e-301:\n"
                "    if x != x:\n"
                '        raise ValueError("cannot convert float NaN to integer")\n'
                "    if x - x != 0.0:\n"
                '        raise OverflowError("cannot convert float infinity to integer")\n'
                # as an int has it, there is no negative zero
                f"    return {plain}(x) + 0.0\n"
            )
        elif plain in _CHECKED:
            condition, error = _CHECKED[plain]
            text += (
                f"cdef inline double {name}(double x) except? -3.3e-301:\n"
                f"    cdef double y = {plain}(x)\n"
                f"    if {condition}:\n"
                f'        raise {error}("math domain error")\n'
                "    return y\n"
            )
    return f"from libc.math cimport {', '.join(sorted(libc))}\n{text}"
