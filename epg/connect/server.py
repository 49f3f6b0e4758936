"""The page's server: HTTP on this computer alone, for whoever has the address.

Everything lies below a secret token, so that no other page and no other user of the computer gets anywhere; answers
are never stored; POST must say that it is JSON, which no form of another page can.

>>> # server = Server(session); print(server.address); server.run()
"""

from __future__ import annotations

import json
import secrets
import sys
import threading
import time
import traceback
from collections.abc import Callable, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, unquote, urlsplit

from epg.connect.session import Refused, Session

PAGE = Path(__file__).resolve().parent / "page"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
}
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}
LONGEST_WAIT = 20.0
"""Seconds that a request for the next state waits."""
MOST_BYTES = 1 << 20
CLOSED = 30.0
"""Seconds without a page after which it counts as closed; a page asks again at least every 20."""
NEVER_OPENED = 600.0


class Server:
    """Serves ``session`` on 127.0.0.1; ``port`` 0 takes any that is free."""

    def __init__(
        self, session: Session, port: int = 0, *, closed: float = CLOSED, opened: float = NEVER_OPENED
    ) -> None:
        self.session = session
        self.token = secrets.token_urlsafe(24)
        self._closed, self._until_opened = closed, opened
        self._http = _Http(("127.0.0.1", port), _Handler)
        self._http.owner = self
        self._waiting = 0
        self._last_seen: float | None = None
        self._started = time.monotonic()
        self._lock = threading.Lock()
        self.assets = {path.name: path for path in PAGE.iterdir() if path.suffix in TYPES}

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self._http.server_address[1]}/{self.token}/"

    def run(self, *, until_closed: bool = False) -> None:
        """Serves until the session ends, or, with ``until_closed``, until no page is open any more."""
        thread = threading.Thread(target=self._http.serve_forever, kwargs={"poll_interval": 0.1}, daemon=True)
        thread.start()
        try:
            while not self.session.ended.wait(0.25):
                if until_closed and self._is_abandoned():
                    break
        finally:
            self.session.ended.set()
            self.session.close()
            time.sleep(0.2)  # for the answer to whoever ended it
            self._http.shutdown()
            self._http.server_close()

    def state(self, after: int) -> dict[str, Any]:
        """The next state for a page, which is open as long as it asks."""
        with self._lock:
            self._waiting += 1
        try:
            return self.session.wait(after, LONGEST_WAIT)
        finally:
            with self._lock:
                self._waiting -= 1
                self._last_seen = time.monotonic()

    def _is_abandoned(self) -> bool:
        with self._lock:
            if self._waiting or self.session.is_building:
                return False
            if self._last_seen is None:
                return time.monotonic() - self._started > self._until_opened
            return time.monotonic() - self._last_seen > self._closed


class _Http(ThreadingHTTPServer):
    daemon_threads = True
    allow_reuse_address = sys.platform != "win32"  # where it would mean that others can take the port
    owner: Server

    def handle_error(self, request: object, client_address: object) -> None:
        """A browser that goes away in the middle of an answer is no error."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)  # type: ignore[arg-type]


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server_version = "epg"
    sys_version = ""
    timeout = 60
    server: _Http

    def do_GET(self) -> None:
        self._answer(self._get)

    def do_POST(self) -> None:
        self._answer(self._post)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """What is no request this server knows: methods other than GET and POST, lines that are no HTTP."""
        self.close_connection = True
        self._send(404 if code == 501 else code, "application/json", b"{}")

    def log_message(self, format: str, *arguments: object) -> None:
        """Says nothing: the terminal is for the user."""

    def _answer(self, respond: Callable[[str, Mapping[str, str]], None]) -> None:
        try:
            try:
                parts = urlsplit(self.path)
                token, _, path = unquote(parts.path, errors="strict")[1:].partition("/")
                query = {key: values[-1] for key, values in parse_qs(parts.query, errors="strict").items()}
            except ValueError:
                raise Refused("no such address", status=404) from None
            if not secrets.compare_digest(token.encode(), self.server.owner.token.encode()):
                raise Refused("no such address", status=404)
            respond(path, query)
        except Refused as problem:
            self.close_connection = True  # what is left of a body that nobody has read
            error = {"message": problem.message, "hint": problem.hint}
            self._send(problem.status, "application/json", json.dumps({"error": error}).encode())
        except ConnectionError:
            self.close_connection = True
        except Exception:
            traceback.print_exc()
            self.close_connection = True
            error = {"message": "this is a bug in EPG", "hint": "the terminal says more; please report it"}
            self._send(500, "application/json", json.dumps({"error": error}).encode())

    def _get(self, path: str, query: Mapping[str, str]) -> None:
        owner = self.server.owner
        if path == "api/state":
            self._json(owner.state(_integer(query, "after", 0)))
        elif path == "api/log":
            self._json(owner.session.log(_integer(query, "from", 0)))
        elif path == "api/source":
            self._json(owner.session.source(query.get("file", ""), _integer(query, "line", 1)))
        elif path.startswith("picture/") and path.endswith(".svg"):
            name = path.removeprefix("picture/").removesuffix(".svg")
            svg = owner.session.picture(name, query.get("configuration", ""))
            self._send(200, TYPES[".svg"], svg.encode())
        else:
            asset = owner.assets.get(path or "index.html")
            if asset is None:
                raise Refused("no such address", status=404)
            self._send(200, TYPES[asset.suffix], asset.read_bytes())

    def _post(self, path: str, query: Mapping[str, str]) -> None:
        if not path.startswith("api/"):
            raise Refused("no such address", status=404)
        if self.headers.get_content_type() != "application/json":
            raise Refused("a request must be application/json", status=415)
        if self.headers.get("Transfer-Encoding"):
            raise Refused("a request must say how long it is", status=411)
        length = self.headers.get("Content-Length", "")
        if not length.isascii() or not length.isdigit():
            raise Refused("a request must say how long it is", status=411)
        if int(length) > MOST_BYTES:
            raise Refused("a request is larger than 1 MB", status=413)
        try:
            body = json.loads(self.rfile.read(int(length)).decode("utf-8"))
        except (ValueError, RecursionError):
            raise Refused("a request must be JSON") from None
        if not isinstance(body, dict):
            raise Refused("a request must be an object")
        self._json(self.server.owner.session.act(path.removeprefix("api/"), body))

    def _json(self, data: object) -> None:
        self._send(200, "application/json", json.dumps(data).encode())

    def _send(self, status: int, kind: str, data: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(data)))
        for name, value in HEADERS.items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(data)


def _integer(query: Mapping[str, str], key: str, default: int) -> int:
    text = query.get(key, "")
    return int(text) if text.isascii() and text.isdigit() and len(text) < 10 else default
