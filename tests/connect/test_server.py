"""The server of the page: who gets in, what is answered, and how it ends."""

from __future__ import annotations

import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from epg.cli.main import main
from epg.connect.server import HEADERS, Server
from epg.connect.session import Session
from tests.connect.page import Denied, Page, serving, session_of

ROOT = Path(__file__).resolve().parent.parent.parent
CTRL_C = signal.CTRL_C_EVENT if sys.platform == "win32" else signal.SIGINT


def ask(page: Page, method: str, path: str, body: bytes = b"", **headers: str) -> tuple[int, dict[str, str], bytes]:
    """A request as no browser would make it: nothing about ``path`` is tidied up."""
    connection = http.client.HTTPConnection("127.0.0.1", urlsplit(page.address).port, timeout=30)
    connection.putrequest(method, path, skip_accept_encoding=True)
    for name, value in {"Content_Length": str(len(body)), **headers}.items():
        connection.putheader(name.replace("_", "-"), value)
    connection.endheaders(body)
    answer = connection.getresponse()
    data = answer.read()
    connection.close()
    return answer.status, dict(answer.getheaders()), data


def token(page: Page) -> str:
    return urlsplit(page.address).path.strip("/")


def test_nothing_is_answered_without_the_token(page: Page, bindings: Path) -> None:
    good = token(page)
    assert len(good) >= 32
    wrong = good[:-1] + ("A" if good[-1] != "A" else "B")
    for path in (
        "",
        "/",
        "/api/state",
        f"/{wrong}/",
        f"/{wrong}/api/state",
        f"/{good}x/",
        "/%00/",
        "/%ff/",
    ):
        status, _, data = ask(page, "GET", path or "/")
        assert status == 404 and good not in data.decode(), path
    body = json.dumps({"port": "position_pan"}).encode()
    for path in ("/api/disconnect", f"/{wrong}/api/disconnect"):
        assert ask(page, "POST", path, body, Content_Type="application/json")[0] == 404
    assert "position_pan" in page.state()["wires"]


def test_tokens_differ(project: Path) -> None:
    session = session_of(project)
    servers = [Server(session), Server(session)]
    assert servers[0].token != servers[1].token
    for server in servers:
        server._http.server_close()


def test_only_this_computer_is_served(page: Page) -> None:
    port = urlsplit(page.address).port
    assert urlsplit(page.address).hostname == "127.0.0.1" and port
    for address in ("127.0.0.2", "::1"):
        family = socket.AF_INET6 if ":" in address else socket.AF_INET
        with socket.socket(family) as other, pytest.raises(OSError):
            other.settimeout(2)
            other.connect((address, port))


def test_every_answer_says_what_browsers_may_do(page: Page) -> None:
    for path in ("/", f"/{token(page)}/", f"/{token(page)}/api/state", f"/{token(page)}/picture/wiring.svg"):
        _, headers, _ = ask(page, "GET", path)
        assert {name: headers[name] for name in HEADERS} == HEADERS, path
    policy = HEADERS["Content-Security-Policy"]
    assert policy.startswith(
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'"
    )
    assert "unsafe" not in policy and "http" not in policy
    assert HEADERS["Cache-Control"] == "no-store"


def test_only_files_of_the_page_are_given_out(page: Page) -> None:
    good = token(page)
    assert b"<html" in page.get("")[0]
    for path in (
        "../server.py",
        "..%2fserver.py",
        "%2e%2e/server.py",
        "./index.html",
        "/etc/passwd",
        "%2fetc%2fpasswd",
        "..\\server.py",
        "index.html%00",
        "page/index.html",
        "robot.tcf",
    ):
        assert ask(page, "GET", f"/{good}/{path}")[0] == 404, path


def test_every_file_of_the_page_is_there(page: Page) -> None:
    for path in (ROOT / "epg/connect/page").iterdir():
        data, headers = page.get(path.name)
        assert data == path.read_bytes()
        assert headers["Content-Type"].split("/")[0] in ("text", "image")


def test_requests_must_be_json_of_the_page_itself(page: Page) -> None:
    """What forms of other pages can send is refused: they cannot say that it is JSON without asking first."""
    body = json.dumps({"port": "position_pan"}).encode()
    path = f"/{token(page)}/api/disconnect"
    for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x", ""):
        assert ask(page, "POST", path, body, Content_Type=kind)[0] == 415, kind
    assert ask(page, "GET", path)[0] == 404
    for method in ("PUT", "DELETE", "OPTIONS", "HEAD", "PATCH"):
        assert ask(page, method, path, body, Content_Type="application/json")[0] == 404, method
    for wrong in (b"", b"{", b"[]", b'"text"', b"\xff", b"[" * 100_000):
        assert ask(page, "POST", path, wrong, Content_Type="application/json")[0] == 400, wrong[:10]
    assert ask(page, "POST", path, Content_Type="application/json", Content_Length="1048577")[0] == 413
    assert ask(page, "POST", path, Content_Type="application/json", Content_Length="-1")[0] == 411
    assert ask(page, "POST", path, Content_Type="application/json", Content_Length="x")[0] == 411
    assert ask(page, "POST", path, Content_Type="application/json", Transfer_Encoding="chunked")[0] == 411
    with pytest.raises(Denied) as refusal:
        page.post("no_such_action")
    assert refusal.value.status == 404
    assert "position_pan" in page.state()["wires"]


