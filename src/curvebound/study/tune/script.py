"""Putting a choice into a scene's script."""

from __future__ import annotations

import ast
import io
import tokenize
from collections.abc import Sequence
from pathlib import Path

from ...cosim.fmu import Value
from ...cosim.scene import Scene
from ...errors import CurveboundError
from ...files import sole_writer, write_whole
from ..settings import Setting, Space

__all__ = ["choice_block", "put_choice", "script_of"]

_BEGIN = "# chosen by `curvebound tune`"
_END = "# end of the choice"


def script_of(which: str) -> Path:
    """The script of a scene given as a file or by name; CurveboundError where there is none."""
    from ...places import scenarios_directory

    path = Path(which)
    if path.suffix == ".ssp":
        raise CurveboundError(
            f"A choice can be written into a scene's Python script only, not into {path}; "
            "use the values that are shown."
        )
    if path.suffix != ".py":
        path = scenarios_directory() / f"{which}.py"
    if not path.is_file():
        raise CurveboundError(f"There is no scene file {path}.")
    return path


def choice_block(scene: Scene, space: Space, setting: Setting, remarks: Sequence[str]) -> str:
    """Statements that set what was chosen, with remarks as comments."""
    values: dict[str, Value] = {
        path: value
        for path, value in space.start(setting).items()
        if not path.endswith(".solver.max_steps") or _many_steps(setting)
    }
    own: dict[str, Value] = {"step": setting.step}
    if len(scene.components) > 1:
        own["algorithm"] = setting.algorithm
    if setting.hold != "zero" or scene.hold != "zero":
        own["hold"] = setting.hold
    if scene.tolerance is not None and setting.by_tolerance and setting.size is not None:
        own["tolerance"] = setting.size  # the scene's would override the FMUs' own
    lines = [f"{_BEGIN}: {remarks[0]}" if remarks else _BEGIN]
    lines += [f"# {remark}" for remark in remarks[1:]]
    lines += [f"scene.set({_quoted(path)}, {_literal(value)})" for path, value in
              {**own, **values}.items()]  # fmt: skip
    return "\n".join([*lines, _END]) + "\n"


def _many_steps(setting: Setting) -> bool:
    """Whether a macro step may need more micro steps than an FMU's default allows."""
    if setting.size is None or setting.by_tolerance:
        return False
    return setting.step / setting.size > 5e5


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _literal(value: Value) -> str:
    return _quoted(value) if isinstance(value, str) else repr(value)


def put_choice(path: Path, block: str) -> None:
    """Write a block into a script: in place of an earlier one, else before its main guard.

    The file appears whole or not at all, in its own encoding and line ends, and only if it is still
    valid Python.
    """
    with sole_writer(path, wait=True):
        _put(path, block)


def _put(path: Path, block: str) -> None:
    data = path.read_bytes()
    try:
        encoding, _ = tokenize.detect_encoding(io.BytesIO(data).readline)
        text = data.decode(encoding)
    except (SyntaxError, UnicodeDecodeError) as error:
        raise CurveboundError(f"{path} cannot be read: {error}. Edit it by hand.") from error
    end = "\r\n" if "\r\n" in text else "\n"
    text = text.replace("\r\n", "\n")
    lines = text.splitlines(keepends=True)
    begins = [i for i, line in enumerate(lines) if line.startswith(_BEGIN)]
    ends = [i for i, line in enumerate(lines) if line.startswith(_END)]
    if begins and ends and ends[0] > begins[0]:
        lines[begins[0] : ends[0] + 1] = [block]
    else:
        at = _guard(text)
        if at is None:
            lines += ["" if text.endswith("\n") else "\n", "\n", block]
        else:
            lines[at:at] = [block, "\n"]
    changed = "".join(lines)
    try:
        ast.parse(changed)
    except SyntaxError as error:
        raise CurveboundError(
            f"{path} cannot be changed safely: {error}. Edit it by hand."
        ) from error
    write_whole(
        path, lambda temporary: temporary.write_bytes(changed.replace("\n", end).encode(encoding))
    )


def _guard(text: str) -> int | None:
    """Index of the line of `if __name__ == "__main__":`, if the script has it at top level."""
    for node in ast.parse(text).body:
        if isinstance(node, ast.If) and "__name__" in ast.unparse(node.test):
            return node.lineno - 1
    return None
