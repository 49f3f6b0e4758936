# SPDX-License-Identifier: Apache-2.0
"""A running target in the page: events, commands, and enabling that ends with the page."""

from __future__ import annotations

import contextlib
import http.client
import io
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from epg.connect.server import SECRET
from tests.connect.page import Denied, Page, serving, session_of
from tests.connect.robots import ROOT, new_project
from tests.doubles.network import bridge
from tests.live.target import LATE, LEASE, Target, check_every_cycle_has_a_row, client_of
from tests.live.udp_target import UdpTarget
from tests.waiting import until

PERIOD = 0.001
"""Seconds of a control cycle."""


@pytest.fixture
def page() -> Iterator[Page]:
    with serving(session_of(ROOT / "examples/jiwy")) as found:
        yield found


class Events:
    """Reads the events of a page, and answers their numbers while ``answers`` is set, in a thread."""

    def __init__(self, page: Page, name: str = "one") -> None:
        self.all: list[dict[str, Any]] = []
        self.answers = threading.Event()
        self.answers.set()
        self._answering = threading.Lock()
        self._page, self._name = page, name
        self._connection = http.client.HTTPConnection(urlsplit(page.site).netloc, timeout=20)
        self._connection.request("GET", f"/api/live/events?page={name}", headers={SECRET: page.secret})
        self._socket = self._connection.sock
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        with contextlib.suppress(OSError, ValueError, http.client.HTTPException):  # closed meanwhile
            for line in self._connection.getresponse():
                event = json.loads(line)
                with self._answering:
                    if event["number"] is not None and self.answers.is_set():
                        self._page.post("live/respond", page=self._name, number=event["number"])
                self.all.append(event)

    def wait_until_in_time(self) -> None:
        """Waits until the page may move the target."""
        until(lambda: self.all and self.all[-1]["in_time"], lambda: self.all[-1:])

    def points(self) -> list[Any]:
        """All points so far."""
        return [point for event in self.all for point in event["points"]]

    def let_pass(self, seconds: float) -> None:
        """Waits until the target has run for some seconds of its own time."""
        until(self.points)
        end = self.points()[-1][0] + seconds
        until(lambda: self.points()[-1][0] > end)

    def end_answers(self) -> float:
        """Returns the monotonic time from which on the page does not answer."""
        with self._answering:
            self.answers.clear()
            return time.monotonic()  # the page's end, compared with the target's time

    def close(self) -> float:
        """Closes the page; returns a time as :meth:`end_answers` does."""
        self._socket.shutdown(socket.SHUT_RDWR)
        return self.end_answers()


def connect(page: Page, target: Target) -> dict[str, Any]:
    page.post("live/connect", path=str(target.port))
    found: dict[str, Any] = page.state()["live"]["target"]
    return found


def watch(page: Page, target: Target) -> tuple[dict[str, Any], Events]:
    """Connects a page that answers in time."""
    found = connect(page, target)
    events = Events(page)
    events.wait_until_in_time()
    return found, events


def act(page: Page, action: str, name: str = "one", **body: object) -> dict[str, Any]:
    """The answer to an action that moves the target.  If a late computer makes the page late, it is tried again."""

    def tried() -> list[dict[str, Any]]:
        try:
            return [page.post(action, page=name, **body)]
        except Denied as denied:
            if "this page does not answer in time" not in denied.message:
                raise
            return []

    return until(tried, "the page does not answer in time", pause=0.2)[0]


def send(page: Page, line: str, name: str = "one", **more: object) -> list[str]:
    answer: list[str] = act(page, "live/command", name, line=line, **more)["answer"]
    return answer


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
        until(lambda: page.state()["live"]["target"]["state"]["enabled"] == "0")
        until(lambda: len(events.points()) > 20)
        page.post("live/disconnect")
        assert target.end()[-1]["enabled"] == 0
    finally:
        target.process.kill()
        target.process.communicate()


