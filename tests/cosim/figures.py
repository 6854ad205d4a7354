"""Prints the figures of the masters: convergence, adaptive steps, jumps, size, extremes.

python tests/cosim/figures.py [convergence energy adaptive damping jump size amplification feedback]
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from pythonfmu import FmuBuilder

sys.path.insert(0, str(Path(__file__).parent))

import amplification as linear
import test_convergence as masses
import test_sampled_loop as loop
from scipy.integrate import solve_ivp

from curvebound.cosim import Adaptive, Scene, load_scene

ALGORITHMS = ("jacobi", "gauss_seidel", "strang")
W = 2.0 * math.pi
SCALES = {"one.x": 1.0, "two.x": 1.0, "one.v": W, "two.v": W}


def _mass() -> Path:
    source = Path(__file__).parent / "fmus" / "coupled_mass.py"
    folder = tempfile.mkdtemp()
    return Path(FmuBuilder.build_FMU(source, dest=folder, canGetAndSetFMUstate=True))


def two_masses(k, kc, x, v, stop_time, step, **settings):
    scene = Scene("two_masses", stop_time=stop_time, step=step, **settings)
    for i, name in enumerate(("one", "two")):
        scene.add(name, MASS, {"k": k[i], "kc": kc, "x_start": x[i], "v_start": v[i]})
    scene.connect("one.x", "two.other").connect("two.x", "one.other")
    return scene.record("one.x", "two.x", "one.v", "two.v")


def convergence() -> None:
    print("Two coupled masses, T = 1 s: largest error of a position at any communication point")
    steps = [1.0 / (25 * 2**i) for i in range(9)]
    print("  H          " + "".join(f"{name:>14s}" for name in ALGORITHMS))
    errors = {name: [] for name in ALGORITHMS}
    for step in steps:
        for name in ALGORITHMS:
            result = masses.symmetric(two_masses, step, algorithm=name).run()
            errors[name].append(masses.symmetric_error(result))
        print(f"  1/{round(1 / step):<6d}   " + "".join(f"{e[-1]:14.3e}" for e in errors.values()))
    slopes = [np.polyfit(np.log(steps[2:]), np.log(e[2:]), 1)[0] for e in errors.values()]
    print("  order      " + "".join(f"{s:14.3f}" for s in slopes))


def energy() -> None:
    print(
        "Springs 10, 100, 1000 N/m, H = 1 ms, T = 10 s: x(10 s) and energy (10000 J at the start)"
    )
    for name in ALGORITHMS:
        result = masses.stiff(two_masses, 1e-3, algorithm=name).run()
        e = masses.energy(result)
        x = f"{result['one.x'][-1]:12.6f} {result['two.x'][-1]:12.6f}"
        print(f"  {name:14s}{x}   energy {e.min():.6f} to {e.max():.6f}, at the end {e[-1]:.6f}")


def _table(make, error, fixed_steps, span, tolerances) -> None:
    """Fixed steps, then tolerances; the fixed step of equal error by interpolation."""
    fixed = []
    for step in fixed_steps:
        fixed.append((step, error(make(step, None).run())))
        print(f"  fixed H = {step:.3e}  {span / step:8.0f} steps   error {fixed[-1][1]:.3e}")
    log_h = np.log([h for h, _ in fixed])[::-1]
    log_e = np.log([e for _, e in fixed])[::-1]
    slope = (log_h[1] - log_h[0]) / (log_e[1] - log_e[0])
    errors = []
    for tolerance in tolerances:
        result = make(fixed_steps[0], tolerance).run()
        errors.append(error(result))
        e = math.log(errors[-1])
        h = log_h[0] + slope * (e - log_e[0]) if e < log_e[0] else np.interp(e, log_e, log_h)
        equal = span / math.exp(h)
        print(
            f"  tolerance {tolerance:7.1e}  {result.steps:8d} steps   error {errors[-1]:.3e}   "
            f"{result.trials} with trials; a fixed step of that error needs {equal:.0f}: "
            f"{equal / result.steps:.2f} ({equal / result.trials:.2f}) times as many"
        )
    exponent = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    print(f"  error ~ tolerance^{exponent:.2f}")


def adaptive() -> None:
    for name, tolerances in (
        ("gauss_seidel", [1.0, 0.3, 0.1, 0.03]),
        ("jacobi", [1.0, 0.3, 0.1, 0.03]),
        ("strang", [0.3, 0.1, 0.03, 0.01, 0.003]),
    ):
        print(f"Adaptive {name}, two equal masses (one time scale throughout)")

        def make(step, tolerance, name=name):
            chosen = None if tolerance is None else Adaptive(tolerance, SCALES)
            return masses.symmetric(two_masses, step, algorithm=name, adaptive=chosen)

        _table(make, masses.symmetric_error, [0.01, 0.005, 0.0025], 1.0, tolerances)


def damping() -> None:
    print("Adaptive gauss_seidel, active_damping against the continuous loop (motion dies away)")
    gain = loop.GAIN
    exact = solve_ivp(
        lambda _, y: loop.motion(y, -float(gain @ y)), (0.0, 20.0), loop.START,
        method="DOP853", rtol=1e-12, atol=1e-13, dense_output=True,
    ).sol  # fmt: skip

    def error(result):
        states = exact(result.time)
        return max(np.max(np.abs(result[n] - states[i])) for i, n in enumerate(loop.OUTPUTS))

    def make(step, tolerance):
        scene = load_scene("active_damping")
        scene.recorded.clear()
        scene.record(*loop.OUTPUTS)
        scene.set("plant.solver.method", "adaptive").set("plant.solver.tolerance", 1e-12)
        scene.step = step
        scene.adaptive = None if tolerance is None else Adaptive(tolerance)
        return scene

    _table(make, error, [0.01, 0.005, 0.0025], 20.0, [0.3, 0.1, 0.03, 0.01, 0.003, 0.001])


def jump() -> None:
    """A mass at rest, pushed by an input that jumps at 4.9 s; exact while the input is held."""

    def error(result):
        after = np.maximum(result.time - 4.9, 0.0)
        return float(np.max(np.abs(result["one.x"] - 0.5 * (1.0 - np.cos(math.sqrt(2) * after)))))

    for known in (True, False):
        print("An input that jumps at 4.9 s, " + ("a table" if known else "a function"))

        def make(step, tolerance, known=known):
            chosen = None if tolerance is None else Adaptive(tolerance, largest=0.5)
            scene = Scene("jump", stop_time=10.0, step=step, adaptive=chosen)
            scene.add("one", MASS, {"k": 1.0, "kc": 1.0})
            table = ([0.0, 4.9, 4.9], [0.0, 0.0, 1.0])
            scene.input("one.other", table if known else lambda t: float(t >= 4.9))
            return scene.record("one.x", "one.v")

        for step in (0.0303, 0.0103, 0.00303):
            result = make(step, None).run()
            print(f"  fixed H = {step:.3e}  {result.steps:8d} steps   error {error(result):.3e}")
        for tolerance in (0.1, 0.01, 0.001):
            result = make(0.01, tolerance).run()
            print(
                f"  tolerance {tolerance:7.1e}  {result.steps:8d} steps   "
                f"error {error(result):.3e}   {result.trials} with trials"
            )


def size() -> None:
    print("A ring of masses, gauss_seidel, two recorded outputs")
    for count in (10, 100, 1000):
        scene = Scene("ring", stop_time=0.1, step=1e-3)
        for i in range(count):
            scene.add(f"m{i}", MASS, {"x_start": float(i % 7)})
        for i in range(count):
            scene.connect(f"m{i}.x", f"m{(i + 1) % count}.other")
        scene.record("m0.x", "m1.x")
        began = time.perf_counter()
        with scene.prepare() as prepared:
            prepared.run(stop_time=1e-3)
            setup = time.perf_counter() - began
            cost = min(prepared.run().stepping for _ in range(5)) / 100
        print(
            f"  {count:5d} components: set-up {setup:6.2f} s, {cost * 1e6:10.1f} us per step, "
            f"{cost / count * 1e6:6.2f} us per component"
        )


def amplification() -> None:
    h, k = 0.1, (10.0, 1000.0)
    print(
        f"Two coupled masses, H = {h} s: growth per macro step, closed form / measured (400 steps)"
    )
    print("  coupling (N/m)" + "".join(f"{name:>24s}" for name in ALGORITHMS))
    for kc in (1.0, 100.0, 350.0, 2.5e3, 1e6):
        cells = []
        for name in ALGORITHMS:
            scene = two_masses(k, kc, (1.0, -0.3), (0.0, 0.0), 400 * h, h, algorithm=name)
            size = np.abs(scene.run()["one.x"])
            measured = (size[300:].max() / size[100:200].max()) ** (1.0 / 200.0)
            expected = linear.radius(linear.masses(name, k, kc, h))
            cells.append(f"{expected:14.5f} / {measured:.5f}")
        print(f"  {kc:14g}" + "".join(f"{cell:>24s}" for cell in cells))


def feedback() -> None:
    gain = loop.GAIN
    scene = load_scene("active_damping")
    scene.recorded.clear()
    scene.record(*loop.OUTPUTS)
    scene.set("plant.model.fidelity", "linear").set("plant.solver.method", "exact")
    scene.set("drive.limit.acceleration", 1e300)  # or the drive would end the growth
    with scene.prepare() as prepared:

        def grows(h: float) -> bool:
            result = prepared.run(stop_time=400.0 * h, step=h)
            size = np.max([np.abs(result[name]) for name in loop.OUTPUTS], axis=0)
            return bool(size[300:].max() > size[100:200].max())

        def end(test) -> float:
            low, high = 0.01, 2.0
            high = next(h for h in np.linspace(low, high, 100) if test(h))
            while high - low > 1e-5 * high:
                middle = 0.5 * (low + high)
                low, high = (low, middle) if test(middle) else (middle, high)
            return low

        theory = end(lambda h: linear.radius(linear.sampled(gain, h)) > 1.0)
        print(f"active_damping, linear: stable to a sample period of {theory:.4f} s (closed form), "
              f"{end(grows):.4f} s (measured)")  # fmt: skip


if __name__ == "__main__":
    MASS = _mass()
    every = ["convergence", "energy", "adaptive", "damping", "jump", "size"]
    chosen = sys.argv[1:] or [*every, "amplification", "feedback"]
    for one in chosen:
        globals()[one]()
