# SPDX-License-Identifier: Apache-2.0
"""Finds the user at the other end of a connection on this computer, on Linux.

/proc/net/tcp lists both ends of such a connection, each with the user who owns it (proc_pid_net(5)).  Every user of the
computer can connect to a port of 127.0.0.1.  A Unix socket would have permissions, but a browser cannot open one.  An
owner who is not known is not refused, because then the keys of ``keys.py`` still protect the page.
"""

from __future__ import annotations

import socket
import sys
from pathlib import Path

from epg.generator.system import here as system

TABLE = Path("/proc/net/tcp")
_OVERFLOW = 65534
"""The number of every user from outside of this program's user namespace (user_namespaces(7)); elsewhere, of nobody."""


def is_another_user(peer: tuple[str, int], here: tuple[str, int]) -> bool:
    """True if another user owns the end ``peer`` of the connection to ``here``; False if the owner is not known.

    The superuser does not count as another user, because root may do everything anyway.  The user who has started this
    program with sudo does not count either.
    """
    own = system.own_users()
    user = owner(peer, here) if own else None
    if user is None or (user == _OVERFLOW and not _sees_all_users()):
        return False
    return user not in own


def owner(peer: tuple[str, int], here: tuple[str, int], table: Path = TABLE) -> int | None:
    """The user id of the owner of the end ``peer``; None if the table does not exist or does not list it."""
    try:
        lines = table.read_text(encoding="ascii").splitlines()[1:]
    except (OSError, ValueError):
        return None
    wanted = [_entry(*peer), _entry(*here)]
    return next((int(fields[7]) for fields in map(str.split, lines) if fields[1:3] == wanted), None)


def _entry(address: str, port: int) -> str:
    """An end as the kernel writes it: the address as a number in this computer's byte order, then the port."""
    return f"{int.from_bytes(socket.inet_aton(address), sys.byteorder):08X}:{port:04X}"


def _sees_all_users(table: Path = Path("/proc/self/uid_map")) -> bool:
    """False in a user namespace, from where users outside of it are all one number."""
    try:
        return table.read_text(encoding="ascii").split() == ["0", "0", "4294967295"]
    except (OSError, ValueError):
        return True
