"""Whether two commits give the same results, bit by bit: CSV and replay data of every scene.

    python tests/same_results.py COMMIT [OTHER]

Runs the scenes of COMMIT and of OTHER (default: the files here, as they are), each with its own
package, FMUs and scenes, and names what differs. For changes that are to change nothing.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: what a replay page holds as data: the rest is style and script
_DATA = re.compile(r'<script type="(?:application/json|text/plain)"[^>]*>(.*?)</script>', re.DOTALL)


def checked_out(commit: str | None, folder: Path) -> Path:
    """The files of a commit in a new folder, those here where there is none."""
    if commit is None:
        return ROOT
    folder.mkdir()
    tar = subprocess.run(
        ["git", "-C", str(ROOT), "archive", commit], stdout=subprocess.PIPE, check=True
    )
    subprocess.run(["tar", "-x", "-C", str(folder)], input=tar.stdout, check=True)
    return folder


def results(tree: Path, out: Path) -> dict[str, bytes]:
    """CSV and replay data of each scene of a checkout: name -> content."""
    environment = {**os.environ, "PYTHONPATH": str(tree / "src")}
    found: dict[str, bytes] = {}
    for scene in sorted((tree / "scenarios").glob("*.py")):
        table, page = out / f"{scene.stem}.csv", out / f"{scene.stem}.html"
        command = [sys.executable, "-m", "curvebound", "run", scene.stem]
        command += ["--out", str(table), "--replay", str(page)]
        done = subprocess.run(
            command, cwd=out, env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode:
            found[scene.stem] = done.stderr.encode()
            continue
        found[table.name] = table.read_bytes()
        data = _DATA.findall(page.read_text(encoding="utf-8"))
        found[f"{scene.stem}, replay"] = "\n".join(data).encode()
    return found


def main() -> int:
    """Compare; returns 1 where something differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("commit")
    parser.add_argument("other", nargs="?")
    options = parser.parse_args()
    both = []
    with tempfile.TemporaryDirectory() as scratch:
        for name, commit in (("a", options.commit), ("b", options.other)):
            out = Path(scratch) / f"results_{name}"
            out.mkdir()
            both.append(results(checked_out(commit, Path(scratch) / name), out))
    before, now = both
    names = sorted(before.keys() | now.keys())
    different = [name for name in names if before.get(name) != now.get(name)]
    print(f"{len(names) - len(different)} of {len(names)} the same, bit by bit")
    for name in different:
        print(f"different: {name}")
    return int(bool(different))


if __name__ == "__main__":
    sys.exit(main())
