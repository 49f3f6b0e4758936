# SPDX-License-Identifier: Apache-2.0
"""Who may use the page's server: one-time tokens in addresses, and the secrets that they are exchanged for.

An address can be read by other users of the computer: a browser is started with it on its command line.  Its token
therefore works once, and the page keeps the secret that it gets for the token out of every address.

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
    """All methods can be called by any thread.

    Digests are kept and compared: how long that takes says nothing about the text.
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
        """A new secret for ``token``, which is used up by that; None for any other text."""
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
