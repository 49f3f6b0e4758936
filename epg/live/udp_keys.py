# SPDX-License-Identifier: Apache-2.0
"""The keys of consoles by UDP that this user has given, a file for each address, which only the user can read.

A key is 128 bits.  People write it as 32 hexadecimal digits.

>>> read_key("0011-2233 4455-6677-8899-AABB-CCDD-EEFF").hex()
'00112233445566778899aabbccddeeff'
"""

from __future__ import annotations

import contextlib
import os
import re
from pathlib import Path, PurePath
from urllib.parse import quote

from epg.generator.system import here
from epg.live.port import PortError
from epg.live.udp_seal import KEY


def folder() -> Path:
    """``~/.config/epg/keys``, or what the system says in its place."""
    return here.settings() / "epg" / "keys"


def read_key(text: str) -> bytes:
    """The key that a person has typed.

    :raises PortError: it does not have the form of a key
    """
    digits = re.sub(r"[-\s]", "", text)
    if re.fullmatch(rf"[0-9a-fA-F]{{{2 * KEY}}}", digits) is None:
        raise PortError("this is not the key of a console", f"a key has {2 * KEY} digits, 0 to 9 and a to f")
    return bytes.fromhex(digits)


def file_of(path: PurePath) -> Path:
    """The file with the key of the port ``path``.  It may not exist."""
    return folder() / quote(str(path), safe="")


def kept_key(path: PurePath) -> bytes | None:
    """The key that was given for this port; None if there is none.

    :raises PortError: the file cannot be read
    """
    file = file_of(path)
    try:
        return read_key(file.read_text(encoding="ascii"))
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError, PortError) as error:
        raise PortError(f"the file with the key of {path} cannot be used: {error}", f"remove {file}") from error


def keep_key(path: PurePath, text: str) -> None:
    """Keeps the key that a person has typed for this port.

    :raises PortError: it does not have the form of a key, or the file cannot be written
    """
    key = read_key(text)
    file = file_of(path)
    new = file.with_name(f"{file.name}.{os.getpid()}.new")
    try:
        file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        new.unlink(missing_ok=True)
        with open(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="ascii") as output:
            output.write(key.hex() + "\n")
        new.replace(file)
    except OSError as error:
        raise PortError(f"the key of {path} cannot be kept: {error}", f"look at {file.parent}") from error


def forget_key(path: PurePath) -> None:
    """Removes the key of this port, if there is one."""
    with contextlib.suppress(OSError):  # the next key replaces it
        file_of(path).unlink()
