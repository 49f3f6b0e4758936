# SPDX-License-Identifier: Apache-2.0
"""``examples/ping_pong``: every ping has an answer, for all combinations of QoS; the peer's statistics are right."""

from __future__ import annotations

import json
import math
import random
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)

from epg.generator import bootstrap
from tests.doubles.toolchain import cmake_and_ninja, skip_if_missing, tool, xrce_libraries
from tests.doubles.xrce_agent import Agent, UdpLink
from tests.doubles.xrce_agent.dds_bridge import DdsBridge
from tests.examples.pico_project import configure, run
from tests.ros2.network import Network, network, running

EXAMPLE = Path(__file__).resolve().parents[2] / "examples/ping_pong"
PEER = EXAMPLE / "peer"
sys.path.insert(0, str(PEER))
import histogram  # noqa: E402
from summary import Run, percentile, read_run, rows, summarise, write_run  # noqa: E402

QOS = {"default": "reliable", "best": "best_effort"}
COMBINATIONS = [(publisher, subscriber) for publisher in QOS for subscriber in QOS]

Build = Callable[[str], Path]


def host_build(folder: Path, middleware: str) -> Build:
    skip_if_missing(cmake_and_ninja)
    configure(EXAMPLE, f"-DPING_PONG_MIDDLEWARE={middleware}", build=folder)

    def build(name: str) -> Path:
        run(folder, "cmake", "--build", ".", "--target", name)
        return folder / name

    return build


@pytest.fixture(scope="module")
def by_dds(tmp_path_factory: pytest.TempPathFactory) -> Build:
    skip_if_missing(lambda: tool("cyclonedds"))
    return host_build(tmp_path_factory.mktemp("dds"), "dds")


@pytest.fixture(scope="module")
def by_xrce(tmp_path_factory: pytest.TempPathFactory) -> Build:
    skip_if_missing(xrce_libraries)
    return host_build(tmp_path_factory.mktemp("xrce"), "xrce")


@pytest.fixture
def net() -> Iterator[Network]:
    with network() as found:
        yield found


@contextmanager
def ping_pong(net: Network, program: Path, *options: str) -> Iterator[None]:
    process = net.run(program, "--quiet", *options)
    with running([process]):
        yield
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=10) == 130


def measure(net: Network, *options: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(PEER / "measure.py"), *map(str, options)]
    packages = str(bootstrap.package_folder("ros"))
    environment = {**net.environment, "PYTHONPATH": packages + ":" + net.environment.get("PYTHONPATH", "")}
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=60)


def qos_options(publisher: str, subscriber: str) -> list[str]:
    return ["--publisher", QOS[publisher], "--subscriber", QOS[subscriber]]


@pytest.mark.parametrize(("publisher", "subscriber"), COMBINATIONS)
def test_every_ping_comes_back(by_dds: Build, net: Network, tmp_path: Path, publisher: str, subscriber: str) -> None:
    name = f"ping_pong_{publisher}_{subscriber}"
    program = by_dds(f"{name}_host")
    described = json.loads((program.parent / f"epg/{name}/{name}.json").read_text(encoding="utf-8"))
    (ping,) = (t for t in described["subscriptions"] if t["topic"] == "/ping")
    (pong,) = (t for t in described["publications"] if t["topic"] == "/pong")
    assert (pong["qos"], ping["qos"]) == (QOS[publisher], QOS[subscriber])
    file = tmp_path / "run.csv"
    with ping_pong(net, program):
        done = measure(net, "--rate", "0", "--count", "300", "--csv", file, *qos_options(publisher, subscriber))
    assert (done.returncode, done.stderr) == (0, "")
    kept = read_run(file)
    assert (len(kept.times), kept.lost) == (300, 0)
    assert min(kept.times) > 0.0 and statistics.median(kept.times) < 0.05
    assert f"target, {publisher}/{subscriber}, flat out" in done.stdout


def test_pings_keep_their_rate(by_dds: Build, net: Network, tmp_path: Path) -> None:
    file, picture = tmp_path / "run.csv", tmp_path / "run.png"
    with ping_pong(net, by_dds("ping_pong_default_default_host")):
        begin = time.monotonic()  # the rate of the user's program
        done = measure(
            net, "--rate", "30", "--count", "61", "--warm-up", "1", "--patience", "5", "--csv", file, "--png", picture
        )
        took = time.monotonic() - begin  # the rate of the user's program
    assert (done.returncode, done.stderr) == (0, "")
    assert len(read_run(file).times) == 61
    assert took >= 2.0
    assert picture.stat().st_size > 5000


