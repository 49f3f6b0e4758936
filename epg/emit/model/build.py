# SPDX-License-Identifier: Apache-2.0
"""The sources of a model's library, and how to compile them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from epg.dataclass import dataclass
from epg.emit.model.copies import copies, copy_name
from epg.models.details import CFunctionExport, CppClassExport, FmuExport, HandWritten
from epg.models.model import Model


@dataclass(frozen=True)
class ModelBuild:
    """The sources of a model's library.  Names (``str``) are relative to the folder of the generated files.

    ``generated`` are compiled with the project's options.

    ``exported_generated`` and ``exported`` are the model's own code.  They are compiled without warnings, as C11 or
    C++17, with ``-ffp-contract=off``, and with ``forced_header`` included first.  Their private include path is
    ``include_dirs`` and ``generated_include_dirs``, then the generated folder and its ``<name>_headers``.
    """

    generated: tuple[str, ...]
    exported_generated: tuple[str, ...]
    exported: tuple[Path, ...]
    include_dirs: tuple[Path, ...]
    forced_header: str | None
    language: str  # "c" or "c++"
    generated_include_dirs: tuple[str, ...] = ()


def model_build(model: Model, name: str, parameters: Mapping[str, float] | None = None) -> ModelBuild:
    """How to compile the files that ``emit_model(model, name, parameters)`` returns."""
    edited = copies(model, name, dict(parameters or {}))
    suffix = "cpp" if model.language == "c++" else "c"
    own = [f"{name}_export.{suffix}"]
    exported: tuple[Path, ...] = ()
    directories: tuple[Path, ...] = ()
    forced: str | None = None
    generated_directories: tuple[str, ...] = ()
    details = model.details
    if isinstance(details, FmuExport):
        from epg.emit.model.fmu_code import fmu_folder

        folder = fmu_folder(name)
        if details.packed:
            own += [f"{folder}/{unit}" for unit in details.units]
            generated_directories = tuple(f"{folder}/{place}" for place in details.include_dirs)
        else:
            exported = tuple(details.root / unit for unit in details.units)
            directories = tuple(details.root / place for place in details.include_dirs)
        forced = f"{name}_names.h"
    elif isinstance(details, CFunctionExport):
        units = [code.file.path for code in details.linked.units]
        exported = tuple(path for path in units if copy_name(name, path) not in edited)
        own += sorted(edited)
        directories = details.linked.include_dirs
        forced = f"{name}_names.h"
    elif isinstance(details, CppClassExport):
        directories = details.linked.include_dirs
    elif isinstance(details, HandWritten):
        directories = (*details.include_dirs, *sorted({source.parent for source in details.sources}))
        directories = tuple(dict.fromkeys(directories))
        if model.language == "c":
            exported = details.sources
            forced = f"{name}_names.h"
    generated = (f"{name}.c",)
    return ModelBuild(generated, tuple(own), exported, directories, forced, model.language, generated_directories)
