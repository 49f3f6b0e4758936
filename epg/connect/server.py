# SPDX-License-Identifier: Apache-2.0
"""The page's HTTP server.  It serves this computer only, and only pages that were opened with an address from it.

The static files of the page are public.  All data and actions need a secret in a header.  The page gets the secret
once, for the token in its address (``keys.py``).  The token is behind ``#``, so the browser does not send it by
itself.  The secret is not a cookie, because browsers send a cookie to every port of 127.0.0.1.

These requests are refused even with the secret: requests of other users of this computer (``peer.py``), of other pages
(``Origin``), and with a host name that is not this computer's (``Host``).

>>> # server = Server(session); print(server.new_address()); server.run()
"""

from __future__ import annotations

import base64
import contextlib
import hashlib
import itertools
import json
import shutil
import sys
import threading
import time
import traceback
from collections.abc import Callable, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, unquote, urlsplit

from epg.connect.body import boolean, number, text
from epg.connect.keys import Keys
from epg.connect.peer import is_another_user
from epg.connect.session import Refused, Session
from epg.generator.system import here
from epg.graph.svg import style_sheet

PAGE = Path(__file__).resolve().parent / "page"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
}
_PICTURES_STYLES = " ".join(
    f"'sha256-{base64.b64encode(hashlib.sha256(style_sheet(landscape=wide).encode()).digest()).decode()}'"
    for wide in (False, True)
)
"""The hashes of the pictures' style sheets.  The policy also holds for a picture that is opened alone."""
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; worker-src 'self'; "
    f"style-src 'self' {_PICTURES_STYLES}; img-src 'self' blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}
SECRET = "X-EPG-Secret"
"""The header that each request must have, except those for the static files of the page."""
NAMES = ("127.0.0.1", "localhost")
"""Names of this computer in ``Host``.  The port may differ from the server's: a tunnel may use another one."""
LONGEST_WAIT = 20.0
"""Seconds after which a request for the next state is answered even if the state has not changed."""
MOST_BYTES = 1 << 20
CLOSED = 30.0
"""Seconds without a request after which the page counts as closed.  An open page asks at least every 20 s."""
NEVER_OPENED = 600.0


class Server:
    """Serves ``session`` on 127.0.0.1; ``port`` 0 takes any free port."""

    def __init__(
        self,
        session: Session,
        port: int = 0,
        *,
        closed: float = CLOSED,
        opened: float = NEVER_OPENED,
        announce: Callable[[str], None] | None = None,
    ) -> None:
        """``announce`` is called at once with an address, and with a new address each time a page has used the last.

        ``closed`` and ``opened`` are the seconds after which :meth:`run` ends with ``until_closed``: without an open
        page, and if no page was opened at all.
        """
        self.session = session
        self.keys = Keys()
        self._closed, self._until_opened = closed, opened
        self._http = _Http(("127.0.0.1", port), _Handler)
        self._http.owner = self
        self._waiting = 0
        self._last_seen: float | None = None
        self._started = time.monotonic()
        self._lock = threading.Lock()
        found = (path for path in PAGE.rglob("*") if path.suffix in TYPES)
        self.assets = {path.relative_to(PAGE).as_posix(): path for path in found}
        self._announce = announce
        self._announced = ""
        if announce is not None:
            self._announce_next(announce)

    def new_address(self) -> str:
        """An address that opens one page."""
        return f"http://127.0.0.1:{self._http.server_address[1]}/#{self.keys.new_token()}"

    def exchange(self, token: str) -> str:
        """The secret for the token of an address.  Raises :class:`Refused` for a used or unknown token."""
        secret = self.keys.exchange(token)
        if secret is None:
            hint = "open the address that 'epg connect' printed last"
            raise Refused("each address of EPG opens one page, and this address was already used", hint, 401)
        if self._announce is not None and self._announced.endswith(f"#{token}"):
            self._announce_next(self._announce)
        return secret

    def _announce_next(self, announce: Callable[[str], None]) -> None:
        self._announced = self.new_address()
        announce(self._announced)

    def run(self, *, until_closed: bool = False) -> None:
        """Serves until the session ends; with ``until_closed``, also ends when no page is open any more."""
        thread = threading.Thread(target=self._http.serve_forever, kwargs={"poll_interval": 0.1}, daemon=True)
        thread.start()
        try:
            while not self.session.ended.wait(0.25):
                if until_closed and self._is_abandoned():
                    break
        finally:
            self.session.ended.set()
            self.session.live.disconnect()
            self.session.runs.close()
            time.sleep(0.2)  # the page that has ended the session must get its answer
            self._http.shutdown()
            self._http.server_close()

    def state(self, after: int) -> dict[str, Any]:
        """The next state after version ``after``.  A page counts as open while it calls this."""
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
            if self._waiting or self.session.runs.must_end:
                return False
            if self._last_seen is None:
                return time.monotonic() - self._started > self._until_opened
            return time.monotonic() - self._last_seen > self._closed


