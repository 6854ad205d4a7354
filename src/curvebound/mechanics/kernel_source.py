"""The source of a kernel module: plain typed Python, to be compiled like one by hand."""

from __future__ import annotations

from .derivation import Derivation
from .kernel_class import DerivedClass
from .kernel_constrained import ConstrainedClass
from .kernel_linear import LinearClass
from .kernel_writer import folded
from .names import Names

__all__ = ["kernel_source"]

_HEAD = '''"""{title}, derived from its mechanics.py; written by curvebound, not by hand."""

from __future__ import annotations

import math
from typing import ClassVar

from curvebound.kernel.angles import TURN, TURN_REST, nearest_whole, reduce_angle, unwind
from curvebound.kernel.base import Values
from curvebound.kernel.frame import THIRD, FramedModel

__all__ = [{public}]
'''


def kernel_source(derivation: Derivation, names: Names) -> str:
    """The module's text: the models, and a factory `model(choices)` that picks one of them."""
    mechanics = derivation.mechanics
    classes = [DerivedClass(derivation, names)]
    picks = []
    if mechanics.constraint is not None:
        classes.append(ConstrainedClass(derivation, names))
        picks += ['    if choices["model.formulation"] == 1:', "        return Constrained()"]
    if mechanics.linear_about is not None:
        classes.append(LinearClass(derivation, names))
        picks += ['    if choices["model.fidelity"] == 1:', "        return Linear()"]
    public = ", ".join(f'"{n}"' for n in sorted([*(c.name for c in classes), "model"]))
    text = [_HEAD.format(title=names.title, public=public)]
    for one in classes:
        text += ["", *folded(one.lines()), ""]
    text += ["", "def model(choices: dict[str, int]) -> Derived:"]
    text += ['    """The model that the choices name."""', *picks, "    return Derived()", ""]
    return "\n".join(text)
