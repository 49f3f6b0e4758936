# SPDX-License-Identifier: Apache-2.0
"""Hooks of the build: they add files other than the Python package to a wheel, and list the packages that EPG needs.

A wheel has copies of ``cmake/``, ``targets/``, ``schemas/``, the folders of targets in ``integration/``, Zephyr's
module and the page about messages in ``epg/_data``, and the schemas that editors read.  An editable install uses the
files of the checkout, so a change there has an effect at once.  Both install ``share/EPG/cmake/EPGConfig.cmake``, where
CMake searches for packages.
"""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

JIWY = ("CMakeLists.txt", "README.md", "ideal_loop.py", "jiwy.bindings.yaml", "model", "tracking.yaml")
PLANTS = ("plant", "plant.bindings.yaml")
EXAMPLES = (*(f"examples/jiwy/{name}" for name in JIWY + PLANTS), *(f"examples/relbot/{name}" for name in PLANTS))
"""The example of the README, without a build folder in it, and the simulated robots that `epg new` writes."""
DATA = ("cmake", "targets", "integration/20-sim", "zephyr", "zephyr_module", "docs/errors.md", *EXAMPLES)


EXTRAS = {"zephyr": "zephyr", "plot": "plot", "ros": "ros", "mcap": "mcap", "test": "test_all"}
"""The optional dependencies ("extras" of pip), and the file of ``epg/generator/lock`` that lists the packages of
each."""


class EpgMetadataHook(MetadataHookInterface):
    """Reads the dependencies from ``epg/generator/lock/*.in``, the only files that name packages and their oldest
    versions."""

    PLUGIN_NAME = "custom"

    def update(self, metadata: dict[str, Any]) -> None:
        # An import of epg.generator.bootstrap could lead to another EPG, which is installed where the wheel is built.
        lines = runpy.run_path(str(Path(self.root) / "epg/generator/bootstrap.py"))["requirement_lines"]
        metadata["dependencies"] = lines("generator")
        metadata["optional-dependencies"] = {extra: lines(group) for extra, group in EXTRAS.items()}


class EpgBuildHook(BuildHookInterface):
    """Adds the folders of ``DATA`` to a wheel, and CMake's package files to wheels and editable installs."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        root = Path(self.root)
        found = re.search(r'__version__ = "(.+?)"', (root / "epg/__init__.py").read_text(encoding="utf-8"))
        assert found
        self.folder = Path(tempfile.mkdtemp(prefix="epg-wheel-"))
        if version != "editable":
            parts = (folder.relative_to(root).as_posix() for folder in root.glob("integration/*/targets"))
            for name in (*DATA, *parts):
                build_data["force_include"][str(root / name)] = f"epg/_data/{name}"
            self._add_schemas(build_data["force_include"])
        forwarder = root / "cmake/forwarder"
        sources = {
            "EPGConfig.cmake": forwarder / ("EPGConfig.editable.cmake" if version == "editable" else "EPGConfig.cmake"),
            "EPGConfigVersion.cmake": forwarder / "EPGConfigVersion.cmake",
            "EPGCompatible.cmake": root / "cmake/EPGCompatible.cmake",
        }
        for name, source in sources.items():
            text = source.read_text(encoding="utf-8")
            text = text.replace("@VERSION@", found[1]).replace("@CHECKOUT@", root.as_posix())
            (self.folder / name).write_text(text, encoding="utf-8")
            build_data["shared_data"][str(self.folder / name)] = f"share/EPG/cmake/{name}"

    def _add_schemas(self, included: dict[str, str]) -> None:
        """Adds ``schemas/``, and the schemas for editors, which a checkout need not have."""
        for path in (Path(self.root) / "schemas").glob("*.json"):
            included[str(path)] = f"epg/_data/schemas/{path.name}"
        # Another process, because an EPG may be installed where the wheel is built.
        code = (
            "import sys; from pathlib import Path; sys.path.insert(0, sys.argv[1]);"
            "from epg.cli.schema import write_editor_schemas; write_editor_schemas(Path(sys.argv[2]))"
        )
        subprocess.run([sys.executable, "-B", "-c", code, self.root, str(self.folder / "editor")], check=True)
        included[str(self.folder / "editor")] = "epg/_data/schemas/editor"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        import shutil

        shutil.rmtree(self.folder, ignore_errors=True)