class _Http(ThreadingHTTPServer):
    daemon_threads = True
    allow_reuse_address = here.SHARES_PORTS
    owner: Server

    def handle_error(self, request: object, client_address: object) -> None:
        """Ignores a browser that closes the connection during an answer."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)  # type: ignore[arg-type]


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server_version = "epg"
    sys_version = ""
    timeout = 60
    server: _Http

    def setup(self) -> None:
        super().setup()
        self._is_foreign = is_another_user(self.client_address, self.request.getsockname())

    def do_GET(self) -> None:
        if "Content-Length" in self.headers or "Transfer-Encoding" in self.headers:
            self.close_connection = True  # the body is not read, and would be taken for the next request
        self._answer(self._get)

    def do_POST(self) -> None:
        self._answer(self._post)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Answers unknown requests: methods other than GET and POST, and text that is not HTTP."""
        self.close_connection = True
        self._send(404 if code == 501 else code, "application/json", b"{}")

    def log_message(self, format: str, *arguments: object) -> None:
        """Does nothing: the terminal is for the user, not for a log of requests."""

    def _answer(self, respond: Callable[[str, Mapping[str, str]], None]) -> None:
        try:
            try:
                self._check_sender()
                parts = urlsplit(self.path)
                path = unquote(parts.path, errors="strict").removeprefix("/")
                query = {key: values[-1] for key, values in parse_qs(parts.query, errors="strict").items()}
            except ValueError:
                raise Refused("there is no such address", status=404) from None
            respond(path, query)
        except Refused as problem:
            self.close_connection = True  # the rest of an unread body would be taken for the next request
            error = {"message": problem.message, "hint": problem.hint}
            self._send(problem.status, "application/json", json.dumps({"error": error}).encode())
        except ConnectionError:
            self.close_connection = True
        except Exception:
            traceback.print_exc()
            self.close_connection = True
            error = {"message": "this is a bug in EPG", "hint": "the terminal shows the details; please report them"}
            self._send(500, "application/json", json.dumps({"error": error}).encode())

    def _check_sender(self) -> None:
        """Raises Refused for a request that cannot come from the page, even if it has the secret."""
        if self._is_foreign:
            raise Refused("this page belongs to another user of the computer", status=403)
        hosts = self.headers.get_all("Host", [])
        name, _, port = hosts[0].partition(":") if len(hosts) == 1 else ("", "", "")
        if name not in NAMES or not (port or "0").isdecimal():
            raise Refused("a request must name 127.0.0.1 or localhost as its host", status=403)
        if any(origin != f"http://{hosts[0]}" for origin in self.headers.get_all("Origin", [])):
            raise Refused("the request is from another page", status=403)

    def _check_secret(self) -> None:
        given = self.headers.get_all(SECRET, [])
        if len(given) != 1 or not self.server.owner.keys.is_secret(given[0]):
            raise Refused("EPG does not know this page", "open the address that 'epg connect' printed last", 401)

    def _get(self, path: str, query: Mapping[str, str]) -> None:
        owner = self.server.owner
        asset = owner.assets.get(path or "index.html")
        if asset is not None:
            self._send(200, TYPES[asset.suffix], asset.read_bytes())
            return
        self._check_secret()
        if path == "api/state":
            self._json(owner.state(_integer(query, "after", 0)))
        elif path == "api/log":
            lines = owner.session.runs.lines(query.get("of", "build"), _integer(query, "from", 0))
            self._json({"lines": lines})
        elif path == "api/product":
            self._send(200, "application/octet-stream", owner.session.runs.download(query.get("path", "")))
        elif path == "api/move":
            self._json(owner.session.move(query.get("configuration", "")))
        elif path == "api/live/events":
            self._events(query.get("page", ""))
        elif path == "api/live/capture":
            self._json(owner.session.live.recorded())
        elif path == "api/live/comparison":
            self._json(owner.session.runs.compared)
        elif path == "api/live/save":
            with owner.session.live.save(query.get("what", ""), query.get("as", "")) as file:
                self._send_file(file)
        elif path == "api/source":
            self._json(owner.session.source(query.get("file", ""), _integer(query, "line", 1)))
        elif path == "api/pins":
            self._json(owner.session.pin_options(query.get("component", ""), query.get("signal", "")))
        elif path.startswith("picture/") and path.endswith(".svg"):
            name = path.removeprefix("picture/").removesuffix(".svg")
            self._send(200, TYPES[".svg"], self._picture(name, query).encode())
        else:
            raise Refused("there is no such address", status=404)

    def _picture(self, name: str, query: Mapping[str, str]) -> str:
        session = self.server.owner.session
        if name == "pinout":
            return session.pinout(query.get("component", ""), query.get("signal", ""))
        return session.picture(name, query.get("configuration", ""))

    def _post(self, path: str, query: Mapping[str, str]) -> None:
        if path != "exchange":
            self._check_secret()
            if not path.startswith("api/"):
                raise Refused("there is no such address", status=404)
        body = self._body()
        if path == "exchange":
            self._json({"secret": self.server.owner.exchange(text(body, "token"))})
        elif path == "api/live/respond":
            live = self.server.owner.session.live
            live.respond(text(body, "page"), int(number(body, "number")))
            self._send(204, "application/json", b"")  # Firefox reads the body of an answer in the page's thread
        elif path.startswith("api/live/"):
            self._json(self._live(path.removeprefix("api/live/"), body))
        else:
            self._json(self.server.owner.session.act(path.removeprefix("api/"), body))

    def _live(self, action: str, body: Mapping[str, object]) -> dict[str, Any]:
        """Actions on a running target.  They wait neither for the session's actions nor for each other."""
        session = self.server.owner.session
        live = session.live
        if action == "stop":
            live.stop()
        elif action == "move":
            newest = int(number(body, "number", 0))
            live.move(text(body, "page"), text(body, "actuator"), number(body, "duty"), newest)
        elif action == "enable":
            live.enable(text(body, "page"), text(body, "after", ""))
        elif action == "command":
            agreed = boolean(body, "unattended")
            line = text({"line": text(body, "line").strip()}, "line")
            return {"answer": live.command(text(body, "page", ""), line, text(body, "after", ""), unattended=agreed)}
        elif action == "look":
            live.look()
        elif action == "durations":
            return {"durations": live.durations()}
        elif action == "connect":
            session.go_live(body)
        elif action == "disconnect":
            live.disconnect()
        else:
            raise Refused(f"there is no action '{action}'", status=404)
        return {}

    def _events(self, page: str) -> None:
        """Sends the events of a running target, one JSON object per line, until the connection with it ends."""
        events = self.server.owner.session.live.events(page)
        first = next(events)
        self.close_connection = True
        self.send_response(200)
        for name, value in HEADERS.items():
            self.send_header(name, value)
        self.send_header("Content-Type", "application/x-ndjson")
        self.send_header("Connection", "close")
        self.end_headers()
        with contextlib.suppress(TimeoutError):  # the page has not read for a minute
            for event in itertools.chain((first,), events):
                self.wfile.write(json.dumps(event, allow_nan=False).encode() + b"\n")

    def _body(self) -> dict[str, object]:
        """The JSON object of a request.  Forms of other pages cannot send JSON, so they are refused here."""
        if self.headers.get_content_type() != "application/json":
            raise Refused("a request must be application/json", status=415)
        lengths = self.headers.get_all("Content-Length", [])
        length = lengths[0].strip() if len(lengths) == 1 else ""
        if self.headers.get("Transfer-Encoding") or not length.isascii() or not length.isdigit():
            raise Refused("a request must say how long it is", status=411)
        length = length.lstrip("0") or "0"
        if len(length) > len(str(MOST_BYTES)) or int(length) > MOST_BYTES:
            raise Refused("a request is larger than 1 MB", status=413)
        try:
            body = json.loads(self.rfile.read(int(length)).decode("utf-8"))
        except (ValueError, RecursionError):
            raise Refused("a request must be JSON") from None
        if not isinstance(body, dict):
            raise Refused("a request must be an object")
        return body

    def _json(self, data: object) -> None:
        self._send(200, "application/json", json.dumps(data).encode())

    def _send(self, status: int, kind: str, data: bytes) -> None:
        self._send_head(status, kind, len(data))
        self.wfile.write(data)

    def _send_file(self, path: Path) -> None:
        """Sends a file that can be large."""
        with path.open("rb") as file:
            self._send_head(200, "application/octet-stream", path.stat().st_size)
            shutil.copyfileobj(file, self.wfile)

    def _send_head(self, status: int, kind: str, size: int) -> None:
        self.send_response(status)
        if status != 204:
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(size))
        for name, value in HEADERS.items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()


def _integer(query: Mapping[str, str], key: str, default: int) -> int:
    text = query.get(key, "")
    return int(text) if text.isascii() and text.isdigit() and len(text) < 10 else default
