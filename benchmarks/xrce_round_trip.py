# SPDX-License-Identifier: Apache-2.0
"""Measures round trips over XRCE: a Float64 to a board and back, at 30 Hz and as fast as the answers arrive.

The boards are the ping-pong example on this computer, and eProsima's client without EPG.  The agents are the tests'
agent in Python, with the measuring program in the same process, and eProsima's agent with Fast DDS, behind which a
CycloneDDS peer measures.
"""

from __future__ import annotations

import importlib.util
import queue
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Protocol

from measure import ROOT, run
from report import Table, arguments, command_line, show

sys.path.insert(0, str(ROOT / "examples" / "ping_pong" / "peer"))

from summary import Run, Summary, summarise

from tests.doubles.toolchain import Missing
from tests.doubles.xrce_agent import Agent, UdpLink, float64, read_float64
from tests.doubles.xrce_agent.bare import bare_client
from tests.doubles.xrce_agent.real_agent import RealAgent, on_loopback, program
from tests.doubles.xrce_agent.topics import Endpoint as Writer

EXAMPLE = ROOT / "examples" / "ping_pong"
QOS = {"best effort": "best", "reliable": "default"}
WARM_UP = 50
PATIENCE = 1.0  # s, after which a ping without an answer counts as lost


def example_peer() -> ModuleType:
    """The example's measuring program, loaded under another name: one of the benchmarks' modules has its name, too."""
    spec = importlib.util.spec_from_file_location("ping_pong_measure", EXAMPLE / "peer" / "measure.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Peer(Protocol):
    """The measuring side: sends pings and receives pongs."""

    def write(self, value: float) -> None: ...

    def take(self, seconds: float) -> list[float]: ...


class InProcess:
    """A peer in the process of the Python agent."""

    def __init__(self, agent: Agent, reliable: bool) -> None:
        self._agent, self._reliable = agent, reliable
        self._pongs: queue.SimpleQueue[float] = queue.SimpleQueue()
        agent.topics.taps.append(self._tap)

    def _tap(self, writer: Writer, data: bytes) -> None:
        if writer.topic == "rt/pong":
            self._pongs.put(read_float64(data))

    def write(self, value: float) -> None:
        self._agent.topics.publish("rt/ping", float64(value), self._reliable)

    def take(self, seconds: float) -> list[float]:
        try:
            return [self._pongs.get(timeout=seconds)]
        except queue.Empty:
            return []


def main() -> None:
    options = arguments(__doc__, count=300)
    try:
        with tempfile.TemporaryDirectory() as folder:
            table = round_trips(Path(folder), options.count)
    except Missing as missing:
        raise SystemExit(str(missing)) from None
    show("xrce_round_trip", [table], options.write, command_line("xrce_round_trip"))


def round_trips(folder: Path, count: int) -> Table:
    boards = {"EPG": build(folder), "eProsima's client alone": {qos: bare_client() for qos in QOS}}
    rows = []
    for agent in ("eProsima's", "Python"):
        if rows:
            break  # the agent in Python stands in for eProsima's where that is not installed
        for board, programs in boards.items():
            for qos in QOS:
                for rate in (30.0, 0.0):
                    try:
                        found = one(agent, programs[qos], qos, rate, count, folder)
                    except Missing:
                        continue
                    rows.append([board, agent, qos, f"{rate:g} Hz" if rate else "flat out", *cells(found)])
    head = ["board", "agent", "QoS", "rate", "lost", "mean", "99%", "max"]
    notes = [
        "On one computer, over UDP on its loopback interface, and through eProsima's agent twice over DDS. The "
        "measuring program, in Python, is part of it.",
        "The thesis's Nucleo-H743ZI with Zephyr and rcl took 5.39 ms on average, on other hardware.",
    ]
    return Table("Round trip over XRCE, ms", head, rows, notes)


def build(folder: Path) -> dict[str, Path]:
    """Builds the example's executables, and returns them by the QoS of both topics."""
    made = folder / "ping_pong"
    options = ["-DPING_PONG_MIDDLEWARE=xrce", "-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={sys.executable}"]
    run(["cmake", "-S", str(EXAMPLE), "-B", str(made), "-G", "Ninja", *options])
    names = {qos: f"ping_pong_{word}_{word}_host" for qos, word in QOS.items()}
    run(["cmake", "--build", str(made), "--target", *names.values()])
    return {qos: made / name for qos, name in names.items()}


def one(agent: str, board: Path, qos: str, rate: float, count: int, folder: Path) -> Summary:
    """Measures ``count`` round trips, or ten times as many without a rate."""
    reliable = qos == "reliable"
    measure = example_peer().measure
    with peer_behind(agent, board, reliable, folder) as peer:
        measure(peer, rate=0.0, count=WARM_UP, patience=PATIENCE, label="")
        found = measure(
            peer, rate=rate, count=count if rate else 10 * count, patience=PATIENCE, label="", first=WARM_UP
        )
    return summarise(Run("", found.times, found.lost))


@contextmanager
def peer_behind(agent: str, board: Path, reliable: bool, folder: Path) -> Iterator[Peer]:
    if agent == "Python":
        with Agent(UdpLink()) as python, running(board, python.address, reliable):
            python.topics.wait_for_reader("rt/ping")
            python.wait_until(lambda: any(client.readings for client in python.clients.values()))
            time.sleep(0.2)
            yield InProcess(python, reliable)
        return
    program()
    from dds import Endpoint

    with on_loopback(), RealAgent.udp(folder) as real, running(board, real.address, reliable):
        names = {"write_reliable": reliable, "read_reliable": reliable}
        endpoint = Endpoint(real.domain, "/ping", "/pong", **names)
        missing = endpoint.wait_for_peer(30.0)
        assert not missing, missing
        time.sleep(0.5)
        yield endpoint


@contextmanager
def running(board: Path, address: str, reliable: bool) -> Iterator[None]:
    command = [str(board), "--realtime", "--quiet", "--agent", address]
    if board.name == "bare_client":
        command = [str(board), f"udp:{address}", *([] if reliable else ["best_effort"])]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.kill()
        process.wait()


def cells(found: Summary) -> list[str]:
    times = (found.mean, found.percentiles[1], found.maximum)
    return [str(found.lost), *(f"{1000 * seconds:.2f}" for seconds in times)]


if __name__ == "__main__":
    main()
