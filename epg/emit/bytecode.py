# SPDX-License-Identifier: Apache-2.0
"""Compiled templates kept in EPG's cache, as Python keeps compiled modules in ``__pycache__``.

Compiling the templates of one target takes longer than all else that EPG does with it.  A file is named after
everything that decides what it holds: the template's text and name, this package's own code, Jinja and the
interpreter.  One that is damaged is not used, a cache that cannot be written is none.
"""

from __future__ import annotations

import hashlib
import marshal
import os
import sys
from contextlib import suppress
from importlib.util import MAGIC_NUMBER
from pathlib import Path
from types import CodeType

import jinja2.compiler
from jinja2.bccache import Bucket

_OWN = ("bytecode.py", "template.py", "text.py")
_DIGEST = hashlib.sha256().digest_size


class TemplateCache(jinja2.BytecodeCache):
    """Compiled templates in ``folder``; ``language`` is the environment's, which decides what is compiled too."""

    def __init__(self, folder: Path, language: str) -> None:
        own = hashlib.sha256(MAGIC_NUMBER + language.encode())
        for path in (Path(str(jinja2.compiler.__file__)), *(Path(__file__).parent / name for name in _OWN)):
            own.update(path.read_bytes())
        self.folder = folder / f"templates-{sys.implementation.cache_tag}-{own.hexdigest()[:12]}"

    def load_bytecode(self, bucket: Bucket) -> None:
        try:
            data = self._file(bucket).read_bytes()
        except OSError:
            return
        if hashlib.sha256(data[_DIGEST:]).digest() == data[:_DIGEST]:
            code = marshal.loads(data[_DIGEST:])
            assert isinstance(code, CodeType)
            bucket.code = code

    def dump_bytecode(self, bucket: Bucket) -> None:
        if sys.dont_write_bytecode:
            return
        data = marshal.dumps(bucket.code)
        file = self._file(bucket)
        temporary = file.with_name(f".{file.name}.{os.getpid()}")
        try:
            self.folder.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            self.folder.mkdir(exist_ok=True)
            temporary.write_bytes(hashlib.sha256(data).digest() + data)
            os.replace(temporary, file)
        except OSError:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)

    def _file(self, bucket: Bucket) -> Path:
        return self.folder / f"{bucket.key}-{bucket.checksum}"
