# SPDX-License-Identifier: Apache-2.0
"""The images of a system: the projects that build them, and the files that the builds make."""

from __future__ import annotations

import json
import re
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.system.check_system import CheckedSystem
from epg.system.system import SystemTarget

_UNFINISHED = re.compile(r"_pre[0-9]+$")
"""Programs that Zephyr links before the last one."""


def images_of(checked: CheckedSystem) -> list[tuple[str, Path, str]]:
    """The targets with a project for their image: the name, the project's folder, and the SDK's board.

    It is the target's own project, or that of the family or the platform.
    """
    found = []
    for name, application in checked.applications.items():
        target = application.target
        layer = target.platform.family or target.platform
        folder = checked.system.targets[name].project or layer.folder / "image"
        if folder.is_dir():
            found.append((name, folder, target.board.sdks.get(target.platform.sdk, "")))
    return found


def built_hash(target: SystemTarget, images: Path) -> str:
    """The hash of the files that the newest build of a target has generated; empty if there is none."""
    try:
        text = (images / target.name / "epg" / target.name / f"{target.name}.json").read_text(encoding="utf-8")
        return str(json.loads(text)["hash"])
    except (OSError, ValueError, KeyError, TypeError):
        return ""


def image_file(target: SystemTarget, hash: str, images: Path, diagnostics: Diagnostics) -> Path | None:
    """The image of a target in the folder ``images``, or None after reporting that it must be built.

    An image contains the ``hash`` of the files from which its target was generated.  A comment in one of these files
    does not change the hash.
    """
    folder = images / target.name
    hint = f"build the images: cmake --build <build folder> --target {images.name}"
    programs = sorted(path for path in folder.rglob("*.elf") if not _UNFINISHED.search(path.stem))
    if not programs:
        message = f"there is no image of '{target.name}' in {folder.as_posix()}"
        diagnostics.error("image-missing", target.span, message, hint=f"{hint}. --images names another folder")
        return None
    found = next((path for path in programs if hash.encode() in path.read_bytes()), None)
    if found is None:
        message = f"the image of '{target.name}' in {folder.as_posix()} was not built from the files as they are now"
        diagnostics.error("image-outdated", target.span, message, hint=hint)
    return found
