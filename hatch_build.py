"""Build hook: what a wheel holds besides the Python package.

A wheel carries copies of ``cmake/``, ``targets/``, ``schemas/`` and the page about messages in ``epg/_data``; an
editable install reads those of the checkout, so that an edit there is seen at once.  Both get
``share/EPG/cmake/EPGConfig.cmake``, where CMake looks.
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

DATA = ("cmake", "targets", "schemas")


class EpgBuildHook(BuildHookInterface):
    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        root = Path(self.root)
        found = re.search(r'__version__ = "(.+?)"', (root / "epg/__init__.py").read_text(encoding="utf-8"))
        assert found
        self.folder = Path(tempfile.mkdtemp(prefix="epg-wheel-"))
        forwarder = root / "cmake/forwarder"
        config = (forwarder / "EPGConfig.cmake").read_text(encoding="utf-8")
        if version == "editable":
            checkout = (root / "cmake" / "EPGConfig.cmake").as_posix()
            config = f'# Leads to the checkout of an editable install.\ninclude("{checkout}")\n'
        else:
            for name in DATA:
                build_data["force_include"][str(root / name)] = f"epg/_data/{name}"
            build_data["force_include"][str(root / "docs/errors.md")] = "epg/_data/docs/errors.md"
        files = {
            "EPGConfig.cmake": config,
            "EPGConfigVersion.cmake": (forwarder / "EPGConfigVersion.cmake")
            .read_text(encoding="utf-8")
            .replace("@VERSION@", found[1]),
        }
        for name, text in files.items():
            (self.folder / name).write_text(text, encoding="utf-8")
            build_data["shared_data"][str(self.folder / name)] = f"share/EPG/cmake/{name}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        import shutil

        shutil.rmtree(self.folder, ignore_errors=True)
