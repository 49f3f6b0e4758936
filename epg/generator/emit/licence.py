"""The line with the licence, which is the first line of each generated file that can have a comment.

>>> first_line("jiwy_app.c")
'/* SPDX-License-Identifier: Apache-2.0 */'

``NOTICE`` permits the use of generated files under any terms.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePosixPath

_APACHE = "SPDX-License-Identifier: Apache-2.0"
_OF_FMI = "SPDX-License-Identifier: BSD-2-Clause"
_HASH = (".cmake", ".Kconfig")
_BLOCK = (".c", ".cpp", ".h", ".overlay")


def with_licence(files: Mapping[str, str]) -> dict[str, str]:
    """The generated ``files`` with their licence lines.  Copies of the model's own files stay unchanged."""
    return {name: f"{line}\n{text}" if (line := first_line(name)) else text for name, text in files.items()}


def first_line(name: str) -> str:
    """The licence line of the generated file ``name``, or "" if it gets none."""
    path = PurePosixPath(name)
    folder = path.parts[0] if len(path.parts) > 1 else ""
    if folder.endswith(("_copies", "_fmu")):
        return ""
    licence = _OF_FMI if folder.endswith("_headers") and path.name.startswith(("fmi2", "fmi3")) else _APACHE
    if path.suffix in _HASH:
        return f"# {licence}"
    return f"/* {licence} */" if path.suffix in _BLOCK else ""
