# SPDX-License-Identifier: Apache-2.0
"""Products of a build: a program for this computer runs in real time until it is stopped, and all are downloaded."""

from __future__ import annotations

import os
import shutil
import signal
from pathlib import Path, PurePath
from urllib.parse import quote

import pytest

from epg.generator.system import here
from epg.live.udp import PortLocked, UdpPort
from epg.live.udp_keys import kept_key
from tests.connect.builds import processes
from tests.connect.page import Denied, Page, serving, session_of
from tests.connect.robots import new_project
from tests.connect.started import generate
from tests.waiting import until


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("programs") / "a robot"
    new_project(folder, "host_jiwy")
    with serving(session_of(folder)) as page:
        assert generate(page)["state"] == "done"
    return folder


def run(page: Page, program: str) -> None:
    ask = page.post("run", path=program)["program"]["ask"]
    if ask is not None:
        page.post("run", path=program, run=ask["key"])


@pytest.mark.skipif(not Path("/proc/self/cmdline").exists(), reason="this system does not list processes in /proc")
def test_a_program_runs_until_it_is_stopped(built: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    with serving(session_of(built)) as page:
        build = generate(page)
        (product,) = build["products"]
        assert product["runs"] and product["path"] == str(built / "build/robot_host")
        ask = page.post("run", path=product["path"])["program"]["ask"]
        (command,) = ask["commands"]
        assert command.split()[-2:] == ["--realtime", "--duration=86400"]
        assert "--console-pty=" in command and command.count("robot_host.port") == 1
        assert page.state()["program"]["state"] == "idle" and not processes(built)
        page.post("run", path=product["path"], run=ask["key"])
        page.until(lambda state: state["program"]["state"] == "running")
        for action in ("simulate", "run"):
            with pytest.raises(Denied, match="a program is running") as refusal:
                page.post(action, path=product["path"])
            assert refusal.value.status == 409
        until(lambda: len(processes(built)) == 1)
        first = page.until(lambda state: state["live"]["ports"])["live"]["ports"][0]
        assert first == {"path": str(built / "build/robot_host.port"), "device": "the program that runs"}
        until(Path(first["path"]).exists)
        page.post("live/connect", path=first["path"])
        assert page.state()["live"]["target"]["matches"], "its hash is that of the build"
        page.post("cancel")
        state = page.until(lambda state: state["program"]["state"] != "running")
        assert state["program"]["state"] == "cancelled" and not processes(built)
        live = state["live"]
        assert (live["target"], live["lost"], live["problem"]) == (None, None, None), "the user has ended it"
        output = page.json("api/log?of=program&from=0")["lines"]
        assert "in real time" in output[0] and "interrupted" in output[0], "the program has completed its output"

        # The session ends: so does the program.
        page.post("run", path=product["path"])
        page.until(lambda state: state["program"]["state"] == "running")
        until(lambda: processes(built))
    assert not processes(built)


def test_a_program_has_a_socket_where_there_are_no_terminals(
    built: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setattr(here, "HAS_TERMINALS", False)
    keys = tmp_path / "config/epg/keys"
    seen = set()
    with serving(session_of(built)) as page:
        (product,) = generate(page)["products"]
        for _ in range(2):  # another socket and key each time; the command is the same
            run(page, product["path"])
            state = page.until(lambda state: state["program"]["port"])
            port = state["program"]["port"]
            assert state["live"]["ports"][0] == {"path": port, "device": "the program that runs"}
            assert port.startswith("udp:127.0.0.1:") and not port.endswith(":0")
            assert {each.stat().st_mode & 0o777 for each in keys.iterdir()} == {0o600}
            seen.add(kept_key(PurePath(port)))
            with monkeypatch.context() as other_user:
                other_user.setenv("XDG_CONFIG_HOME", str(tmp_path / "other"))
                with pytest.raises(PortLocked, match=f"{port} needs a key"):
                    UdpPort(PurePath(port))
            page.post("live/connect", path=port)
            assert page.state()["live"]["target"]["matches"]
            page.post("cancel")
            state = page.until(lambda state: state["program"]["state"] != "running")
            assert (state["program"]["state"], state["live"]["problem"]) == ("cancelled", None)
            assert state["program"]["ask"] is None and not list(keys.iterdir())
    assert len(seen) == 2 and None not in seen


def change(built: Path) -> None:
    """Changes the program."""
    source = next(built.rglob("xxsubmod.c"))
    source.write_text(source.read_text() + f"\nint changed_{source.stat().st_size};\n")


def test_a_build_runs_beside_a_program(built: Path) -> None:
    with serving(session_of(built)) as page:
        (product,) = generate(page)["products"]
        before = Path(product["path"]).read_bytes()
        run(page, product["path"])
        page.until(lambda state: state["program"]["state"] == "running")
        change(built)
        assert generate(page)["state"] == "done" and Path(product["path"]).read_bytes() != before
        change(built)
        page.generate()
        page.post("cancel")
        state = page.until(lambda state: state["build"]["state"] != "running")
        assert (state["build"]["state"], state["program"]["state"]) == ("cancelled", "running")
        page.post("cancel")
        page.until(lambda state: state["program"]["state"] == "cancelled")


def test_a_build_ends_a_program_whose_file_the_system_locks(built: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(here, "LOCKS_PROGRAMS", True)
    with serving(session_of(built)) as page:
        (product,) = generate(page)["products"]
        run(page, product["path"])
        state = page.until(lambda state: state["program"]["state"] == "running")
        until(Path(state["program"]["port"]).exists)
        page.post("live/connect", path=state["program"]["port"])
        change(built)
        assert generate(page)["state"] == "done"
        why = "stopped 'robot_host', because Windows does not let a running program be replaced"
        assert page.json("api/log?of=build&from=0")["lines"][0] == why
        state = page.state()
        (message,) = state["program"]["messages"]
        assert (state["program"]["state"], message["message"]) == ("cancelled", why)
        assert (state["live"]["target"], state["live"]["lost"], state["live"]["problem"]) == (None, None, None)
        assert "interrupted" in page.json("api/log?of=program&from=0")["lines"][0], "it has switched its outputs off"


def test_a_program_that_fails_says_why(built: Path) -> None:
    with serving(session_of(built)) as page:
        generate(page)
        (product,) = page.state()["build"]["products"]
        run(page, product["path"])
        page.until(lambda state: state["program"]["state"] == "running")
        entries = until(lambda: [entry for entry in Path("/proc").glob("[0-9]*") if runs(entry, product["path"])])
        for process in (int(entry.name) for entry in entries):
            os.kill(process, signal.SIGKILL)
        state = page.until(lambda state: state["program"]["state"] != "running")
        (message,) = state["program"]["messages"]
        assert state["program"]["state"] == "failed" and "ended with status -9" in message["message"]


def runs(entry: Path, program: str) -> bool:
    """True if the process with the folder ``entry`` in /proc runs ``program``."""
    try:
        return os.readlink(entry / "exe") == program
    except OSError:
        return False


def test_only_products_of_the_last_build_are_downloaded_or_run(built: Path, tmp_path: Path) -> None:
    with serving(session_of(built)) as page:
        path = str(built / "build/robot_host")
        with pytest.raises(Denied, match="the last build has not made") as refusal:
            page.get(f"api/product?path={quote(path)}")
        assert refusal.value.status == 404, "nothing was built in this session"
        generate(page)
        data, headers = page.get(f"api/product?path={quote(path)}")
        assert data == (built / "build/robot_host").read_bytes()
        assert headers["Content-Type"] == "application/octet-stream"
        for other in (built / "CMakeLists.txt", built / "build/../build/robot_host", Path("/etc/passwd"), Path()):
            with pytest.raises(Denied, match="the last build has not made"):
                page.get(f"api/product?path={quote(str(other))}")
        with pytest.raises(Denied, match="the last build has not made"):
            page.post("run", path=shutil.which("ls"))
