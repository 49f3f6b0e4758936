# SPDX-License-Identifier: Apache-2.0
"""The page of ``epg connect`` without a browser: its requests to a running server."""

from __future__ import annotations

import http.client
import json
import threading
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urldefrag

from epg.connect.projects import find_jobs
from epg.connect.server import SECRET, Server
from epg.connect.session import Session
from epg.generator.diagnostics import Diagnostics
from tests.waiting import until

JSON = {"Content-Type": "application/json"}


class Denied(Exception):
    """An answer that is an error."""

    def __init__(self, status: int, error: dict[str, str]) -> None:
        super().__init__(f"{status} {error}")
        self.status, self.message, self.hint = status, error["message"], error["hint"]


class Page:
    """One page, opened by an unused address."""

    def __init__(self, address: str) -> None:
        self.site, token = urldefrag(address)
        self.secret = ""
        self.secret = json.loads(self._open("exchange", json.dumps({"token": token}).encode(), JSON)[0])["secret"]

    def get(self, path: str) -> tuple[bytes, http.client.HTTPMessage]:
        return self._open(path)

    def _open(
        self, path: str, data: bytes | None = None, headers: dict[str, str] | None = None
    ) -> tuple[bytes, http.client.HTTPMessage]:
        request = urllib.request.Request(self.site + path, data, {SECRET: self.secret, **(headers or {})})
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return answer.read(), answer.headers
        except urllib.error.HTTPError as problem:
            raise Denied(problem.code, json.loads(problem.read())["error"]) from None

    def json(self, path: str) -> Any:
        return json.loads(self.get(path)[0])

    def state(self, after: int = 0) -> dict[str, Any]:
        return self.json(f"api/state?after={after}")

    def until(self, wanted: Any, seconds: float = 60) -> dict[str, Any]:
        """The first state for which ``wanted`` is true; like the page, it asks for the next state each time."""
        state = self.state()

        def found() -> bool:
            nonlocal state
            if not wanted(state):
                state = self.state(state["version"])
            return bool(wanted(state))

        until(found, "the state never came", seconds, pause=0.0)
        return state

    def post(self, action: str, **body: object) -> dict[str, Any]:
        return json.loads(self._open(f"api/{action}", json.dumps(body).encode(), JSON)[0] or "{}")

    def generate(self) -> dict[str, Any]:
        """Generates, and agrees to run the listed commands."""
        state = self.post("generate")
        ask = state["build"]["ask"]
        return self.post("generate", run=ask["key"]) if ask is not None else state

    def connect(self, port: str, *references: str, **conversion: object) -> dict[str, Any]:
        return self.post("connect", port=port, ends=[{"reference": name, **conversion} for name in references])


@contextmanager
def serving(session: Session) -> Iterator[Page]:
    """A page of ``session`` on its own server."""
    with serving_pages(session) as open_page:
        yield open_page()


@contextmanager
def serving_pages(session: Session, port: int = 0) -> Iterator[Callable[[], Page]]:
    """Opens pages of ``session``, all on one server."""
    with serving_addresses(session, port) as new_address:
        yield lambda: Page(new_address())


@contextmanager
def serving_addresses(session: Session, port: int = 0) -> Iterator[Callable[[], str]]:
    """Addresses of ``session``, each of which opens one page."""
    server = Server(session, port)
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        yield server.new_address
    finally:
        session.ended.set()
        thread.join(20)
        assert not thread.is_alive()


def session_of(folder: Path) -> Session:
    """A session on the project in ``folder``."""
    diagnostics = Diagnostics()
    jobs = find_jobs(folder, diagnostics)
    assert jobs and not diagnostics.has_errors, list(diagnostics)
    return Session(jobs, folder=folder)
