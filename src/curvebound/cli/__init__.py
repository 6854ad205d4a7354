"""The command line: one module per command, imported only as far as the parser needs.

Exit status: 0 done, 1 the command failed and said why, 2 wrong usage (argparse), data that cannot
be read, or a system that is short of something.

examples:
  curvebound demo                                build the FMUs, run every scene, write build/
  curvebound list                                scenes, FMUs and their variables
  curvebound show inverted_balance               one scene, FMU or variable in full
  curvebound build BeadOnWire --out fmus/        one FMU for your own tool
  curvebound run bead_on_wire --set bead.wire.radius=2 --stop 20 --out bead.csv
"""

from __future__ import annotations

import argparse
import difflib
import importlib
import io
import os
import re
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from typing import NoReturn

from .. import __version__, output
from ..errors import CurveboundError, remedy_of, said

__all__ = ["main", "parser"]

#: modules of this package, in the order of `curvebound --help`
_COMMANDS = (
    "list",
    "show",
    "new",
    "build",
    "run",
    "check",
    "demo",
    "live",
    "replay",
    "ssp",
    "study",
    "tune",
    "sweep",
    "stability",
    "sample",
    "linearize",
)

_SHELLS = ("bash", "zsh", "tcsh")


class _Parser(argparse.ArgumentParser):
    """A parser that suggests the nearest of the words that it knows."""

    def error(self, message: str) -> NoReturn:
        wrong = re.search(r"invalid choice: '([^']*)' \(choose from (.*)\)", message)
        if wrong:
            known = re.findall(r"[\w-]+", wrong[2])
            close = difflib.get_close_matches(wrong[1], known, n=1)
            message += f"; did you mean {close[0]}?" if close else ""
        super().error(message)


class _Completion(argparse.Action):
    """Prints the script and ends the program."""

    def __call__(
        self, parser: argparse.ArgumentParser, _: object, shell: object, *__: object
    ) -> None:
        import shtab

        commands = next(a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
        for command in commands.choices.values():
            for action in command._actions:
                if action.metavar and re.search(r"FILE|\.fmu|DIR", str(action.metavar)):
                    action.complete = shtab.FILE
        print(shtab.complete(parser, str(shell)))
        parser.exit()


def parser(only: str | None = None, *, bare: bool = False) -> argparse.ArgumentParser:
    """The parser of the whole command line.

    only: with this command alone; bare: with the names of the commands, but not their arguments.
    Both are quicker.
    """
    root = _Parser(
        prog="curvebound",
        description="FMI 2.0 co-simulation FMUs of bodies bound to curves.",
        epilog=(__doc__ or "").partition("\n\n")[2].partition("\n\n")[2],
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    root.add_argument("-V", "--version", action="version", version=f"curvebound {__version__}")
    root.add_argument("--debug", action="store_true", help="show the traceback of an error as well")
    root.add_argument(
        "--print-completion", choices=_SHELLS, action=_Completion,
        help="print a completion script for a shell",
    )  # fmt: skip
    commands = root.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name in _COMMANDS if only is None else (only,):
        module = importlib.import_module(f".{name}", __name__)
        sub = commands.add_parser(
            module.NAME,
            help=module.HELP,
            description=module.__doc__,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        if bare:
            continue
        module.configure(sub)
        output.configure(sub, json=getattr(module, "AS_JSON", False))
        sub.add_argument(
            "--debug",
            action="store_true",
            default=argparse.SUPPRESS,
            help="show the traceback of an error as well",
        )
        sub.set_defaults(run=module.run)
    return root


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a name that the terminal cannot show is no error
            stream.reconfigure(errors="backslashreplace")
    words = sys.argv[1:] if arguments is None else arguments
    if not words:
        parser(bare=True).print_help()
        return 0
    command = next((word for word in words if not word.startswith("-")), "")
    if command in _COMMANDS:
        options = parser(command).parse_args(words)
    else:
        options = parser(bare="--print-completion" not in words).parse_args(words)
    try:
        with output.logging_to_stderr(options):
            status: int = options.run(options)
        sys.stdout.flush()
    except CurveboundError as error:
        return _report(str(error), options.debug, error.status)
    except KeyboardInterrupt as stop:  # a command that keeps something says so
        return _report(str(stop) or "stopped by the keyboard", options.debug)
    except BrokenPipeError:
        # The reader (head, a pager) has gone; there is nobody left to tell.
        sys.stderr.close()
        return 1
    except (OSError, MemoryError) as error:
        _drop_output()
        return _report(f"{said(error)}. {remedy_of(error)}".strip(), options.debug, 2)
    except Exception as error:
        _drop_output()
        text = f"{said(error)}. Nobody thought of this: --debug shows where it happened."
        return _report(text, options.debug, 2)
    return status


def _drop_output() -> None:
    """What standard output does not take now, on a full disk, it need not be given at the end."""
    try:
        sys.stdout.flush()
    except OSError:
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _report(message: str, debug: bool, status: int = 1) -> int:
    """Print an error as one paragraph, wrapped to the terminal; returns the exit status."""
    from rich.console import Console
    from rich.text import Text

    if debug:
        traceback.print_exc()
    console = Console(stderr=True, highlight=False)
    console.print(
        Text.assemble(("error: ", "bold red"), message), soft_wrap=not console.is_terminal
    )
    return status
