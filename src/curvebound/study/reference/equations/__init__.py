"""The systems of a scene once more, in extended precision: what the FMUs' results are judged by."""

from .base import Array, Equations, Inputs, Number, System, Witness
from .carried import stated_in, system_of

__all__ = ["Array", "Equations", "Inputs", "Number", "System", "Witness", "stated_in", "system_of"]