def test_points_have_the_least_and_the_greatest_value(page: Page, target: Target) -> None:
    found, events = watch(page, target)
    send(page, "pan_subscriber=0.5")
    position = [signal["name"] for signal in found["signals"]].index("inputs.position_pan")
    until(lambda: len(events.points()) >= 100 and events.points()[-1][2][position] > 0.2, "the robot moves")
    points = events.points()
    times = [point[0] for point in points]
    assert times == sorted(times)
    values = [point[2][position] for point in points]
    assert max(values) > min(values) + 0.1
    assert all(low <= high for point in points for low, high in zip(point[1], point[2], strict=True))
    assert events.all[-1]["dropped"] == 0 or target.was_late()


def test_commands_are_answered_and_mistakes_refused(page: Page, target: Target) -> None:
    with pytest.raises(Denied, match="no target is connected"):
        send(page, "get")
    watch(page, target)
    assert send(page, "set Pan\\PID\\kp=2.2") == ["ok set"]
    with pytest.raises(Denied, match="there is no command 'nonsense'"):
        send(page, "nonsense")
    with pytest.raises(Denied, match="a target is connected"):
        page.post("live/connect", path=str(target.port))
    for body in ({}, {"line": 5}, {"line": "ä"}):
        with pytest.raises(Denied):
            page.post("live/command", **body)
    with pytest.raises(Denied, match="there is no action"):
        page.post("live/explode")
    with pytest.raises(Denied, match="there is no actuator"):
        act(page, "live/move", actuator="engine", duty=0.1)


def test_another_firmware_is_shown_and_not_written_to(target: Target) -> None:
    session = session_of(ROOT / "examples/jiwy")
    with serving(session) as page:
        session.live.connect(target.port, expected="0123456789abcdef")
        assert page.state()["live"]["target"]["matches"] is False
        for line in ("set Pan\\PID\\kp=2.2", "enable", "pan_subscriber=1", "jog pwm_pan 0.1 10", "save"):
            with pytest.raises(Denied, match="not 0123456789abcdef of the last build"):
                send(page, line)
        with pytest.raises(Denied):
            page.post("live/enable", page="one")
        send(page, "get")
        page.post("live/stop")


