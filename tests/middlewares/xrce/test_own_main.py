# SPDX-License-Identifier: Apache-2.0
"""A program with its own main(): the target is a node from its start to its stop, also the second time."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent, UdpLink

from .conftest import SANITIZERS, build

PATIENCE = 20.0


@pytest.fixture(scope="module")
def agent() -> Iterator[Agent]:
    with Agent(UdpLink()) as made:
        yield made


@pytest.fixture(scope="module")
def program(agent: Agent, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("xrce_own_main")
    return build("own_main", folder, SANITIZERS, f"-DAGENT={agent.address}") / "own_main"


def test_it_is_a_node_while_it_runs(program: Path, agent: Agent) -> None:
    with subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1) as process:
        assert process.stdin is not None and process.stdout is not None
        for _ in range(2):
            agent.topics.wait_for_sample("rt/lab/cycles_too", PATIENCE, "/lab/robot_host")
            process.stdin.write("stop\n")
            assert process.stdout.readline() == "stopped\n"
            agent.wait_until(lambda: not agent.clients, PATIENCE)  # the board has closed its session
            process.stdin.write("on\n")
        assert process.wait(PATIENCE) == 0