def test_sources_of_messages_only(page: Page, project: Path, bindings: Path) -> None:
    (project / "secret").write_text("secret")
    state = page.connect("pwm_pan", "nothing")
    (message,) = [each for each in state["diagnostics"] if each["port"] == "pwm_pan"]
    source = page.json(f"api/source?file={message['file'].replace(' ', '%20')}&line={message['line']}")
    assert "pwm_pan: nothing" in source["lines"][source["line"] - source["first"]], "as the draft says"
    assert len(source["lines"]) <= 21
    for file in (str(project / "secret"), "/etc/passwd", "", "../secret"):
        with pytest.raises(Denied) as refusal:
            page.json(f"api/source?file={file.replace(' ', '%20')}&line=1")
        assert refusal.value.status == 404


def test_pictures_are_drawn_when_asked_for(page: Page) -> None:
    for name in ("application", "schedule", "wiring"):
        svg, headers = page.get(f"picture/{name}.svg?version=3")
        assert svg.startswith(b"<svg") and headers["Content-Type"] == "image/svg+xml"
    before = page.get("picture/application.svg")[0]
    page.connect("setpoint_pan", "tilt_subscriber", scale=7)
    assert page.get("picture/application.svg")[0] != before
    page.connect("pwm_pan", "encoder_pan")
    with pytest.raises(Denied, match="no such picture") as refusal:
        page.get("picture/application.svg")
    assert refusal.value.status == 404
    for name in ("nothing", "../wiring"):
        with pytest.raises(Denied):
            page.get(f"picture/{name}.svg")


def test_a_page_waits_for_the_next_state(page: Page) -> None:
    version = page.until(lambda state: state["configurations"])["version"]
    assert page.state(version - 1)["version"] == version
    begin = time.monotonic()
    later = threading.Timer(0.7, lambda: Page(page.address).connect("setpoint_pan", "tilt_subscriber"))
    later.start()
    assert page.state(version)["version"] > version
    assert 0.5 < time.monotonic() - begin < 10
    later.join()


class Broken(Session):
    """A session with a mistake in EPG: what the server does then."""

    def log(self, start: int) -> dict[str, object]:
        raise ZeroDivisionError("a mistake")


def test_a_bug_ends_one_request_only(project: Path, capfd: pytest.CaptureFixture[str]) -> None:
    from epg.connect.projects import find_jobs
    from epg.diagnostics import Diagnostics

    with serving(Broken(find_jobs(project, Diagnostics()))) as page:
        with pytest.raises(Denied, match="a bug in EPG") as refusal:
            page.json("api/log?from=0")
        assert refusal.value.status == 500
        assert page.state()["phase"] == "connect"
    said = capfd.readouterr().err
    assert "ZeroDivisionError: a mistake" in said and "Traceback" in said


# the whole program


@contextmanager
def program(*arguments: str, folder: Path | None = None) -> Iterator[tuple[subprocess.Popen[str], Page]]:
    command = [sys.executable, str(ROOT / "epg"), "connect", "--no-browser", *arguments]
    flags = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP} if sys.platform == "win32" else {}
    started = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **flags)
    try:
        assert started.stdout is not None
        first = started.stdout.readline()
        assert first.startswith("epg connect: http://127.0.0.1:"), started.communicate()
        assert "Ctrl-C" in started.stdout.readline()
        yield started, Page(first.split()[-1])
    finally:
        started.kill()
        started.communicate()


def test_done_ends_the_program(project: Path) -> None:
    with program(folder=project) as (process, page):
        assert page.state()["project"]["name"] == "robot"
        page.post("done")
        out, err = process.communicate(timeout=20)
        assert (process.returncode, out, err) == (0, "", "")


