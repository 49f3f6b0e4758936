# SPDX-License-Identifier: Apache-2.0
"""Finds the model in a folder, and recognises its kind."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

from epg.dataclass import dataclass
from epg.diagnostics import Diagnostics
from epg.documents.source_file import SourceFile, read_any_text, read_source
from epg.models import c_function, cpp_class
from epg.models.c_code import parse_code
from epg.models.fmu_files import DESCRIPTION, SUFFIX, is_fmu_folder
from epg.models.folders import source_files
from epg.models.link import is_program
from epg.models.model import Model
from epg.models.model_yaml import FILE_NAME
from epg.models.tokens import is_tokens_file, load_tokens
from epg.models.whole import is_whole
from epg.source import Span

LOOKED_FOR = (
    "a model is a folder with an export of 20-sim (xxsubmod.c and the files beside it, <Submodel>.cpp with common/, "
    "or tokens.xml), with an FMU, or with a model.yaml"
)
SUBMODEL = "functions ...InitializeSubmodel() and ...CalculateSubmodel()"
EQUATIONS = "CalculateDynamic"  # part of the name of a function that is in every C export
EXPORT_AGAIN = (
    "generate the code of the submodel in 20-sim again (Tools > Real Time Toolbox > C-Code Generation, 'C function') "
    "into a separate folder, and name this folder"
)
_SUBMODEL = re.compile(r"\bvoid\s+\w*(?:Initialize|Calculate)Submodel\w*\s*\(", re.ASCII)
_MAX_FILES = 400
_Loader = Callable[[Diagnostics], "Model | None"]


@dataclass(frozen=True)
class FoundModel:
    """A model that was found.  The user can name ``file`` to choose it among several."""

    file: Path
    load: _Loader


def load_model(path: Path, diagnostics: Diagnostics, wanted_by: Span | None = None) -> Model | None:
    """The model in the folder or file ``path``.  None if there is none; the reasons are reported.

    If the folder does not hold a model, the folders directly below it are searched.  ``wanted_by`` is the place where
    the path is written; problems with the whole path are reported there.
    """
    whole = wanted_by or Span(str(path))
    try:
        exists, is_file = path.exists(), path.is_file()
    except (OSError, ValueError):
        exists, is_file = False, False
    if not exists:
        diagnostics.error("model-not-found", whole, f"there is no folder '{path}'", hint=_near(path))
        return None
    if is_file:
        return _load_file(path, whole, diagnostics)
    try:
        entries = sorted(path.iterdir())
    except OSError as error:
        message = f"cannot read the folder '{path.name}': {error.strerror or error}"
        diagnostics.error("model-unreadable", whole, message, hint="check its permissions")
        return None
    if not entries:
        diagnostics.error("model-not-recognised", whole, f"the folder '{path.name}' is empty", hint=LOOKED_FOR)
        return None
    for folders in ([path], [entry for entry in entries if _is_searched(entry)]):
        candidates = _candidates(folders)
        if len(candidates) == 1:
            return candidates[0].load(diagnostics)
        if candidates:
            names = ", ".join(sorted(candidate.file.relative_to(path).as_posix() for candidate in candidates)[:8])
            message = f"the folder '{path.name}' has {len(candidates)} models"
            diagnostics.error("model-ambiguous", whole, message, hint=f"name one of them: {names}")
            return None
    message = f"EPG does not recognise a model in the folder '{path.name}'"
    part = _part_of_export(source_files(path, c_function.SUFFIXES, 1))
    if part:
        message += f": '{part}' has equations of a 20-sim export, but no file has its {SUBMODEL}"
    diagnostics.error("model-not-recognised", whole, message, hint=EXPORT_AGAIN if part else LOOKED_FOR + _found(path))
    return None


def _is_searched(entry: Path) -> bool:
    return (
        entry.is_dir() and not entry.name.startswith(".") and entry.name.lower() not in ("project", "build", "binaries")
    )


def _candidates(folders: list[Path]) -> list[FoundModel]:
    """The models in ``folders`` of one kind: the first of written by hand, FMU, sources, tokens that exists there."""
    for find in (_hand_written, _fmus, _sources, _tokens):
        found = [candidate for folder in folders for candidate in find(folder)]
        if found:
            return found
    return []


def _hand_written(folder: Path) -> list[FoundModel]:
    path = folder / FILE_NAME
    return [FoundModel(path, partial(_load_hand_written, path))] if path.is_file() else []


# Imported when they are needed: a run needs one of these modules, and together they take a third of all imports.
def _load_hand_written(path: Path, diagnostics: Diagnostics) -> Model | None:
    from epg.models.hand_written import load_hand_written

    return load_hand_written(path, diagnostics)


def _fmus(folder: Path) -> list[FoundModel]:
    if is_fmu_folder(folder):
        return [FoundModel(folder / DESCRIPTION, partial(_load_fmu, folder))]
    return [FoundModel(file, partial(_load_fmu, file)) for file in source_files(folder, (SUFFIX,), 0)]


def _load_fmu(path: Path, diagnostics: Diagnostics) -> Model | None:
    from epg.models.fmu import load_fmu

    return load_fmu(path, diagnostics)


def _sources(folder: Path) -> list[FoundModel]:
    files = [f for f in source_files(folder, (*c_function.SUFFIXES, *cpp_class.SUFFIXES), 0) if not is_program(f)]
    found = []
    for file in files[:_MAX_FILES]:
        candidate = _source_candidate(file, Diagnostics())
        if candidate is not None:
            found.append(candidate)
    return found


def _source_candidate(path: Path, diagnostics: Diagnostics) -> FoundModel | None:
    """The model whose entry points or class a source file defines, also if the file is not whole.  Else None."""
    file = read_source(path, diagnostics)
    if file is None or "Calculate" not in file.text:
        return None
    code = parse_code(file)
    if path.suffix.lower() in c_function.SUFFIXES:
        if c_function.is_c_function(code):
            return FoundModel(path, partial(c_function.load_c_function, code))
        return _broken(file) if _SUBMODEL.search(file.code) else None
    if cpp_class.submodel_classes(code):
        return FoundModel(path, partial(cpp_class.load_cpp_class, code))
    return _broken(file) if "::CopyInputsToVariables" in file.code else None


def _broken(file: SourceFile) -> FoundModel | None:
    """A candidate for the file of a submodel that is not whole, which reports that when it is loaded.

    Without this candidate, EPG would silently use a ``tokens.xml`` beside the file instead.
    """

    def load(diagnostics: Diagnostics) -> None:
        is_whole(file, diagnostics)

    return None if is_whole(file, Diagnostics()) else FoundModel(file.path, load)


def _tokens(folder: Path) -> list[FoundModel]:
    files = [f for f in source_files(folder, (".xml",), 0) if is_tokens_file(f)]
    return [FoundModel(file, partial(_load_tokens, file)) for file in files]


def _load_tokens(path: Path, diagnostics: Diagnostics) -> Model | None:
    from epg.models.tokens_model import load_tokens_model

    tokens = load_tokens(path, diagnostics, required=True)
    return load_tokens_model(tokens, diagnostics) if tokens else None


def _load_file(path: Path, whole: Span, diagnostics: Diagnostics) -> Model | None:
    """The model of which ``path`` is the main file.  None if it is not one; the reasons are reported."""
    suffix = path.suffix.lower()
    if suffix == SUFFIX:
        return _load_fmu(path, diagnostics)
    if path.name == DESCRIPTION and is_fmu_folder(path.parent):
        return _load_fmu(path.parent, diagnostics)
    if suffix == ".xml":
        return _load_tokens(path, diagnostics)
    if suffix in (".yaml", ".yml"):
        return _load_hand_written(path, diagnostics)
    if suffix in (*c_function.SUFFIXES, *cpp_class.SUFFIXES):
        before = diagnostics.error_count
        candidate = _source_candidate(path, diagnostics)
        if candidate is not None:
            return candidate.load(diagnostics)
        if diagnostics.error_count > before:
            return None
    elif suffix not in (".h", ".hpp") and read_any_text(path, diagnostics, whole) is None:
        return None
    message = f"'{path.name}' is not a model"
    if _part_of_export([path]):
        message += f": it has equations of a 20-sim export, but not its {SUBMODEL}"
        diagnostics.error("model-not-recognised", whole, message, hint=EXPORT_AGAIN)
        return None
    hint = "name the folder, or the submodel's file (xxsubmod.c, <Submodel>.cpp, tokens.xml, model.yaml, <name>.fmu)"
    diagnostics.error("model-not-recognised", whole, message, hint=hint)
    return None


def _near(path: Path) -> str:
    try:
        folders = sorted(entry.name for entry in path.parent.iterdir() if _is_searched(entry))
    except (OSError, ValueError):
        return "the folder above it does not exist either"
    return f"folders beside it: {', '.join(folders[:12])}" if folders else ""


def _part_of_export(files: list[Path]) -> str:
    """The name of the first file that has equations of a C export, for example because a user copied only these.

    Empty if there is none.
    """
    for path in files[:_MAX_FILES]:
        file = read_source(path, Diagnostics()) if path.suffix.lower() in c_function.SUFFIXES else None
        if file and EQUATIONS in file.text and any(EQUATIONS in code.name for code in parse_code(file).functions):
            return path.name
    return ""


def _found(path: Path) -> str:
    names = [entry.name for entry in source_files(path, (".c", ".cpp", ".xml", ".h", ".emx"), 1)]
    if any(name.lower().endswith(".emx") for name in names):
        menu = "Tools > Real Time Toolbox > C-Code Generation"
        return f"; generate code from the .emx in 20-sim ({menu}) and name this folder"
    return f"; the folder has {', '.join(names[:6])}" if names else ""
