# SPDX-License-Identifier: Apache-2.0
"""The server of the page: access, answers, and its end."""

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
from epg.connect.keys import Keys
from epg.connect.peer import owner
from epg.connect.server import HEADERS, Server
from epg.connect.session import Session
from tests.connect.page import Denied, Page, serving, serving_pages, session_of
from tests.waiting import until

ROOT = Path(__file__).resolve().parent.parent.parent
CTRL_C = signal.CTRL_C_EVENT if sys.platform == "win32" else signal.SIGINT


def ask(
    page: Page, method: str, path: str, body: bytes = b"", skip: tuple[str, ...] = (), **headers: str
) -> tuple[int, dict[str, str], bytes]:
    """A request that no browser would send: ``path`` is not normalised, and headers in ``skip`` are missing."""
    port = urlsplit(page.site).port
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
    connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
    usual = {"Host": f"127.0.0.1:{port}", "Content_Length": str(len(body)), "X_EPG_Secret": page.secret}
    for name, value in {**usual, **headers}.items():
        if name not in skip:
            connection.putheader(name.replace("_", "-"), value)
    connection.endheaders(body)
    answer = connection.getresponse()
    data = answer.read()
    connection.close()
    return answer.status, dict(answer.getheaders()), data


EXCHANGE = {"Content_Type": "application/json", "skip": ("X_EPG_Secret",)}
DISCONNECT = json.dumps({"port": "position_pan"}).encode()


def test_nothing_is_answered_without_the_secret(page: Page) -> None:
    good = page.secret
    assert len(good) >= 32
    wrong = good[:-1] + ("A" if good[-1] != "A" else "B")
    for path in ("/api/state", "/api/log", "/api/source", "/picture/wiring.svg", "/nothing", "/%00/", "/server.py"):
        for secret in (wrong, good + "x", "", "\xff", good.upper()):
            status, _, data = ask(page, "GET", path, X_EPG_Secret=secret)
            assert status == 401 and good not in data.decode(), path
        assert ask(page, "GET", path, skip=("X_EPG_Secret",))[0] == 401
    for cookie in (f"X-EPG-Secret={good}", f"epg-secret={good}"):
        assert ask(page, "GET", "/api/state", skip=("X_EPG_Secret",), Cookie=cookie)[0] == 401
    for path in (f"/api/state?secret={good}", f"/{good}/api/state"):
        assert ask(page, "GET", path, skip=("X_EPG_Secret",))[0] == 401
    assert ask(page, "POST", "/api/disconnect", DISCONNECT, **EXCHANGE)[0] == 401
    assert "position_pan" in page.state()["wires"]


def test_an_address_opens_one_page(project: Path) -> None:
    said: list[str] = []
    server = Server(session_of(project), announce=said.append)
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        first, other = Page(said[0]), server.new_address()
        assert len(said) == 2, "the next page's address is said as soon as the last one is used"
        for used in (said[0], said[0] + "x", said[0].partition("#")[0], said[0].partition("#")[0] + "#"):
            with pytest.raises(Denied) as refusal:
                Page(used)
            assert refusal.value.status in (400, 401)
        second = Page(other)
        assert len(said) == 2, "the address of the browser that EPG starts is not the one that was printed"
        third = Page(said[1])
        assert len(said) == 3 and len({first.secret, second.secret, third.secret}) == 3
        for page in (first, second, third):
            assert page.state()["phase"] == "connect"
            token = urlsplit(said[0]).fragment
            assert page.secret not in "".join(said) and ask(page, "GET", "/api/state", X_EPG_Secret=token)[0] == 401
    finally:
        server.session.ended.set()
        thread.join(20)


def test_a_secret_ends_with_its_server(project: Path) -> None:
    """Also for the same folder and the same port: ``keys.py`` gives the reason."""
    with serving_pages(session_of(project)) as open_page:
        page = open_page()
        assert page.state()["project"]["name"] == "robot"
    with serving_pages(session_of(project), urlsplit(page.site).port or 0) as open_page:
        with pytest.raises(Denied) as denied:
            page.state()
        assert denied.value.status == 401
        assert open_page().state()["project"]["name"] == "robot"


