"""Algebraic loops, solved by iteration where a scene asks for it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from .exchange import Call

__all__ = ["LoopFailed", "LoopSolver"]

_MOST = 100  # iterations
_MEMORY = 5  # earlier iterates that the acceleration combines


class LoopFailed(Exception):
    """An algebraic loop whose iteration did not converge; the text names loop and residual."""


class LoopSolver:
    """Solves x = g(x) for the outputs x of a loop, g one evaluation of all its components.

    Fixed-point iteration with Anderson's acceleration (D. G. Anderson, J. ACM 12 (1965) 547;
    Walker and Ni, SIAM J. Numer. Anal. 49 (2011) 1715, problem LS), which for a linear loop of n
    outputs ends after about n + 1 evaluations whatever its gain. Converged when no output changes
    by more than `tolerance` times the larger of its size and its scale.
    """

    def __init__(
        self,
        places: Sequence[int],
        names: Sequence[str],
        scales: Sequence[float],
        values: NDArray[np.float64],
        evaluation: Sequence[Call],
        run: Callable[[Sequence[Call]], None],
        tolerance: float,
    ) -> None:
        self._places = np.array(places)
        self._names = list(names)
        self._scales = np.array(scales)
        self._values = values
        self._evaluation = list(evaluation)
        self._run = run
        self._tolerance = tolerance

    def __call__(self) -> None:
        x = self._values[self._places]
        differences: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        before: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
        residual = np.full_like(x, np.inf)
        for _ in range(_MOST):
            self._values[self._places] = x
            self._run(self._evaluation)
            g = self._values[self._places]
            residual = g - x
            if not np.all(np.isfinite(residual)):
                break
            size = np.maximum(np.abs(g), self._scales)
            if np.all(np.abs(residual) <= self._tolerance * size):
                return
            if before is not None:
                differences.append((residual - before[0], g - before[1]))
                del differences[:-_MEMORY]
            before = residual, g
            x = g
            if differences:
                changes = np.column_stack([d[0] / self._scales for d in differences])
                share = np.linalg.lstsq(changes, residual / self._scales, rcond=None)[0]
                x = g - np.column_stack([d[1] for d in differences]) @ share
        worst = int(np.argmax(np.abs(residual) / self._scales))
        raise LoopFailed(
            f"the algebraic loop over {', '.join(self._names)} did not converge in {_MOST} "
            f"evaluations: {self._names[worst]} still changes by {residual[worst]:.3g}; loosen "
            "loop_tolerance, or break the loop with a component that holds its output"
        )
