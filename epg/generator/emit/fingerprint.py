# SPDX-License-Identifier: Apache-2.0
"""A hash that identifies the behaviour of an application: equal hashes mean equal behaviour.

The hash covers the generated files and the sources that are compiled with them, but not the ``.tcf`` and the bindings.
A comment in a ``.tcf``, the folder of the project and the line ends of files therefore do not change it.  The hash does
not cover EPG's own runtime and port layers; EPG's version, which is reported beside the hash, identifies them.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path

from epg.generator.emit.cmake import added_classes
from epg.generator.emit.text import Code
from epg.generator.models.model import Model
from epg.generator.resolve.application import Application

DIGITS = 16

PLACE = "\ue000"
"""The placeholder of the hash in generated text.  Text of the user cannot contain it: the filters escape it."""

LITERAL = Code(f'"{PLACE}"')


def application_hash(app: Application, generated: Mapping[str, str]) -> str:
    """The first :data:`DIGITS` hexadecimal digits of the SHA-256 of ``app``.

    ``generated`` holds the generated files, with :data:`PLACE` in the place of the hash.
    """
    communication, target = app.communication, app.target
    digest = hashlib.sha256()
    configured = [target.name, target.board.name, target.platform.name]
    configured += [communication.middleware.name, communication.transport or ""]
    configured += [f"console.transport={communication.console_transport}"] if communication.console_transport else []
    configured += [f"{name}={value}" for name, value in communication.options.items()]
    configured += [f"console.{name}={value}" for name, value in communication.console_options.items()]
    _add(digest, "configuration", json.dumps(configured).encode())
    for name, text in sorted(generated.items()):
        _add(digest, name, text.encode())
    models = [app.model] if app.plant is None else [app.model, app.plant.model]
    for number, model in enumerate(models):
        _add_files(digest, f"model {number}", model.directory, model.files)
    for kind in sorted({component.kind.name: component.kind for component in app.components}.items()):
        _add_files(digest, f"kind {kind[0]}", kind[1].folder, kind[1].files)
    for middleware in communication.middlewares:
        _add_files(digest, f"middleware {middleware.name}", middleware.folder, middleware.files)
    for each in added_classes(app):
        _add_files(digest, f"class {each.name}", each.folder, each.files(target.platform.layer))
    return digest.hexdigest()[:DIGITS]


def model_hash(model: Model, parameters: Mapping[str, float]) -> str:
    """A hexadecimal number that identifies a model and the generated values of its parameters.

    The firmware keeps it with stored parameters, so that parameters of another model are not loaded.  A recording has
    it, too, so that a replay uses the same model.
    """
    digest = hashlib.sha256()
    values = [(p.name, repr(parameters.get(p.name, p.value))) for p in model.parameters]
    _add(digest, model.name, json.dumps(values).encode())
    _add_files(digest, "model", model.directory, model.files)
    return digest.hexdigest()[:DIGITS]


def _add_files(digest: hashlib._Hash, label: str, folder: Path, files: Iterable[Path]) -> None:
    named = [
        (path.relative_to(folder).as_posix() if path.is_relative_to(folder) else path.name, path) for path in files
    ]
    read = ((name, path.read_bytes().replace(b"\r\n", b"\n")) for name, path in named)
    for name, data in sorted(read):  # with the data: files from different outside folders can have the same name
        _add(digest, f"{label}/{name}", data)


def _add(digest: hashlib._Hash, name: str, data: bytes) -> None:
    """Adds one part with its length, so that different parts cannot give the same sequence of bytes."""
    digest.update(f"{len(name)} {name} {len(data)}\n".encode())
    digest.update(data)
