"""Build hooks: what FMUs need compiled, for every platform that this machine can; the README.

What is compiled goes into the wheel, or for an editable installation into the checkout, where git
ignores it.
"""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface


class Compiled(BuildHookInterface[Any]):
    """Compiles the binary and the kernel of all FMUs, and the kernels of the package's systems."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        source = Path(self.root) / "src"
        sys.path.insert(0, str(source))
        from curvebound.fmi import binaries
        from curvebound.fmi import compile as kernels

        ready = source / "curvebound" / "_compiled"
        shutil.rmtree(ready, ignore_errors=True)
        self.scratch = Path(tempfile.mkdtemp(prefix="curvebound-"))
        folder = ready if version == "editable" else self.scratch
        folder.mkdir(exist_ok=True)
        for reason in (*binaries.write_shipped(folder), *kernels.write_shipped(folder)):
            self.app.display_warning(f"without {reason}")
        for path in folder.iterdir():
            build_data["force_include"][str(path)] = f"curvebound/_compiled/{path.name}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        shutil.rmtree(self.scratch)


class Readme(MetadataHookInterface):
    """The README as a package index shows it: links to files of the project by absolute address."""

    PLUGIN_NAME = "custom"

    def update(self, metadata: dict[str, Any]) -> None:
        home = metadata["urls"]["Homepage"]
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        text = re.sub(r"!\[([^]]*)\]\((?!http)", rf"![\1]({home}/raw/main/", text)
        text = re.sub(r"(?<!!)\[([^]]*)\]\((?!http|#)", rf"[\1]({home}/blob/main/", text)
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
