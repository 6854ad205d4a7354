"""What one macro step multiplies the state of a linear loop by, in closed form.

Two masses m x'' = -k x - kc (x - other), each integrated without error while the other's position
is held; z = (x1, v1, x2, v2). And the sampled feedback of the linear pendulum on its parabola.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import expm


def held(k: float, kc: float, h: float) -> tuple[np.ndarray, np.ndarray]:
    """(R, s): (x, v) -> R (x, v) + s other over h s, for m = 1."""
    omega = math.sqrt(k + kc)
    c, s, part = math.cos(omega * h), math.sin(omega * h), kc / (k + kc)
    return (
        np.array([[c, s / omega], [-omega * s, c]]),
        np.array([part * (1.0 - c), part * omega * s]),
    )


def _one(first: bool, k: float, kc: float, h: float) -> np.ndarray:
    """One of the two masses steps, the other rests."""
    r, s = held(k, kc, h)
    step = np.eye(4)
    own, other = (slice(0, 2), 2) if first else (slice(2, 4), 0)
    step[own, own] = r
    step[own, other] = s
    return step


def masses(algorithm: str, k: tuple[float, float], kc: float, h: float) -> np.ndarray:
    """The matrix of a macro step of h s, shape (4, 4)."""
    one, two = _one(True, k[0], kc, h), _one(False, k[1], kc, h)
    if algorithm == "jacobi":
        return one + two - np.eye(4)
    if algorithm == "gauss_seidel":
        return two @ one
    if algorithm == "midpoint":
        middle = masses("jacobi", k, kc, 0.5 * h)
        step = np.zeros((4, 4))
        for own, other, stiffness in ((slice(0, 2), 2, k[0]), (slice(2, 4), 0, k[1])):
            r, s = held(stiffness, kc, h)
            step[own, own] = r
            step[own] += np.outer(s, middle[other])
        return step
    half = _one(True, k[0], kc, 0.5 * h)
    return half @ two @ half


def radius(matrix: np.ndarray) -> float:
    """Amplification per step in the long run: the spectral radius."""
    return float(np.abs(np.linalg.eigvals(matrix)).max())


def jacobi_radius(k: float, kc: float, h: float) -> float:
    """Of two equal masses: the modes x1 = +-x2 have trace 2 c +- p (1 - c), determinant
    1 -+ p (1 - c), with c = cos(sqrt(k + kc) h), p = kc / (k + kc)."""
    c, p = math.cos(math.sqrt(k + kc) * h), kc / (k + kc)
    found = []
    for sign in (1.0, -1.0):
        half = c + 0.5 * sign * p * (1.0 - c)
        det = 1.0 - sign * p * (1.0 - c)
        inside = half * half - det
        found.append(math.sqrt(det) if inside < 0.0 else abs(half) + math.sqrt(inside))
    return max(found)


def sampled(gain: np.ndarray, h: float) -> np.ndarray:
    """Of the linear pendulum at its defaults, the acceleration -gain z of the parabola held over h.

    z = (u, u', angle, angle', X, X').
    """
    g, a, m1, m2, r = 9.81, 0.5, 1.0, 1.0, 1.0
    mass = m1 + m2
    matrix = np.zeros((7, 7))
    matrix[0, 1] = matrix[2, 3] = matrix[4, 5] = 1.0
    # (m1 + m2)(u'' + X'') + m2 r th'' = -(m1 + m2) 2 g a u,  u'' + X'' + r th'' = -g th
    solve = np.linalg.inv(np.array([[mass, m2 * r], [1.0, r]]))
    right = np.array([[-mass * 2.0 * g * a, 0.0, -mass], [0.0, -g, -1.0]])
    (u_u, u_th, u_x), (th_u, th_th, th_x) = solve @ right
    matrix[1, [0, 2, 6]] = u_u, u_th, u_x
    matrix[3, [0, 2, 6]] = th_u, th_th, th_x
    matrix[5, 6] = 1.0
    flow = expm(matrix * h)
    return flow[:6, :6] - np.outer(flow[:6, 6], gain)
