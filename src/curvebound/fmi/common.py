"""The variables that the plants have in common: gravity, solver and energy."""

from __future__ import annotations

from .declaration import (
    Enumeration,
    Variable,
    choice,
    count,
    count_parameter,
    output,
    parameter,
)

__all__ = ["ENERGY", "GRAVITY", "SOLVER"]

SOLVER_METHOD = Enumeration(
    "SolverMethod",
    "time integration method",
    (
        ("explicit_euler", "explicit Euler, order 1"),
        ("semi_implicit_euler", "semi-implicit (symplectic) Euler, order 1"),
        ("rk4", "classical Runge-Kutta, order 4"),
        ("adaptive", "Lobatto IIIA collocation of order 14 with step-size control"),
        ("implicit", "two-stage Gauss-Legendre, order 4, A-stable, symplectic, for stiff cases"),
        ("exact", "propagator of the linear fidelity, exact at any step"),
    ),
)

GRAVITY: tuple[Variable, ...] = (
    parameter("gravity.x", "m/s2", 0.0, "gravitational acceleration to the right", nominal=10.0),
    parameter("gravity.y", "m/s2", -9.81, "gravitational acceleration upward", nominal=10.0),
)

SOLVER: tuple[Variable, ...] = (
    choice("solver.method", SOLVER_METHOD, "rk4", "time integration method"),
    parameter(
        "solver.step",
        "s",
        1e-3,
        "largest internal step of the fixed-step methods; a communication step is divided evenly "
        "into the fewest internal steps that are not larger (above zero; adaptive follows "
        "solver.tolerance and exact takes each communication step whole)",
        above=0.0,
        nominal=1e-3,
    ),
    parameter(
        "solver.tolerance",
        "1",
        1e-6,
        "relative tolerance of adaptive (above zero); overridden by the tolerance of "
        "fmi2SetupExperiment when that is defined",
        above=0.0,
        nominal=1e-6,
    ),
    count_parameter(
        "solver.max_steps",
        1000000,
        "most internal steps, rejected ones included, in one communication step",
        at_least=1,
    ),
    count("solver.steps", "internal steps accepted since the start"),
    count("solver.evaluations", "evaluations of the equations of motion since the start"),
)

ENERGY: tuple[Variable, ...] = (
    output("energy.kinetic", "J", "kinetic energy", nominal=1.0),
    output("energy.potential", "J", "potential energy", nominal=1.0),
    output("energy.total", "J", "kinetic plus potential energy", nominal=1.0),
    output(
        "energy.residual",
        "J",
        "energy.total less its initial value and the net work done since: the integration error",
        nominal=1.0,
    ),
)
