# SPDX-License-Identifier: Apache-2.0
"""Access to the page's server: a one-time token in an address, and the secret for which the page exchanges it.

Other users of the computer can read an address, because it is on the command line of the browser.  A token therefore
works only once.  The page gets a secret for it, and never puts the secret into an address.

A secret is valid until EPG ends.  The tabs of an EPG that has ended have no access to the next one, even if that has
the same folder and port.  To have it, a tab would keep a secret that is still valid, and EPG would take the port of its
last start.  Between the two starts, a program of another user can listen on that port.  If the user then reloads the
tab, the page of that program has the tab's origin.  It reads the secret that the tab keeps, and can install a service
worker, which answers in place of every later EPG on this port.  The requests of such a page come from the user's own
browser, so ``peer.py`` cannot refuse them.  A start without ``--port`` therefore takes any free port.

>>> keys = Keys()
>>> token = keys.new_token()
>>> keys.is_secret(keys.exchange(token) or "")
True
>>> keys.exchange(token)
"""

from __future__ import annotations

import hashlib
import secrets
import threading


class Keys:
    """The valid tokens and secrets.  All methods can be called by any thread.

    Only digests are kept and compared, so the time of a comparison reveals nothing about a token or a secret.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._tokens: set[bytes] = set()
        self._secrets: set[bytes] = set()

    def new_token(self) -> str:
        """A token that can be exchanged once."""
        token = secrets.token_urlsafe(24)
        with self._lock:
            self._tokens.add(_digest(token))
        return token

    def exchange(self, token: str) -> str | None:
        """A new secret for ``token``, which becomes invalid; None if ``token`` is not valid."""
        digest = _digest(token)
        with self._lock:
            if digest not in self._tokens:
                return None
            self._tokens.remove(digest)
            secret = secrets.token_urlsafe(24)
            self._secrets.add(_digest(secret))
            return secret

    def is_secret(self, text: str) -> bool:
        with self._lock:
            return _digest(text) in self._secrets


def _digest(text: str) -> bytes:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).digest()
