"""What a command's help calls its default is its default."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator

from curvebound.cli import parser


def told() -> Iterator[tuple[str, str, object]]:
    """Command and option, the plain word or number that the help gives, the default."""
    (commands,) = (a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    for name, command in commands.choices.items():
        for action in command._actions:
            found = re.search(r"default: ([\w.+/-]+)\)?$", action.help or "")
            if found and action.default is not None:
                yield f"{name} {action.option_strings}", found[1].rstrip("/"), action.default


def test_defaults_are_those_of_the_help() -> None:
    found = list(told())
    assert len(found) > 25
    for where, word, default in found:
        same = float(word) == default if isinstance(default, int | float) else word == str(default)
        assert same, (where, word, default)
