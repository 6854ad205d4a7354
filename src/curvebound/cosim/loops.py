"""Algebraic loops, solved by iteration where a scene asks for it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from .exchange import Call

__all__ = ["LoopFailed", "LoopSolver"]

_MOST = 100  # iterations
_NEWTON = 20  # of Newton's method
_MEMORY = 5  # earlier iterates that the acceleration combines
_SHIFT = 1e-4  # relative change of an output for differences, large as loops can be noisy
_SINGULAR = 1e-9  # of a loop without solution: distance of its gain from 1
_NOISE = 1e4  # a residual up to this many tolerances that stays is noise
_HOLD = "break the loop with a component that holds its output"
_SINGULAR_ADVICE = (
    "the gain around it is 1, so that no values of its outputs fulfil it, or any do; "
    f"change a gain, or {_HOLD}"
)


class LoopFailed(Exception):
    """An algebraic loop whose iteration did not converge; the text names loop and residual."""


class LoopSolver:
    """Solves x = g(x) for the outputs x of a loop, g one evaluation of all its components.

    Newton's method where dg/dx is known: two evaluations where g is affine. Otherwise, and where
    that does not converge, fixed-point iteration with Anderson's acceleration (D. G. Anderson, J.
    ACM 12 (1965) 547; Walker and Ni, SIAM J. Numer. Anal. 49 (2011) 1715, problem LS), which for a
    linear loop of n outputs ends after about n + 1 evaluations whatever its gain. Converged when no
    output is off by more than `tolerance` times the larger of its size and its scale: what an
    output still changes, times what the loop makes of it, 1 / (1 - gain).

    changes: gives dg/dx at the last evaluation, shape (n, n).
    evaluations: of the last solution, the first one's check for singularity apart.
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
        changes: Callable[[], NDArray[np.float64]] | None = None,
    ) -> None:
        self._places = np.array(places)
        self._names = list(names)
        self._scales = np.array(scales)
        self._values = values
        self._evaluation = list(evaluation)
        self._run = run
        self._tolerance = tolerance
        self._changes = changes
        self.evaluations = 0
        self._amplification = 0.0  # of a residual to an error; 0: not known yet

    def begin(self) -> None:
        """Forget what is known of the loop: before a run."""
        self._amplification = 0.0

    def __call__(self) -> None:
        x = self._values[self._places]
        if self._amplification == 0.0:
            self._check(x)
        self.evaluations = 0
        if self._changes is None or not self._newton(x, self._changes):
            self._accelerated(x)

    def _newton(self, x: NDArray[np.float64], changes: Callable[[], NDArray[np.float64]]) -> bool:
        """Solve by Newton's method; False where that does not converge."""
        unit = np.eye(len(x))
        residual = self._change(x)
        for _ in range(_NEWTON):
            if not np.all(np.isfinite(residual)):
                return False
            if not np.any(residual):
                return True
            try:
                inverse = np.linalg.inv(unit - changes())
            except np.linalg.LinAlgError:
                return False
            step = inverse @ residual
            size = np.maximum(np.abs(x + step), self._scales)
            if not np.max(np.abs(step) / size) * _SINGULAR < np.max(np.abs(residual) / size):
                return False
            x = x + step
            residual = self._change(x)
            if np.all(np.abs(inverse @ residual) <= self._tolerance * size):
                return True
        return False

    def _accelerated(self, x: NDArray[np.float64]) -> None:
        """Solve by Anderson's method, or say why that is impossible."""
        differences: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        before: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
        residual = np.full_like(x, np.inf)
        count = 0
        while count < _MOST:
            count += 1
            residual = self._change(x)
            if not np.any(residual):
                return
            if not np.all(np.isfinite(residual)):
                break
            g = x + residual
            size = np.maximum(np.abs(g), self._scales)
            if before is not None:
                differences.append((residual - before[0], g - before[1]))
                del differences[:-_MEMORY]
            before = residual, g
            following = g
            if differences:
                changes = np.column_stack([d[0] / self._scales for d in differences])
                share = np.linalg.lstsq(changes, residual / self._scales, rcond=None)[0]
                following = g - np.column_stack([d[1] for d in differences]) @ share
                step = float(np.max(np.abs(following - x) / size))
                self._amplification = max(1.0, step / float(np.max(np.abs(residual) / size)))
                if not self._amplification < 1.0 / _SINGULAR:
                    break
            if np.all(np.abs(residual) * self._amplification <= self._tolerance * size):
                return
            x = following
        raise LoopFailed(
            f"the algebraic loop over {', '.join(self._names)} did not converge in {count} "
            f"evaluations: {self._remaining(residual)}; {self._advice(x)}"
        )

    def _check(self, x: NDArray[np.float64]) -> None:
        """Before the first solution: whether there is one, and how errors grow around the loop."""
        distance = self._distance(x)
        if distance is not None and distance <= _SINGULAR:
            names = ", ".join(self._names)
            raise LoopFailed(f"the algebraic loop over {names} is singular: {_SINGULAR_ADVICE}")
        self._values[self._places] = x
        self._amplification = 1.0 if distance is None else max(1.0, 1.0 / distance)

    def _remaining(self, residual: NDArray[np.float64]) -> str:
        worst = int(np.argmax(np.nan_to_num(np.abs(residual) / self._scales, nan=np.inf)))
        return f"{self._names[worst]} still changes by {residual[worst]:.3g}"

    def _advice(self, x: NDArray[np.float64]) -> str:
        """What to do about a loop that did not converge at x."""
        distance = self._distance(x)
        if distance is None:
            return f"its outputs do not stay finite: reduce the gain around it, or {_HOLD}"
        if distance <= _SINGULAR:
            return _SINGULAR_ADVICE
        reached = np.max(np.abs(self._change(x)) / np.maximum(np.abs(x), self._scales))
        if reached <= _NOISE * self._tolerance:
            return f"its outputs are noisy: raise loop_tolerance to {10.0 * reached:.0e}"
        return f"no values were found that fulfil it: reduce the gain around it, or {_HOLD}"

    def _distance(self, x: NDArray[np.float64]) -> float | None:
        """Of the eigenvalues of dg/dx at x from 1, the smallest; relative to the largest above 1.

        None where they are not finite.
        """
        if not np.all(np.isfinite(x)):
            return None
        jacobian = self._jacobian(x)
        if not np.all(np.isfinite(jacobian)):
            return None
        gains = np.linalg.eigvals(jacobian)
        return float(np.min(np.abs(1.0 - gains)) / max(1.0, float(np.max(np.abs(gains)))))

    def _jacobian(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """dg/dx at x."""
        if self._changes is not None:
            self._change(x)
            return self._changes()
        jacobian = np.eye(len(x))
        for j in range(len(x)):
            shift = np.zeros(len(x))
            shift[j] = _SHIFT * max(abs(x[j]), self._scales[j])
            change = self._change(x + shift) - self._change(x - shift)
            jacobian[:, j] += change / (2.0 * shift[j])
        return jacobian

    def _change(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """g(x) - x."""
        self._values[self._places] = x
        self._run(self._evaluation)
        self.evaluations += 1
        return np.asarray(self._values[self._places] - x)
