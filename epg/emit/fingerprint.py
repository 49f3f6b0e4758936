# SPDX-License-Identifier: Apache-2.0
"""One hash over everything an application is made from: two that have the same behave the same.

It is taken of what is generated and of the sources that are compiled with it, not of the files people write: a comment
in a ``.tcf`` changes nothing, wherever the files lie, and whatever their line ends are.  EPG's own runtime and port
layers are known by EPG's version, which stands beside the hash.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path

from epg.emit.text import Code
from epg.models.model import Model
from epg.resolve.application import Application

DIGITS = 16

PLACE = "\ue000"
"""Where the hash goes in generated text.  No text of a user can hold it: filters write it as an escape."""

LITERAL = Code(f'"{PLACE}"')


def application_hash(app: Application, generated: Mapping[str, str]) -> str:
    """The first hexadecimal digits of SHA-256; ``generated`` is the C, with :data:`PLACE` where the hash goes."""
    communication, target = app.communication, app.target
    digest = hashlib.sha256()
    configured = [target.name, target.board.name, target.platform.name]
    configured += [communication.middleware.name, communication.transport or ""]
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
    return digest.hexdigest()[:DIGITS]


def model_hash(model: Model, parameters: Mapping[str, float]) -> Code:
    """A C literal that identifies a model and the values of its parameters: what stored parameters belong to."""
    digest = hashlib.sha256()
    values = [(p.name, repr(parameters.get(p.name, p.value))) for p in model.parameters]
    _add(digest, model.name, json.dumps(values).encode())
    _add_files(digest, "model", model.directory, model.files)
    return Code(f"0x{digest.hexdigest()[:DIGITS]}u")


def _add_files(digest: hashlib._Hash, label: str, folder: Path, files: Iterable[Path]) -> None:
    named = [
        (path.relative_to(folder).as_posix() if path.is_relative_to(folder) else path.name, path) for path in files
    ]
    read = ((name, path.read_bytes().replace(b"\r\n", b"\n")) for name, path in named)
    for name, data in sorted(read):  # files of one name may lie in several folders outside of this one
        _add(digest, f"{label}/{name}", data)


def _add(digest: hashlib._Hash, name: str, data: bytes) -> None:
    """Lengths are added too, so that no part can pass for the end of another one."""
    digest.update(f"{len(name)} {name} {len(data)}\n".encode())
    digest.update(data)
