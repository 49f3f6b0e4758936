# SPDX-License-Identifier: Apache-2.0
"""Lines of the console that enable a target, as a person types them.

``enable`` is on a lease: the target stays enabled only while this program answers.  Without a lease, it stays enabled
when this program, the computer or the cable fails.  A person must therefore say so and confirm it.

>>> is_unattended("enable"), is_unattended(" enable  unattended "), is_unattended("get")
(False, True, None)
"""

from __future__ import annotations

from epg.live.client import Client, CommandRefused

CONFIRM = "the target stays enabled if this program, the computer or the cable fails"


def is_unattended(line: str) -> bool | None:
    """True if ``line`` enables without a lease, False if it enables on one, None for any other line.

    :raises Refused: it enables in another way
    """
    command, *words = line.split() or [""]
    if command != "enable":
        return None
    if words not in ([], ["leased"], ["unattended"]):
        raise CommandRefused("use 'enable' or 'enable unattended'")
    return words == ["unattended"]


def send(client: Client, line: str, after: str = "") -> list[str]:
    """Sends ``line``, which was confirmed if it must be; returns the answer.

    ``after`` is the number of the newest stop that the person knew when the line began.

    :raises Refused: the target refused it
    :raises Lost: there is no answer
    """
    unattended = is_unattended(line)
    return client.command(line) if unattended is None else client.enable(after, unattended=unattended)
