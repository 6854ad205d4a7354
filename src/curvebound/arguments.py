"""Words of the command line, of which not every one makes sense: wrong ones are wrong usage."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path

from .units import number

__all__ = ["file_of", "positive", "seconds", "setting", "whole"]


def positive(text: str) -> float:
    """A finite number above zero."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is no finite number above zero")
    return value


def seconds(text: str) -> float:
    """A time, also with a unit of its own."""
    try:
        return number(text, "s")
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def whole(least: int) -> Callable[[str], int]:
    """A whole number of `least` or more."""

    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = least - 1
        if value < least:
            raise argparse.ArgumentTypeError(f"{text!r} is no whole number of {least} or more")
        return value

    return parse


def file_of(*endings: str) -> Callable[[str], Path]:
    """A file whose name has one of the endings, as what is written into it is of that kind."""

    def parse(text: str) -> Path:
        path = Path(text)
        if path.suffix.lower() not in endings:
            raise argparse.ArgumentTypeError(f"{text!r} does not end in {' or '.join(endings)}")
        return path

    return parse


def setting(text: str) -> tuple[str, str]:
    """component.variable=value, as (path, value)."""
    path, equals, value = text.partition("=")
    if not equals or not path.strip():
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form component.variable=value")
    return path.strip(), value.strip()
