# SPDX-License-Identifier: Apache-2.0
"""Finds the model in a folder, and the importer that recognises it.

Of exports, the contents of the files decide, not their names, because users rename the files.  Formats with a
description of their own have a higher rank: a folder with a ``model.yaml`` or an FMU can also contain sources that look
like an export.  If there are several models of one rank, EPG chooses none, because another controller than the user
means would move the robot.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from itertools import groupby, product
from pathlib import Path
from typing import TYPE_CHECKING

from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.documents.source_file import read_any_text
from epg.generator.documents.text_file import is_file
from epg.generator.importers import by_hand, c_function, cpp_class, fmu, tokens
from epg.generator.importers.importer import FoundModel, Importer, NearlyModel
from epg.generator.models.c_code import KEYWORDS
from epg.generator.models.folders import source_files
from epg.generator.models.identifiers import is_identifier
from epg.generator.models.model import Model, Parameter, Port
from epg.generator.source import Span, YamlNode

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

IMPORTERS: dict[str, Importer] = {
    "by_hand": by_hand.IMPORTER,
    "fmu": fmu.IMPORTER,
    "c_function": c_function.IMPORTER,
    "cpp_class": cpp_class.IMPORTER,
    "tokens": tokens.IMPORTER,
}
"""EPG's own importers by their names, the highest rank first."""

LOOKED_FOR = (
    "a model is a folder with an export of 20-sim (xxsubmod.c and the files beside it, <Submodel>.cpp with common/, "
    "or tokens.xml), with an FMU, or with a model.yaml"
)


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
    return _load_folder(path, whole, diagnostics)


def _load_folder(path: Path, whole: Span, diagnostics: Diagnostics) -> Model | None:
    """The only model in a folder, or else directly below it."""
    try:
        entries = sorted(path.iterdir())
    except OSError as error:
        message = f"cannot read the folder '{path.name}': {error.strerror or error}"
        diagnostics.error("model-unreadable", whole, message, hint="check its permissions")
        return None
    if not entries:
        diagnostics.error("model-not-recognised", whole, f"the folder '{path.name}' is empty", hint=LOOKED_FOR)
        return None
    looked: list[Path] = []
    considered: list[Path] = []
    places = [path], [entry for entry in entries if _is_searched(entry)]
    for importers_of, folders in product((IMPORTERS.values, _of_plugins), places):
        candidates, read = _candidates(folders, importers_of())
        looked += folders
        considered += read
        if len(candidates) == 1:
            model = candidates[0].load(diagnostics)
            return model if model is None else _with_search(model, looked, considered)
        if candidates:
            names = ", ".join(sorted(candidate.file.relative_to(path).as_posix() for candidate in candidates)[:8])
            message = f"the folder '{path.name}' has {len(candidates)} models"
            diagnostics.error("model-ambiguous", whole, message, hint=f"name one of them: {names}")
            return None
    message = f"EPG does not recognise a model in the folder '{path.name}'"
    _report(message, path, LOOKED_FOR + _found(path), whole, diagnostics)
    return None


def load_by_importer(path: Path, node: YamlNode, diagnostics: Diagnostics) -> Model | None:
    """The model of the importer that a ``model.yaml`` names.  None after an error.  ``node`` fits its schema."""
    candidates = _named_models(path.parent, node, diagnostics)
    if candidates is None:
        return None
    named = node["importer"]
    if len(candidates) != 1:
        names = ", ".join(each.file.name for each in candidates[:8])
        message = f"the importer '{named.value}' finds {len(candidates) or 'no'} models here"
        hint = f"write one of them after 'file': {names}" if candidates else "write its main file after 'file'"
        diagnostics.error("model-ambiguous" if names else "model-not-recognised", named.span, message, hint=hint)
        return None
    model = candidates[0].load(diagnostics)
    return model and replace(model, files=tuple(sorted({*model.files, path})))


def _named_models(folder: Path, node: YamlNode, diagnostics: Diagnostics) -> list[FoundModel] | None:
    """The models that the importer finds whose name is in ``node``, or the one whose file is.  None after an error."""
    named, file = node["importer"], node.get("file")
    importers = {**plugin_importers(), **IMPORTERS}
    del importers["by_hand"]  # it has called this function
    if named.value not in importers:
        message = f"there is no importer '{named.value}'"
        hint = did_you_mean(str(named.value), sorted(importers), "importers")
        diagnostics.error("unknown-importer", named.span, message, hint=hint)
        return None
    importer = importers[str(named.value)]
    if file is None:
        return importer.find(folder)
    if not is_file(folder / str(file.value)):
        message = f"there is no file '{file.value}'"
        diagnostics.error("file-not-found", file.span, message, hint="write it relative to this file")
        return None
    before = diagnostics.error_count
    candidate = importer.at(folder / str(file.value), diagnostics)
    return None if diagnostics.error_count > before else [candidate] if candidate else []


def _is_searched(entry: Path) -> bool:
    return (
        entry.is_dir() and not entry.name.startswith(".") and entry.name.lower() not in ("project", "build", "binaries")
    )


