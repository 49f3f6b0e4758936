# SPDX-License-Identifier: Apache-2.0
"""ROS 2 parameters of JIWY: requests and replies of several frames, and faults in between."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent
from tests.doubles.xrce_agent.parameters import DOUBLE, Parameters, names
from tests.doubles.xrce_agent.wire import Id

from .board import without_connection

SERVICE_STREAM = 0x81
NODE, KP = "/JIWY_node", "Pan.PID.kp"
LOUD = "an empty output of the sanitizers"


@contextmanager
def node(jiwy: Path, agent: Agent, *options: str, name: str = NODE) -> Iterator[Parameters]:
    """A running JIWY; its sanitizers must report nothing."""
    command = [str(jiwy), "--realtime", "--quiet", "--agent", agent.address, *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        agent.topics.wait_for_service(f"{name}/set_parameters_atomically")
        yield Parameters(agent.topics.call, name)
        process.terminate()
        output, errors = process.communicate(timeout=20)
        assert output + without_connection(errors) == "", LOUD
        assert agent.malformed == 0
    finally:
        process.kill()
        process.communicate()


def serving(agent: Agent) -> None:
    agent.topics.wait_for_sample("rt/pan_publisher")
    agent.topics.wait_for_service(f"{NODE}/set_parameters_atomically")


def test_all_services(jiwy: Path, agent: Agent) -> None:
    with node(jiwy, agent) as parameters:
        serving(agent)
        found = parameters.list()
        assert len(found) == 30 and KP in found
        assert parameters.types([KP, "Tilt.PID.kp"]) == [DOUBLE, DOUBLE]
        before = parameters.get([KP])
        assert parameters.set({KP: before[0] + 0.5}) == [(True, "")]
        assert parameters.get([KP]) == [before[0] + 0.5]
        refused, reason = parameters.set_atomically({KP: 1.0, "Tilt.PID.kp": float("nan")})
        assert not refused and reason
        assert parameters.get([KP]) == [before[0] + 0.5]
        assert list(parameters.described([KP])) == [KP]


def test_all_parameters_at_once_in_fragments(small_jiwy: Path, agent: Agent) -> None:
    """As `ros2 param dump` and `load` do.  Values are published meanwhile."""
    with node(small_jiwy, agent) as parameters:
        serving(agent)
        found = parameters.list()
        agent.log.clear()
        since = agent.topics.count
        turn, published = 0, 0
        while turn < 5 or (published <= 15 and turn < 10_000):  # a turn takes milliseconds
            turn += 1
            published = len(agent.topics.samples("rt/pan_publisher", since))
            wanted = {name: 0.001 * index + turn for index, name in enumerate(found)}
            assert parameters.set_atomically(wanted) == (True, "")
            assert parameters.get(found) == list(wanted.values())
            assert list(parameters.described(found)) == found
        for from_board in (True, False):
            assert len(agent.log.of(Id.FRAGMENT, from_board)) > 10
        assert published > 15, "values are published meanwhile"


def test_fragments_on_a_bad_line(small_jiwy: Path, agent: Agent) -> None:
    with node(small_jiwy, agent) as parameters:
        serving(agent)
        found = parameters.list()
        wanted = {name: 0.001 * index + 1 for index, name in enumerate(found)}
        for faults in (agent.to_board, agent.from_board):
            faults.loss, faults.duplicate, faults.reorder = 0.15, 0.1, 0.1
        assert parameters.set_atomically(wanted) == (True, "")
        assert parameters.get(found) == list(wanted.values())
        assert list(parameters.described(found)) == found
        for faults in (agent.to_board, agent.from_board):
            faults.clear()


def kill(agent: Agent) -> None:
    agent.kill()
    agent.start()


def forget_nothing(agent: Agent) -> None:
    """The board believes that the agent is gone.  The agent keeps its session, with the fragments of the reply."""
    agent.mute.add(Id.DELETE)
    agent.freeze()
    time.sleep(4.5)  # longer than the board waits for a frozen agent
    agent.thaw()


@pytest.mark.parametrize("fault", [kill, forget_nothing])
def test_an_agent_fails_in_the_middle_of_a_reply(
    small_jiwy: Path, agent: Agent, fault: Callable[[Agent], None]
) -> None:
    with node(small_jiwy, agent) as parameters:
        serving(agent)
        found = parameters.list()
        for _ in range(2):
            agent.to_board.delay = (0.1, 0.1)  # each acknowledgement takes this long
            agent.log.clear()
            lost = agent.topics.ask(f"{NODE}/describe_parameters", names(found))
            agent.wait_until(lambda: bool(agent.log.of(Id.FRAGMENT, from_board=True)))
            agent.created.clear()
            fault(agent)
            agent.to_board.clear()
            agent.wait_until(lambda: bool(agent.created))
            agent.topics.clear()
            serving(agent)
            assert list(parameters.described(found)) == found
            assert agent.topics.answers(f"{NODE}/describe_parameters", lost) == []
        agent.mute.clear()
        agent.malformed = 0  # the agent has counted the unfinished replies


def test_the_longest_names(small_jiwy: Path, agent: Agent) -> None:
    """The request for a replier is larger than a frame then."""
    space, name = "/" + "s" * 62, "n" * 63
    options = ("--ros-args", "-r", f"__ns:={space}", "-r", f"__node:={name}")
    with node(small_jiwy, agent, *options, name=f"{space}/{name}") as parameters:
        repliers = [board.objects[each] for board in agent.clients.values() for each in board.reply_ends]
        assert max(len(replier.name) for replier in repliers) == len(
            f"rq{space}/{name}/set_parameters_atomicallyRequest"
        )
        agent.topics.wait_for_sample(f"rt{space}/pan_publisher")
        assert len(parameters.list()) == 30
