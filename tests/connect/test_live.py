# SPDX-License-Identifier: Apache-2.0
"""A running target in the page: events, commands, and enabling that ends with the page."""

from __future__ import annotations

import contextlib
import http.client
import io
import json
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from epg.connect.server import SECRET
from epg.diagnostics import Diagnostics
from epg.new_project import ProjectRequest, write_project
from tests.connect.page import Denied, Page, serving, session_of
from tests.live.target import LATE, LEASE, Target
from tests.live.udp_target import UdpTarget, client_of

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def page() -> Iterator[Page]:
    with serving(session_of(ROOT / "examples/jiwy")) as found:
        yield found


class Events:
    """Reads the events of a page in a thread, and calls ``got`` with each."""

    def __init__(self, page: Page, got: Callable[[dict[str, Any]], None] = lambda event: None) -> None:
        self.all: list[dict[str, Any]] = []
        self._connection = http.client.HTTPConnection(urlsplit(page.site).netloc, timeout=20)
        self._connection.request("GET", "/api/live/events", headers={SECRET: page.secret})
        self._socket = self._connection.sock
        self._got = got
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        with contextlib.suppress(OSError, ValueError, http.client.HTTPException):  # closed meanwhile
            for line in self._connection.getresponse():
                event = json.loads(line)
                self.all.append(event)
                self._got(event)

    def close(self) -> None:
        self._socket.shutdown(socket.SHUT_RDWR)


def connect(page: Page, target: Target) -> dict[str, Any]:
    page.post("live/connect", path=str(target.port))
    found: dict[str, Any] = page.state()["live"]["target"]
    return found


def test_the_state_shows_the_target(page: Page, target: Target) -> None:
    found = connect(page, target)
    assert (found["name"], found["matches"], found["every"]) == ("jiwy", True, 1)
    assert {"name": "inputs.position_pan", "unit": "rad", "loop": False} in found["signals"]
    assert found["state"]["enabled"] == "1"
    page.post("live/disconnect")
    assert page.state()["live"]["target"] is None
    assert target.is_enabled(), "the page has not enabled it"


def test_a_target_by_udp_is_connected(page: Page, jiwy_host: Path, tmp_path: Path) -> None:
    target = UdpTarget(jiwy_host, tmp_path)
    try:
        for wrong, message in (("udp:robot", "is not udp:HOST:PORT"), ("udp:[::1]:9", "no program has udp:")):
            with pytest.raises(Denied, match=message):
                page.post("live/connect", path=wrong)
        with client_of(target.port), pytest.raises(Denied, match=r"another program has udp:127\.0\.0\.1:"):
            page.post("live/connect", path=str(target.port))
        page.post("live/connect", path=str(target.port))
        found = page.state()["live"]["target"]
        assert (found["name"], found["path"], found["matches"]) == ("jiwy", str(target.port), True)
        events = Events(page)
        page.post("live/stop")
        time.sleep(1)
        assert page.state()["live"]["target"]["state"]["enabled"] == "0"
        assert len([point for event in events.all for point in event["points"]]) > 20
        page.post("live/disconnect")
        assert target.end()[-1]["enabled"] == 0
    finally:
        target.process.kill()
        target.process.communicate()


def test_points_have_the_least_and_the_greatest_value(page: Page, target: Target) -> None:
    found = connect(page, target)
    events = Events(page)
    page.post("live/command", line="pan_subscriber=0.5")
    time.sleep(1.5)
    points = [point for event in events.all for point in event["points"]]
    assert len(points) >= 100
    times = [point[0] for point in points]
    assert times == sorted(times)
    position = [signal["name"] for signal in found["signals"]].index("inputs.position_pan")
    values = [point[2][position] for point in points]
    assert max(values) > min(values) + 0.1, "the robot moves"
    assert all(low <= high for point in points for low, high in zip(point[1], point[2], strict=True))
    assert events.all[-1]["dropped"] == 0


def test_commands_are_answered_and_mistakes_refused(page: Page, target: Target) -> None:
    with pytest.raises(Denied, match="no target is connected"):
        page.post("live/command", line="get")
    connect(page, target)
    assert page.post("live/command", line="set Pan\\PID\\kp=2.2")["answer"] == ["ok set"]
    with pytest.raises(Denied, match="there is no command 'nonsense'"):
        page.post("live/command", line="nonsense")
    with pytest.raises(Denied, match="a target is connected"):
        page.post("live/connect", path=str(target.port))
    for body in ({}, {"line": 5}, {"line": "ä"}):
        with pytest.raises(Denied):
            page.post("live/command", **body)
    with pytest.raises(Denied, match="there is no action"):
        page.post("live/explode")
    with pytest.raises(Denied, match="there is no actuator"):
        page.post("live/move", actuator="engine", duty=0.1)


