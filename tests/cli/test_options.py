"""Every option of every command: its kind, its default and which words it takes."""

from __future__ import annotations

import argparse
from pathlib import Path

from curvebound.cli import parser

#: words that options with a type of their own take or refuse
WORDS = ("-1", "0", "1", "2", "63", "64", "0.5", "inf", "x", "2 min", "a.b=0", "a.b=1", "b=1", "=1",
         "a.csv", "a.json", "a.parquet", "a.npz", "a.png", "a.gif", "a.mp4")  # fmt: skip

COMMON = """
--quiet StoreTrue False
--log-level Store 'info' of debug info warning error
"""
JSON = "--json StoreTrue False"
SCENE = """
--set Append [] takes a.b=0 a.b=1 b=1
--stop Store None takes -1 0 1 2 63 64 0.5 inf 2_min
--step Store None takes -1 0 1 2 63 64 0.5 inf 2_min
--algorithm Store None of gauss_seidel jacobi strang midpoint
--hold Store None of zero first
--adaptive Store None takes -1 0 1 2 63 64 0.5 inf
--variant Store None
"""
MOVIES = """
--picture Store None takes a.png
--arrows Store ''
--gif Store None takes a.gif
--mp4 Store None takes a.mp4
--frames Store None
--seconds Store 10.0 takes 1 2 63 64 0.5
--fps Store 25 takes 1 2 63 64
--size Store 420 takes 64
--transparent StoreTrue False
"""
OPTIONS = {
    "list": f"""
name* Store None
{COMMON}
{JSON}
""",
    "show": f"""
name Store None
{COMMON}
{JSON}
""",
    "new": f"""
folder Store None
--dof Store 1 of 1 2
{COMMON}
""",
    "build": f"""
name* Store None
--out Store build
--for Store None
--cross-check Store None
--no-compile StoreTrue False
--with-python StoreTrue False
{COMMON}
{JSON}
""",
    "run": f"""
scene Store None
--variants StoreTrue False
--out Store None takes a.csv a.json a.parquet a.npz
--units StoreTrue False
--replay? Store None takes
{SCENE}
{MOVIES}
{COMMON}
{JSON}
""",
    "check": f"""
target+ Store None
--max Append [] takes a.b=1 b=1
--tolerance Store 1e-06 takes 1 2 63 64 0.5
--reference Store None
--inputs Store None
--set Append [] takes a.b=0 a.b=1 b=1
--stop Store None takes -1 0 1 2 63 64 0.5 inf 2_min
--step Store None takes -1 0 1 2 63 64 0.5 inf 2_min
--timeout Store 600.0 takes -1 0 1 2 63 64 0.5 inf 2_min
--junit Store None
{COMMON}
{JSON}
""",
    "demo": f"""
--out Store build
--no-compile StoreTrue False
{COMMON}
{JSON}
""",
    "live": f"""
scene Store None
--out Store build
--open StoreTrue False
{SCENE}
{COMMON}
""",
    "replay": f"""
results+ Store None
--out Store None takes
--title Store None
--system Append []
--open StoreTrue False
{MOVIES}
{COMMON}
""",
    "ssp": f"""
scene Store None
--out Store None takes
{SCENE}
{COMMON}
""",
    "study": f"""
scenes+ Store None
--out Store build/study
--quick StoreTrue False
--output Append None
--limit Store 2.0 takes 1 2 63 64 0.5
--no-plots StoreTrue False
--restart StoreTrue False
{COMMON}
{JSON}
""",
    "tune": f"""
scenes+ Store None
--error Append [] takes 1 2 63 64 0.5 a.b=1 b=1
--budget Store None takes 1 2 63 64 0.5
--frame-rate Store None takes 1 2 63 64 0.5
--keep Append [] takes a.b=0 a.b=1 b=1
--continuous StoreTrue False
--limit Store 5.0 takes 1 2 63 64 0.5
--write StoreTrue False
{COMMON}
{JSON}
""",
    "sweep": f"""
scene Store None
--vary Append []
--latin Store 0 takes 1 2 63 64
--seed Store 0 takes 0 1 2 63 64
--metric Append []
--set Append [] takes a.b=0 a.b=1 b=1
--variant Store None
--out Store None
--workers Store None takes 1 2 63 64
--scheduler Store None
--restart StoreTrue False
--map StoreTrue False
{COMMON}
{JSON}
""",
    "stability": f"""
scene Store None
--vary Append None
--method Append None of explicit_euler semi_implicit_euler rk4 adaptive implicit exact
--steps Store None
--stop Store None takes 1 2 63 64 0.5
--accuracy Store 0.001 takes 1 2 63 64 0.5
--set Append [] takes a.b=0 a.b=1 b=1
--jobs Store 1 takes 1 2 63 64
--out Store build/stability
--no-plots StoreTrue False
{COMMON}
{JSON}
""",
    "sample": f"""
systems* Store None
--points Store 200 takes 1 2 63 64
--seed Store 1 takes -1 0 1 2 63 64
--method Store 'adaptive' of explicit_euler semi_implicit_euler rk4 adaptive implicit exact
--tolerance Store 1e-08 takes 1 2 63 64 0.5
--times Store 10.0 takes 1 2 63 64 0.5
--jobs Store 1 takes 1 2 63 64
--out Store build/stability
{COMMON}
{JSON}
""",
    "linearize": f"""
system Store None
--set Append [] takes a.b=0 a.b=1 b=1
--input Append None
--output Append None
--equilibrium StoreTrue False
--out Store None takes a.json a.npz
{COMMON}
{JSON}
""",
}


def described(action: argparse.Action) -> str:
    """An option in one line."""
    name = " ".join(action.option_strings) or action.dest
    kind = type(action).__name__.strip("_").removesuffix("Action")
    default = str(action.default) if isinstance(action.default, Path) else repr(action.default)
    text = f"{name}{action.nargs if action.nargs in ('*', '+', '?') else ''} {kind} {default}"
    if action.choices:
        return f"{text} of {' '.join(map(str, action.choices))}"
    if action.type in (None, Path, str):
        return text
    taken = []
    for word in WORDS:
        try:
            action.type(word)  # type: ignore[operator]
            taken.append(word.replace(" ", "_"))
        except (argparse.ArgumentTypeError, ValueError):
            pass
    return " ".join([text, "takes", *taken])


def test_every_option() -> None:
    (commands,) = (a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    found = {
        name: {
            described(action)
            for action in command._actions
            if not isinstance(action, argparse._HelpAction) and action.dest != "debug"
        }
        for name, command in commands.choices.items()
    }
    assert found == {name: {*filter(None, text.splitlines())} for name, text in OPTIONS.items()}
