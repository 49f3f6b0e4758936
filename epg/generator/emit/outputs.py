# SPDX-License-Identifier: Apache-2.0
"""All generated files of a target or of a model library, by file name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from epg.generator.emit.application import Emitter
from epg.generator.emit.cmake import PathNames, application_cmake, model_cmake
from epg.generator.emit.description import describe
from epg.generator.emit.fingerprint import PLACE, application_hash
from epg.generator.emit.licence import with_licence
from epg.generator.emit.model import emit_model, model_build
from epg.generator.models.model import Model
from epg.generator.resolve.application import Application


def application_outputs(app: Application, roots: Sequence[Path], names: PathNames) -> dict[str, str]:
    """The text of each generated file of ``app``: C, the libraries of its models, CMake and the description.

    ``roots`` are the ``targets`` folders.
    """
    emitter = Emitter(app, roots)
    files = emitter.files()
    parts = [(app.model, f"{app.name}_model", app.parameters)]
    if app.plant is not None and not app.plant.library:
        parts.append((app.plant.model, f"{app.name}_plant", app.plant.parameters))
    builds = []
    for model, name, parameters in parts:
        files |= emit_model(model, name, parameters, terminate=False)
        builds.append((name, model_build(model, name, parameters)))
    hash = application_hash(app, files)
    files = {name: text.replace(PLACE, hash) for name, text in files.items()}
    files[f"{app.name}.json"] = describe(emitter, names, hash)
    files[f"{app.name}.cmake"] = application_cmake(app, builds, files, names)
    return with_licence(files)


def model_outputs(model: Model, name: str, instances: int, names: PathNames) -> dict[str, str]:
    """The text of each generated file of a model library without a target, for ``epg_add_model``."""
    files = emit_model(model, name, {}, instances)
    files[f"{name}.cmake"] = model_cmake(model, name, model_build(model, name, {}), files, names)
    return with_licence(files)