def test_another_firmware_is_shown_and_not_written_to(target: Target) -> None:
    session = session_of(ROOT / "examples/jiwy")
    with serving(session) as page:
        session.live.connect(target.port, expected="0123456789abcdef")
        assert page.state()["live"]["target"]["matches"] is False
        for line in ("set Pan\\PID\\kp=2.2", "enable", "pan_subscriber=1", "jog pwm_pan 0.1 10", "save"):
            with pytest.raises(Denied, match="not 0123456789abcdef of the last build"):
                page.post("live/command", line=line)
        with pytest.raises(Denied):
            page.post("live/enable", page="one")
        page.post("live/command", line="get")
        page.post("live/stop")


def test_the_page_works_on_a_system_without_terminals() -> None:
    """Python on Windows does not have these modules."""
    code = (
        "import sys\n"
        "sys.modules.update({name: None for name in ('fcntl', 'termios', 'tty', 'pty')})\n"
        "import pathlib, epg.connect.server, epg.live.port as port\n"
        "try: port.Port(pathlib.Path('COM3'))\n"
        "except port.PortError as problem: print(problem)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stdout == "EPG does not use ports on this system\n", done.stderr


# Enabling


def enabled(page: Page, target: Target) -> Events:
    """Events of a page that has enabled the target, and answers its numbers while ``answering`` is set."""
    connect(page, target)
    page.post("live/stop")

    def answer(event: dict[str, Any]) -> None:
        if event["number"] is not None and answering.is_set():
            page.post("live/respond", page="one", number=event["number"])

    answering.set()
    events = Events(page, answer)
    for _ in range(3):  # a computer with high load can answer too late
        page.post("live/enable", page="one")
        time.sleep(1)
        if page.state()["live"]["target"]["state"]["enabled"] == "1":
            return events
    raise AssertionError("the target does not stay enabled")


answering = threading.Event()


def wait_until_disabled(page: Page, seconds: float = LEASE + LATE) -> None:
    end = time.monotonic() + seconds
    while page.state()["live"]["target"]["state"]["enabled"] == "1":
        assert time.monotonic() < end, "the target is still enabled"
        time.sleep(0.01)


def test_a_page_that_does_not_answer_ends_the_lease(page: Page, target: Target) -> None:
    enabled(page, target)
    answering.clear()
    wait_until_disabled(page)
    found = page.state()["live"]["target"]
    assert found["state"]["fault"] == "operator"
    assert found["fault"]["text"].startswith("Fault 'operator': the program or page that had enabled the target does")
    assert found["fault"]["remedy"].endswith("enable the target again.")


def test_another_page_cannot_keep_the_lease(page: Page, target: Target) -> None:
    enabled(page, target)
    answering.clear()
    stop = threading.Event()

    def others() -> None:
        while not stop.is_set():
            for number in range(200):
                page.post("live/respond", page="two", number=number)

    thread = threading.Thread(target=others, daemon=True)
    thread.start()
    wait_until_disabled(page)
    stop.set()
    thread.join()


def test_a_page_that_is_closed_ends_the_lease(page: Page, target: Target) -> None:
    events = enabled(page, target)
    events.close()
    wait_until_disabled(page)


def test_stop_is_heard_while_events_are_not_read(page: Page, target: Target) -> None:
    enabled(page, target)
    begin = time.monotonic()
    page.post("live/stop")
    assert time.monotonic() - begin < 0.5
    wait_until_disabled(page, 0.5)
    assert page.state()["live"]["target"]["state"]["fault"] == "none"


def test_an_end_of_the_target_is_told(page: Page, target: Target) -> None:
    connect(page, target)
    target.process.kill()
    state = page.until(lambda state: state["live"]["target"] is None, 5)
    assert "is gone" in state["live"]["problem"]["message"]


# Saving and recording


def rows_of(text: bytes) -> tuple[list[str], list[list[float]]]:
    header, *rows = text.decode().splitlines()
    return header.split(","), [[float(value) for value in row.split(",")] for row in rows]


def test_the_streamed_rows_are_saved(page: Page, target: Target) -> None:
    found = connect(page, target)
    page.post("live/command", line="pan_subscriber=0.5")
    time.sleep(1.5)
    header, rows = rows_of(page.get("api/live/save?what=stream&as=csv")[0])
    assert header == ["time", *(signal["name"] for signal in found["signals"])]
    assert len(rows) >= 1000
    times = [row[0] for row in rows]
    assert times[0] == 0.0
    assert times == pytest.approx([number * 0.001 for number in range(len(times))]), "no gap"
    setpoints = {row[header.index("inputs.setpoint_pan")] for row in rows}
    assert setpoints == {0.0, 0.5}

    from mcap.reader import make_reader

    reader = make_reader(io.BytesIO(page.get("api/live/save?what=stream&as=mcap")[0]))
    messages = [json.loads(message.data) for _, _, message in reader.iter_messages()]
    assert len(messages) >= len(rows)
    assert messages[len(rows) - 1]["inputs.setpoint_pan"] == 0.5
    for address in ("what=stream&as=png", "what=all&as=csv", "what=capture&as=csv"):
        with pytest.raises(Denied):
            page.get(f"api/live/save?{address}")


def test_every_cycle_around_a_trigger_is_recorded(page: Page, target: Target) -> None:
    connect(page, target)
    line = "capture setpoint_pan outputs.pwm_pan rows=200 before=50 when=setpoint_pan>0.4"
    assert page.post("live/command", line=line)["answer"] == ["ok capture rows=200"]
    time.sleep(0.5)
    waiting = page.state()["live"]["target"]["capture"]
    assert (waiting["state"], waiting["rows"], waiting["wanted"]) == ("recording", 200, 200)
    page.post("live/command", line="pan_subscriber=0.5")
    page.until(lambda state: state["live"]["target"]["capture"]["state"] == "ready", 5)
    found = page.json("api/live/capture")
    assert (found["names"], found["triggered"]) == (["inputs.setpoint_pan", "outputs.pwm_pan"], True)
    assert found["times"] == pytest.approx([number * 0.001 for number in range(-50, 150)])
    assert found["columns"][0] == [0.0] * 50 + [0.5] * 150
    header, rows = rows_of(page.get("api/live/save?what=capture&as=csv")[0])
    assert header == ["time", *found["names"]]
    assert [row[2] for row in rows] == pytest.approx(found["columns"][1])

    # A recording whose trigger does not happen can be ended.
    page.post("live/command", line="capture setpoint_pan rows=100 when=fault")
    page.post("live/command", line="capture stop")
    page.until(lambda state: state["live"]["target"]["capture"]["number"] == 2, 5)
    assert page.json("api/live/capture")["triggered"] is False


# The simulation


def test_the_target_is_compared_with_its_simulation(tmp_path: Path, target: Target) -> None:
    folder = tmp_path / "robot"
    write_project(ProjectRequest("robot", folder, "host_jiwy", ROOT / "examples/jiwy/model"), Diagnostics())
    with serving(session_of(folder)) as page:
        connect(page, target)
        with pytest.raises(Denied, match="was not enabled while the page was connected"):
            page.post("compare")
        for line, seconds in (
            ("disable", 0.5),
            ("tilt_subscriber=0.2", 0.1),
            ("enable", 2.0),
            ("pan_subscriber=0.5", 0.8),
            ("set Tilt\\PID\\kp=1.3", 0.1),
            ("pan_subscriber=0.1", 0.8),
        ):
            page.post("live/command", line=line)
            time.sleep(seconds)
        state = page.post("compare")
        if ask := state["comparison"]["ask"]:
            assert "--duration=60 --setpoints=" in ask["commands"][-1]
            page.post("compare", run=ask["key"])
        state = page.until(lambda state: state["comparison"]["state"] not in ("idle", "running"), 120)
        assert state["comparison"]["state"] == "done", state["comparison"]
        assert state["comparison"]["result"]["changed"] == ["Tilt\\PID\\kp"]
        found = page.json("api/live/comparison")
        signals = {each["name"]: each for each in found["signals"]}
        assert abs(found["shift"]) < 0.1
        moved = [number for number, at in enumerate(found["times"]) if at > 1.9]  # before, both robots are homing
        assert len(moved) > 500
        for name, reach in (("inputs.setpoint_pan", 0.5), ("inputs.position_pan", 0.4)):
            run, simulated = ([signals[name][which][number] for number in moved] for which in ("target", "simulation"))
            assert max(simulated) - min(simulated) >= reach
            differences = [abs(one - other) for one, other in zip(run, simulated, strict=True)]
            assert sum(differences) / len(differences) < 0.01, "both are JIWY with its plant"
        assert max(signals["inputs.setpoint_tilt"]["simulation"]) == 0.2, "it was sent before enabling"
