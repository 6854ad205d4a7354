"""Build hooks: the kernels, compiled for every platform that this machine can; the README.

The kernels go into the wheel, or for an editable installation into the checkout, where git ignores
them.
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


class CompiledKernels(BuildHookInterface[Any]):
    """Compiles what all FMUs share, and the kernels of the systems that come with the package."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        source = Path(self.root) / "src"
        sys.path.insert(0, str(source))
        from curvebound.fmi.compile import write_shipped

        ready = source / "curvebound" / "_compiled"
        shutil.rmtree(ready, ignore_errors=True)
        folder = ready if version == "editable" else Path(tempfile.mkdtemp(prefix="curvebound-"))
        folder.mkdir(exist_ok=True)
        for reason in write_shipped(folder):
            self.app.display_warning(f"without compiled kernels {reason}")
        for path in folder.iterdir():
            build_data["force_include"][str(path)] = f"curvebound/_compiled/{path.name}"


class Readme(MetadataHookInterface):
    """The README as a package index shows it: links to files of the project by absolute address."""

    PLUGIN_NAME = "custom"

    def update(self, metadata: dict[str, Any]) -> None:
        home = metadata["urls"]["Homepage"]
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        text = re.sub(r"!\[([^]]*)\]\((?!http)", rf"![\1]({home}/raw/main/", text)
        text = re.sub(r"(?<!!)\[([^]]*)\]\((?!http|#)", rf"[\1]({home}/blob/main/", text)
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