class _OfPlugin(Importer):
    """An importer of a plug-in.  Its own files count as files of each model: their changes can change the library."""

    def __init__(self, entry: EntryPoint) -> None:
        from epg.generator.plugins import load

        wanted = "an object of a class that derives from Importer"
        importer: Importer = load(entry, wanted, lambda found: isinstance(found, Importer))
        self._entry = entry
        self._importer = importer
        self.rank = importer.rank
        folder = Path(str(sys.modules[type(importer).__module__].__file__)).parent
        self._files = [file for file in folder.iterdir() if file.suffix in (".py", ".j2")]

    def find(self, folder: Path) -> list[FoundModel]:
        return [self._with_files(found) for found in self._importer.find(folder)]

    def may_be(self, path: Path) -> bool:
        return self._importer.may_be(path)

    def at(self, path: Path, diagnostics: Diagnostics) -> FoundModel | None:
        found = self._importer.at(path, diagnostics)
        return self._with_files(found) if found else None

    def considered(self, folder: Path) -> list[Path]:
        return self._importer.considered(folder)

    def nearly(self, path: Path) -> NearlyModel | None:
        return self._importer.nearly(path)

    def _with_files(self, found: FoundModel) -> FoundModel:
        def load(diagnostics: Diagnostics) -> Model | None:
            model = found.load(diagnostics)
            if model is not None:
                self._check_identifiers(model)
            return model and replace(model, files=tuple(sorted({*model.files, *self._files})))

        return replace(found, load=load)

    def _check_identifiers(self, model: Model) -> None:
        """Raises UserError if the importer has given a port or parameter a name that C does not allow."""
        from epg.generator.plugins import broken, named

        names: list[Port | Parameter] = [*model.inputs, *model.outputs, *model.parameters]
        for each in names:
            if not is_identifier(each.identifier) or each.identifier in KEYWORDS:
                given = f"gives '{each.name}' the identifier '{each.identifier}', which C does not allow"
                hint = "its importer must report a name that it cannot use, or give it another identifier"
                raise broken(self._entry, f"{named(self._entry)} {given}", hint)


@cache
def plugin_importers() -> dict[str, Importer]:
    """The importers of plug-ins by their names, the highest rank first.  Raises UserError for a broken plug-in."""
    from epg.generator.plugins import entry_points

    importers = {name: _OfPlugin(entry) for name, entry in sorted(entry_points("importers").items())}
    return dict(sorted(importers.items(), key=lambda item: -item[1].rank))


def _of_plugins() -> Iterable[Importer]:
    """The importers of plug-ins.  They are asked where none of EPG's recognises a model."""
    return plugin_importers().values()


def _candidates(folders: list[Path], among: Iterable[Importer]) -> tuple[list[FoundModel], list[Path]]:
    """The models in ``folders`` of the highest rank that exists there, and the files that were read to find them."""
    read: list[Path] = []
    for importers in (list(group) for _, group in groupby(among, lambda importer: importer.rank)):
        read += [file for folder in folders for importer in importers for file in importer.considered(folder)]
        found = [model for folder in folders for importer in importers for model in importer.find(folder)]
        if found:
            return found, read
    return [], read


def _with_search(model: Model, looked: list[Path], considered: list[Path]) -> Model:
    """``model`` with the folders in which EPG has looked for it, and the files that it has read there."""
    searched = (folder for folder in looked if folder != model.directory)
    return replace(
        model,
        searched=tuple(dict.fromkeys((*model.searched, *searched))),
        considered=tuple(sorted({*model.considered, *considered})),
    )


def _load_file(path: Path, whole: Span, diagnostics: Diagnostics) -> Model | None:
    """The model of which ``path`` is the main file.  None if it is not one; the reasons are reported."""
    before = diagnostics.error_count
    importer = _importer_of(path)
    if importer is not None:
        candidate = importer.at(path, diagnostics)
        if candidate is not None:
            return candidate.load(diagnostics)
        if diagnostics.error_count > before:
            return None
    elif path.suffix.lower() not in (".h", ".hpp") and read_any_text(path, diagnostics, whole) is None:
        return None
    hint = "name the folder, or the submodel's file (xxsubmod.c, <Submodel>.cpp, tokens.xml, model.yaml, <name>.fmu)"
    _report(f"'{path.name}' is not a model", path, hint, whole, diagnostics)
    return None


def _importer_of(path: Path) -> Importer | None:
    """The first importer whose models can have a main file of this name."""
    for importers in (IMPORTERS.values, _of_plugins):
        for importer in importers():
            if importer.may_be(path):
                return importer
    return None


def _report(message: str, path: Path, hint: str, whole: Span, diagnostics: Diagnostics) -> None:
    """Reports that a folder or file is no model, and what it nearly is."""
    nearly = next(filter(None, (importer.nearly(path) for importer in (*IMPORTERS.values(), *_of_plugins()))), None)
    reason = nearly.reason if nearly else ""
    diagnostics.error("model-not-recognised", whole, message + reason, hint=nearly.hint if nearly else hint)


def _near(path: Path) -> str:
    try:
        folders = sorted(entry.name for entry in path.parent.iterdir() if _is_searched(entry))
    except (OSError, ValueError):
        return "the folder above it does not exist either"
    return f"folders beside it: {', '.join(folders[:12])}" if folders else ""


def _found(path: Path) -> str:
    names = [entry.name for entry in source_files(path, (".c", ".cpp", ".xml", ".h", ".emx"), 1)]
    if any(name.lower().endswith(".emx") for name in names):
        menu = "Tools > Real Time Toolbox > C-Code Generation"
        return f"; generate code from the .emx in 20-sim ({menu}) and name this folder"
    return f"; the folder has {', '.join(names[:6])}" if names else ""