def test_a_peer_that_does_not_fit_says_so(by_dds: Build, net: Network) -> None:
    with ping_pong(net, by_dds("ping_pong_best_best_host")):
        done = measure(net, "--count", "10", "--wait", "2")
    assert done.returncode == 1
    assert done.stderr == "measure.py: within 2 s there was no publisher of /pong, or its QoS does not fit\n"


@pytest.mark.parametrize("qos", QOS)
def test_through_an_agent(by_xrce: Build, net: Network, tmp_path: Path, qos: str) -> None:
    file = tmp_path / "run.csv"
    program = by_xrce(f"ping_pong_{qos}_{qos}_host")
    with (
        Agent(UdpLink()) as agent,
        DdsBridge(agent.topics, net.domain),
        ping_pong(net, program, "--agent", agent.address),
    ):
        done = measure(net, "--rate", "0", "--count", "200", "--csv", file, *qos_options(qos, qos))
    assert (done.returncode, done.stderr) == (0, "")
    assert (len(read_run(file).times), read_run(file).lost) == (200, 0)


def test_the_baseline_needs_no_target(net: Network) -> None:
    done = measure(net, "--baseline", "--rate", "0", "--count", "100")
    assert (done.returncode, done.stderr) == (0, "")
    assert "baseline, default/default, flat out    100     0" in done.stdout


def test_the_numbers_of_a_table() -> None:
    times = [0.001 * n for n in range(1, 101)]
    random.Random(1).shuffle(times)
    summary = summarise(Run("pico", times, lost=3))
    assert (summary.count, summary.lost) == (100, 3)
    assert summary.mean == pytest.approx(0.0505)
    assert summary.deviation == pytest.approx(math.sqrt(100 * 101 / 12) / 1000)  # of 1 ... n: n (n + 1) / 12
    assert (summary.minimum, summary.maximum, summary.median) == (0.001, 0.1, pytest.approx(0.0505))
    assert summary.percentiles == (0.09, 0.099, 0.1)
    cells = rows([summary, summarise(Run("twice", [2.0 * t for t in times], 0)), summarise(Run("none", [], 9))])
    assert cells[0] == "pico 100 3 50.500 29.011 0.00 1.000 100.000 50.500 90.000 99.000 100.000".split()
    assert cells[1][5] == "100.00"
    assert cells[2][1:4] == ["0", "9", "nan"]


@pytest.mark.parametrize("p", [0.0, 1.0, 50.0, 90.0, 99.9, 100.0])
@pytest.mark.parametrize("count", [1, 2, 999, 1000])
def test_percentiles_do_what_they_say(p: float, count: int) -> None:
    values = sorted(random.Random(count).random() for _ in range(count))
    found = percentile(values, p)
    share = 100.0 / count
    assert sum(v <= found for v in values) * share >= p - 1e-9
    assert sum(v < found for v in values) * share < max(p, 1e-9)


def test_a_run_is_kept_as_it_is(tmp_path: Path) -> None:
    kept = Run("a label, 30 Hz", [0.00123456789, 0.5], 7)
    write_run(kept, tmp_path / "run.csv")
    assert read_run(tmp_path / "run.csv") == Run("a label, 30 Hz", [0.001234568, 0.5], 7)
    (tmp_path / "other.csv").write_text("time,topic,value\n", encoding="utf-8")
    done = subprocess.run(
        [sys.executable, str(PEER / "summary.py"), str(tmp_path / "other.csv")], capture_output=True, text=True
    )
    assert done.returncode == 1
    assert "measure.py did not write this file" in done.stderr


def test_the_histogram_has_everything_in_its_bin() -> None:
    times = [0.0011] * 1000 + [0.0025] * 10 + [0.0399]
    width, counts = histogram.bins(times)
    assert width == 0.001
    assert sum(counts) == 1011 and (counts[1], counts[2], counts[39]) == (1000, 10, 1)
    assert histogram.text(times).splitlines() == [
        "      ms    count",
        "   1.000     1000  " + 50 * "█",
        "   2.000       10  " + 17 * "█",
        "     ...",
        "  39.000        1  " + 5 * "█",
    ]
    assert histogram.text([]) == "no round trip"