@pytest.mark.parametrize("name", ["SIGINT"] if sys.platform == "win32" else ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_ends_the_program(name: str, project: Path) -> None:
    with program(str(project)) as (process, page):
        version = page.until(lambda state: state["configurations"])["version"]
        with socket.create_connection(("127.0.0.1", urlsplit(page.address).port or 0)) as waiting:
            path = f"{urlsplit(page.address).path}api/state?after={version}"
            waiting.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
            time.sleep(0.3)
            process.send_signal(CTRL_C if name == "SIGINT" else getattr(signal, name))
            out, err = process.communicate(timeout=20)
            assert process.returncode == 0 and err == "" and "Traceback" not in out


def test_files_of_one_target_can_be_named(project: Path) -> None:
    """As CMake and 20-sim start it: from elsewhere, with relative names."""
    names = ["--tcf", "robot.tcf", "--model", "model", "--bindings", "robot.bindings.yaml", "--name", "other"]
    with program(*names, "--source-dir", ".", folder=project) as (_, page):
        state = page.state()
        assert state["project"]["name"] == "other" and state["project"]["folder"] == str(project)
        assert state["diagnostics"] == []


def test_a_model_without_a_project(tmp_path: Path) -> None:
    import shutil

    model = shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / "export")
    with program(str(model)) as (_, page):
        assert page.state()["phase"] == "choose"


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (["nowhere"], 1, "model-not-found"),
        (["empty"], 1, "model-not-recognised"),
        (["--tcf", "host_jiwy.tcf"], 2, "give --tcf, --model and --bindings"),
        (["--port", "70000", "empty"], 2, "--port"),
        (["--name", "rbot", "robot"], 1, "did you mean 'robot'?"),
    ],
)
def test_what_cannot_be_connected_is_said(
    arguments: list[str],
    status: int,
    words: str,
    project: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    project.rename(tmp_path / "robot")
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path)
    assert main(["connect", "--no-browser", *arguments]) == status
    assert words in capsys.readouterr().err


def test_a_port_that_is_taken_is_said(project: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        command = [sys.executable, str(ROOT / "epg"), "connect", str(project), "--no-browser", "--port"]
        done = subprocess.run([*command, str(taken.getsockname()[1])], capture_output=True, text=True, timeout=60)
    assert done.returncode == 4 and "Traceback" not in done.stderr and "in use" in done.stderr


def test_it_ends_when_no_page_is_open_any_more(project: Path) -> None:
    session = session_of(project)
    server = Server(session, closed=1.0, opened=60)
    thread = threading.Thread(target=lambda: server.run(until_closed=True))
    thread.start()
    time.sleep(1.5)
    assert thread.is_alive(), "the page has not been opened yet"
    page = Page(server.address)
    version = page.until(lambda state: state["configurations"])["version"]
    threading.Timer(2.5, lambda: Page(server.address).post("disconnect", port="pwm_pan")).start()
    page.state(version)
    assert thread.is_alive(), "a page that waits is open"
    thread.join(10)
    assert not thread.is_alive() and session.ended.is_set()


def test_it_ends_when_no_page_was_ever_opened(project: Path) -> None:
    server = Server(session_of(project), closed=60, opened=0.5)
    begin = time.monotonic()
    server.run(until_closed=True)
    assert time.monotonic() - begin < 10


@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="EPG: other systems always have a browser; run on Linux"
)
def test_a_browser_is_opened_where_there_is_one(project: Path, tmp_path: Path) -> None:
    said = tmp_path / "said"
    browser = tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$1" >> "{said}"\n')
    browser.chmod(0o755)
    plain = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")}
    for environment, opens in ((plain, False), (plain | {"BROWSER": f"{browser} %s"}, True)):
        command = [sys.executable, str(ROOT / "epg"), "connect", str(project)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
        assert process.stdout is not None
        address = process.stdout.readline().split()[-1]
        end = time.monotonic() + (10 if opens else 1)
        while not said.exists() and time.monotonic() < end:
            time.sleep(0.05)
        Page(address).post("done")
        process.communicate(timeout=20)
        assert said.exists() == opens
    assert said.read_text() == f"{address}\n"


def test_other_commands_load_nothing_of_it() -> None:
    """CMake starts ``epg generate`` again and again: it must not pay for a page."""
    jiwy = ROOT / "examples/jiwy"
    arguments = ["check", "--tcf", "host_jiwy.tcf", "--model", str(jiwy / "model")]
    arguments += ["--bindings", str(jiwy / "jiwy.bindings.yaml")]
    lines = [f"import sys; sys.path.insert(0, {str(ROOT)!r})", "from epg.cli.main import main"]
    lines += [f"status = main({arguments!r})", "print(status, *sorted(sys.modules))"]
    done = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, timeout=60)
    status, *modules = done.stdout.splitlines()[-1].split()
    assert status == "0" and "epg.project" in modules
    unwanted = ("epg.connect", "epg.edit.bindings", "epg.edit.tcf", "epg.new_project", "http", "socket")
    assert not [name for name in modules if name.startswith(unwanted)]