def test_of_two_at_once_one_gets_in() -> None:
    keys = Keys()
    token = keys.new_token()
    got: list[str | None] = []
    threads = [threading.Thread(target=lambda: got.append(keys.exchange(token))) for _ in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len([secret for secret in got if secret]) == 1


def test_only_this_computers_names_are_answered(page: Page) -> None:
    """A foreign page can make its own name resolve to 127.0.0.1 (DNS rebinding)."""
    port = urlsplit(page.site).port
    for host in (
        "example.org",
        f"example.org:{port}",
        "127.0.0.1.example.org",
        "",
        "localhost:x",
        "127.0.0.2",
        "[::1]",
    ):
        for path in ("/", "/main.js", "/api/state"):
            assert ask(page, "GET", path, Host=host)[0] == 403, host
    assert ask(page, "GET", "/api/state", skip=("Host",))[0] == 403
    # As through a tunnel that starts at another port.
    for host in ("127.0.0.1:9999", f"localhost:{port}", "localhost"):
        assert ask(page, "GET", "/api/state", Host=host, Origin=f"http://{host}")[0] == 200, host


def test_requests_of_other_pages_are_refused(page: Page) -> None:
    """Also of pages on another port of this computer."""
    port = urlsplit(page.site).port
    for origin in (
        "http://127.0.0.1",
        "http://127.0.0.1:1",
        f"http://localhost:{port}",
        "null",
        "",
        "http://example.org",
    ):
        for path in ("/", "/api/state", "/picture/wiring.svg"):
            assert ask(page, "GET", path, Origin=origin)[0] == 403, origin
        post = {"Content_Type": "application/json", "Origin": origin}
        assert ask(page, "POST", "/api/disconnect", DISCONNECT, **post)[0] == 403
        assert ask(page, "POST", "/exchange", b'{"token": ""}', **post)[0] == 403
    assert ask(page, "GET", "/api/state", Origin=f"http://127.0.0.1:{port}")[0] == 200
    assert "position_pan" in page.state()["wires"]


@pytest.mark.skipif(
    not sys.platform.startswith("linux") or os.geteuid() != 0, reason="EPG: being another user needs Linux and root"
)
def test_other_users_are_refused_whatever_they_know(page: Page) -> None:
    """They may have read the address on a browser's command line and use it first."""
    script = (
        "import os, socket, sys\n"
        "os.setgid(4321); os.setuid(int(sys.argv[3]))\n"
        "server = socket.socket(); server.connect(('127.0.0.1', int(sys.argv[1])))\n"
        "server.sendall(sys.argv[2].encode()); print(server.recv(9999).decode('ascii', 'replace'))\n"
    )
    port = urlsplit(page.site).port
    whole = Path("/proc/self/uid_map").read_text(encoding="ascii").split() == ["0", "0", "4294967295"]
    for path in ("/", "/api/state"):
        request = f"GET {path} HTTP/1.0\r\nHost: 127.0.0.1\r\nX-EPG-Secret: {page.secret}\r\n\r\n"
        nobody = " 403 " if whole else " 200 "  # in a user namespace, that is also the number of users outside of it
        for user, status in (("0", " 200 "), ("4321", " 403 "), ("65534", nobody)):
            command = [sys.executable, "-c", script, str(port), request, user]
            said = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
            assert status in said.splitlines()[0], said


def test_the_owner_of_a_connection_is_read_from_the_kernels_table(tmp_path: Path) -> None:
    table = tmp_path / "tcp"
    here, peer = ("127.0.0.1", 8123), ("127.0.0.1", 40000)
    entry = f"{int.from_bytes(socket.inet_aton('127.0.0.1'), sys.byteorder):08X}"
    rest = "00000000:00000000 00:00000000 00000000"
    table.write_text(
        "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode\n"
        f"   0: {entry}:1FBB {entry}:9C40 01 {rest}  1000        0 11 1\n"
        f"   1: {entry}:9C40 {entry}:1FBB 01 {rest}  1001        0 12 1\n",
        encoding="ascii",
    )
    assert owner(peer, here, table) == 1001 and owner(here, peer, table) == 1000
    assert owner(("127.0.0.1", 40001), here, table) is None
    assert owner(peer, here, tmp_path / "none") is None


def test_only_this_computer_is_served(page: Page) -> None:
    port = urlsplit(page.site).port
    assert urlsplit(page.site).hostname == "127.0.0.1" and port
    for address in ("127.0.0.2", "::1"):
        family = socket.AF_INET6 if ":" in address else socket.AF_INET
        with socket.socket(family) as other, pytest.raises(OSError):
            other.settimeout(2)
            other.connect((address, port))


def test_every_answer_says_what_browsers_may_do(page: Page) -> None:
    for path in ("/", "/nothing", "/main.js", "/api/state", "/picture/wiring.svg"):
        _, headers, _ = ask(page, "GET", path)
        assert {name: headers[name] for name in HEADERS} == HEADERS, path
    policy = HEADERS["Content-Security-Policy"]
    assert policy.startswith("default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self' 'sha256-")
    assert "img-src 'self' blob:; connect-src 'self'; base-uri 'none'" in policy
    assert "unsafe" not in policy and "http" not in policy
    assert HEADERS["Cache-Control"] == "no-store"


def test_only_files_of_the_page_are_given_out(page: Page) -> None:
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
        assert ask(page, "GET", f"/{path}")[0] == 404, path


def test_every_file_of_the_page_is_there(page: Page) -> None:
    folder = ROOT / "epg/connect/page"
    for path in filter(Path.is_file, folder.rglob("*")):
        if path.name.endswith((".d.ts", ".md", ".LICENSE")):  # for compilers and developers
            continue
        data, headers = page.get(path.relative_to(folder).as_posix())
        assert data == path.read_bytes()
        assert headers["Content-Type"].split("/")[0] in ("text", "image")


def test_requests_must_be_json_of_the_page_itself(page: Page) -> None:
    """HTML forms are refused.  Before a script of another page can send JSON, the browser asks the server."""
    body = json.dumps({"port": "position_pan"}).encode()
    path = "/api/disconnect"
    for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x", ""):
        assert ask(page, "POST", path, body, Content_Type=kind)[0] == 415, kind
    assert ask(page, "GET", path)[0] == 404
    for method in ("PUT", "DELETE", "OPTIONS", "HEAD", "PATCH"):
        assert ask(page, method, path, body, Content_Type="application/json")[0] == 404, method
    for wrong in (b"", b"{", b"[]", b'"text"', b"\xff", b"[" * 100_000):
        assert ask(page, "POST", path, wrong, Content_Type="application/json")[0] == 400, wrong[:10]
    lengths = {"1048577": 413, "9" * 5000: 413, "0" * 5000 + "9" * 5000: 413, "1" + "0" * 5000: 413}
    lengths |= dict.fromkeys(("-1", "+1", "x", "", "1_0", "²", "1.0", "0x10", "1, 1"), 411)
    for length, status in lengths.items():
        for target in (path, "/exchange"):
            answered = ask(page, "POST", target, Content_Type="application/json", Content_Length=length)
            assert answered[0] == status, length[:10]
    assert ask(page, "POST", path, Content_Type="application/json", Content_Length="0" * 5000)[0] == 400
    assert ask(page, "POST", path, Content_Type="application/json", skip=("Content_Length",))[0] == 411
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
    later = threading.Timer(0.7, lambda: page.connect("setpoint_pan", "tilt_subscriber"))
    later.start()
    assert page.state(version)["version"] > version
    later.join()


class Broken(Session):
    """A session with a bug in EPG, to test the server's reaction."""

    def source(self, file: str, line: int) -> dict[str, object]:
        raise ZeroDivisionError("a mistake")


def test_a_bug_ends_one_request_only(project: Path, capfd: pytest.CaptureFixture[str]) -> None:
    from epg.connect.projects import find_jobs
    from epg.generator.diagnostics import Diagnostics

    with serving(Broken(find_jobs(project, Diagnostics()))) as page:
        with pytest.raises(Denied, match="a bug in EPG") as refusal:
            page.json("api/source?file=any")
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
        assert (process.returncode, err) == (0, "")
        assert out.startswith("epg connect: for another page: http://127.0.0.1:") and out.count("\n") == 1


@pytest.mark.parametrize("name", ["SIGINT"] if sys.platform == "win32" else ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_ends_the_program(name: str, project: Path) -> None:
    with program(str(project)) as (process, page):
        version = page.until(lambda state: state["configurations"])["version"]
        with socket.create_connection(("127.0.0.1", urlsplit(page.site).port or 0)) as waiting:
            headers = f"Host: 127.0.0.1\r\nX-EPG-Secret: {page.secret}\r\n"
            waiting.sendall(f"GET /api/state?after={version} HTTP/1.1\r\n{headers}\r\n".encode())
            page.state()  # a later request was answered: that one waits
            process.send_signal(CTRL_C if name == "SIGINT" else getattr(signal, name))
            out, err = process.communicate(timeout=20)
            assert process.returncode == 0 and err == "" and "Traceback" not in out


def test_files_of_one_target_can_be_named(project: Path) -> None:
    """CMake and 20-sim start it so: from another folder, with relative names."""
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
    time.sleep(1.5)  # longer than the limit for closed pages
    assert thread.is_alive(), "the page has not been opened yet"
    page = Page(server.new_address())
    version = page.until(lambda state: state["configurations"])["version"]
    threading.Timer(2.5, lambda: page.post("disconnect", port="pwm_pan")).start()
    page.state(version)
    assert thread.is_alive(), "a page that waits is open"
    thread.join(10)
    assert not thread.is_alive() and session.ended.is_set()


def test_it_ends_when_no_page_was_ever_opened(project: Path) -> None:
    server = Server(session_of(project), closed=3600, opened=0.5)
    server.run(until_closed=True)  # this returns; with another limit than `opened`, only after an hour


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
        if opens:
            until(lambda: said.exists() and said.read_text(), "no browser was opened")
        Page(said.read_text().strip() if opens else address).post("done")
        assert "another page" not in process.communicate(timeout=20)[0] or not opens
        assert said.exists() == opens
    assert said.read_text() != f"{address}\n", "what others can see of the browser is not what is printed here"


def test_other_commands_load_nothing_of_it() -> None:
    """CMake starts ``epg generate`` often: it must not load the modules of the page."""
    jiwy = ROOT / "examples/jiwy"
    arguments = ["check", "--tcf", "host_jiwy.tcf", "--model", str(jiwy / "model")]
    arguments += ["--bindings", str(jiwy / "jiwy.bindings.yaml")]
    lines = [f"import sys; sys.path.insert(0, {str(ROOT)!r})", "from epg.cli.main import main"]
    lines += [f"status = main({arguments!r})", "print(status, *sorted(sys.modules))"]
    done = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, timeout=60)
    status, *modules = done.stdout.splitlines()[-1].split()
    assert status == "0" and "epg.generator.project" in modules
    unwanted = ("epg.connect", "epg.edit.bindings", "epg.edit.tcf", "epg.new.new_project", "http", "socket")
    assert not [name for name in modules if name.startswith(unwanted)]