def test_the_page_works_on_a_system_without_terminals() -> None:
    """Python on Windows does not have these modules."""
    code = (
        "import sys\n"
        "sys.modules.update({name: None for name in ('fcntl', 'termios', 'tty', 'pty')})\n"
        "import pathlib, epg.connect.server, epg.live.port as port\n"
        "try: port.SerialPort(pathlib.Path('COM3'))\n"
        "except port.PortError as problem: print(problem)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stdout == "EPG does not use ports on this system\n", done.stderr


# Enabling


def enabled(page: Page, target: Target) -> Events:
    """Events of a page that has enabled the target, and answers its numbers."""
    _, events = watch(page, target)
    page.post("live/stop")
    for _ in range(3):  # a computer with high load can answer too late
        act(page, "live/enable")
        events.let_pass(1)
        if page.state()["live"]["target"]["state"]["enabled"] == "1":
            return events
    raise AssertionError("the target does not stay enabled")


def wait_until_disabled(page: Page) -> None:
    until(lambda: page.state()["live"]["target"]["state"]["enabled"] == "0", "the target is still enabled")


def test_a_page_that_does_not_answer_ends_the_lease(page: Page, target: Target) -> None:
    at = enabled(page, target).end_answers()
    wait_until_disabled(page)
    found = page.state()["live"]["target"]
    assert found["state"]["fault"] == "operator"
    assert found["fault"]["text"].startswith("Fault 'operator': the program or page that had enabled the target does")
    assert found["fault"]["remedy"].endswith("enable the target again.")
    page.until(lambda state: "The page was late" in state["live"]["target"]["fault"]["text"])
    page.post("live/disconnect")
    assert target.last_enabled() <= at + LEASE + PERIOD


def test_another_page_cannot_keep_the_lease(page: Page, target: Target) -> None:
    at = enabled(page, target).end_answers()
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
    page.post("live/disconnect")
    assert target.last_enabled() <= at + LEASE + PERIOD


def test_stop_is_heard_while_events_are_not_read(page: Page, target: Target) -> None:
    enabled(page, target)
    page.post("live/stop")
    at = time.monotonic()  # the answer's time, compared with the target's
    wait_until_disabled(page)
    assert page.state()["live"]["target"]["state"]["fault"] == "none", "it was stopped, and not by the end of its lease"
    page.post("live/disconnect")
    assert target.last_enabled() <= at, "each cycle after the answer is disabled"


def test_an_end_of_the_target_is_told(page: Page, target: Target) -> None:
    connect(page, target)
    target.process.kill()
    state = page.until(lambda state: state["live"]["target"] is None)
    assert "is gone" in state["live"]["problem"]["message"]


def test_nothing_moves_before_a_page_answers_in_time(page: Page, target: Target) -> None:
    _, events = watch(page, target)
    page.post("live/stop")
    movers: list[tuple[str, dict[str, object]]] = [
        ("live/enable", {}),
        ("live/move", {"actuator": "pwm_pan", "duty": 0.1}),
        *(("live/command", {"line": line}) for line in ("enable", "jog pwm_pan 0.1 50", "pan_subscriber=1")),
        ("live/command", {"line": "enable unattended", "unattended": True}),
    ]

    def all_refused(name: str) -> None:
        for action, body in movers:
            with pytest.raises(Denied, match="this page does not answer in time"):
                page.post(action, page=name, **body)

    all_refused("two")  # it gets no events
    second = Events(page, "two")
    second.answers.clear()  # it has answered, but not 40 times
    all_refused("two")
    second.answers.set()
    second.wait_until_in_time()
    act(page, "live/enable", "two")
    page.post("live/stop")
    events.answers.clear()
    until(lambda: not events.all[-1]["in_time"])
    all_refused("one")  # it answers no more
    os.kill(target.process.pid, signal.SIGSTOP)
    until(lambda: second.all[-1]["old"] and second.all[-1]["age"] > 1)
    with pytest.raises(Denied, match="the values are old"):
        page.post("live/enable", page="two")
    os.kill(target.process.pid, signal.SIGCONT)
    until(lambda: not second.all[-1]["old"])


def test_each_enabling_of_a_page_is_on_a_lease(page: Page, target: Target) -> None:
    """Whatever field it is typed into, and with any blanks."""
    _, events = watch(page, target)
    for line in ("enable", "  enable ", "enable leased"):
        page.post("live/stop")
        assert send(page, line) == ["ok enable"]
        assert page.state()["live"]["target"]["state"]["leased"] == "1", line
    for line in ("enable now", "enable leased unattended"):
        with pytest.raises(Denied, match="use 'enable' or 'enable unattended'"):
            send(page, line)
    events.close()
    wait_until_disabled(page)


def test_without_a_lease_only_after_the_user_has_agreed(page: Page, target: Target) -> None:
    _, events = watch(page, target)
    page.post("live/stop")
    with pytest.raises(Denied, match="'enable unattended' must be confirmed"):
        send(page, "enable unattended")
    assert send(page, "enable unattended", unattended=True) == ["ok enable"]
    events.close()
    Events(page, "two").let_pass(LEASE + LATE)
    state = page.state()["live"]["target"]["state"]
    assert (state["enabled"], state.get("leased")) == ("1", None)


def test_a_stop_goes_on_after_the_connection_was_lost(page: Page, target: Target, tmp_path: Path) -> None:
    """The cable is out, and in again."""
    line = subprocess.Popen([sys.executable, bridge.__file__, target.port, tmp_path / "line"], stdout=subprocess.PIPE)
    assert line.stdout is not None and line.stdout.readline() == b"ready\n"
    page.post("live/connect", path=str(tmp_path / "line"))
    line.kill()
    lost = page.until(lambda state: state["live"]["lost"])["live"]
    assert lost["target"] is None and lost["lost"]["name"] == "jiwy" and lost["lost"]["state"]["enabled"] == "1"
    with pytest.raises(Denied) as refused:
        page.post("live/stop")
    assert refused.value.hint == "switch the actuators' supply off"
    (tmp_path / "line").unlink()
    again = subprocess.Popen([sys.executable, bridge.__file__, target.port, tmp_path / "line"], stdout=subprocess.PIPE)
    assert again.stdout is not None and again.stdout.readline() == b"ready\n"
    page.post("live/stop")
    assert page.state()["live"]["lost"]["state"]["enabled"] == "0"
    for process in (line, again):
        process.kill()
        process.communicate()
    assert not target.is_enabled()


# Saving and recording


def rows_of(text: bytes) -> tuple[list[str], list[list[float]]]:
    header, *rows = text.decode().splitlines()
    return header.split(","), [[float(value) for value in row.split(",")] for row in rows]


def test_the_streamed_rows_are_saved(page: Page, target: Target) -> None:
    found, events = watch(page, target)
    send(page, "pan_subscriber=0.5")
    events.let_pass(1.5)
    kept, dropped = events.all[-1]["kept"], events.all[-1]["dropped"]
    header, rows = rows_of(page.get("api/live/save?what=stream&as=csv")[0])
    assert header == ["time", *(signal["name"] for signal in found["signals"])]
    assert len(rows) >= 1000
    assert kept["size"] == pytest.approx(len(rows) * (8 + 4 * len(found["signals"])), rel=0.5)
    assert (kept["problem"], kept["saving"]) == ("", None)
    assert rows[0][0] == 0.0
    assert {row[header.index("inputs.setpoint_pan")] for row in rows} == {0.0, 0.5}

    from mcap.reader import make_reader

    reader = make_reader(io.BytesIO(page.get("api/live/save?what=stream&as=mcap")[0]))
    told = [message for *_, message in reader.iter_messages()]
    assert kept["since"] == pytest.approx(1e-9 * told[0].log_time, abs=2)
    messages = [json.loads(message.data) for message in told]
    assert len(messages) >= len(rows)
    assert messages[len(rows) - 1]["inputs.setpoint_pan"] == 0.5
    for address in ("what=stream&as=png", "what=all&as=csv", "what=capture&as=csv"):
        with pytest.raises(Denied):
            page.get(f"api/live/save?{address}")
    dropped_now = events.all[-1]["dropped"]
    check_every_cycle_has_a_row(
        header, [(row[0], row) for row in rows], target.cycles(), dropped=range(dropped, dropped_now + 1)
    )


def test_every_cycle_around_a_trigger_is_recorded(page: Page, target: Target) -> None:
    watch(page, target)
    line = "capture setpoint_pan outputs.pwm_pan rows=200 before=50 when=setpoint_pan>0.4"
    assert send(page, line) == ["ok capture rows=200"]
    waiting = page.until(lambda state: state["live"]["target"]["capture"]["rows"] == 200)["live"]["target"]["capture"]
    assert (waiting["state"], waiting["wanted"]) == ("recording", 200)
    send(page, "pan_subscriber=0.5")
    page.until(lambda state: state["live"]["target"]["capture"]["state"] == "ready")
    found = page.json("api/live/capture")
    assert (found["names"], found["triggered"]) == (["inputs.setpoint_pan", "outputs.pwm_pan"], True)
    times, columns = found["times"], found["columns"]
    assert columns[0] == [0.0] * 50 + [0.5] * 150
    assert times[50] == 0.0, "the first row with the setpoint has the time 0"
    header, rows = rows_of(page.get("api/live/save?what=capture&as=csv")[0])
    assert header == ["time", *found["names"]]
    assert [row[2] for row in rows] == pytest.approx(columns[1])

    # A recording whose trigger does not happen can be ended.
    send(page, "capture setpoint_pan rows=100 when=fault")
    send(page, "capture stop")
    page.until(lambda state: state["live"]["target"]["capture"]["number"] == 2)
    assert page.json("api/live/capture")["triggered"] is False
    captured = [(time, (first, second)) for time, first, second in zip(times, *columns, strict=True)]
    check_every_cycle_has_a_row(found["names"], captured, target.cycles())


# The simulation


def test_the_target_is_compared_with_its_simulation(tmp_path: Path, target: Target) -> None:
    folder = new_project(tmp_path / "robot", "host_jiwy")
    with serving(session_of(folder)) as page:
        _, events = watch(page, target)
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
            if line == "enable":
                events.wait_until_in_time()
            send(page, line)
            events.let_pass(seconds)
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
