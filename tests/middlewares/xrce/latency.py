# SPDX-License-Identifier: Apache-2.0
"""Steps of a setpoint that is sent to a program on this computer, by UDP and in real time."""

from __future__ import annotations

import os
import random
import subprocess
import time
from pathlib import Path

from tests.doubles.xrce_agent import Agent, UdpLink, float64
from tests.live.target import read_trace
from tests.middlewares.xrce.steps import TOPIC, Step, duty, parse


def measure(program: Path, count: int, folder: Path, seed: int = 1) -> list[Step]:
    """Sends ``count`` steps, 3 to 7 ms apart, at any phase of the control cycle; returns those that arrived."""
    file, trace, draw = folder / f"{program.name}.txt", folder / f"{program.name}.csv", random.Random(seed)
    with Agent(UdpLink()) as agent:
        command = [str(program), "--realtime", "--quiet", "--agent", agent.address]
        command += ["--trace", str(trace), "--duration", "3600"]
        process = subprocess.Popen(command, env={**os.environ, "LATENCY_FILE": str(file)}, stdout=subprocess.DEVNULL)
        try:
            agent.topics.wait_for_reader(TOPIC)
            agent.wait_until(lambda: any(client.readings for client in agent.clients.values()))
            sent = []
            for number in range(count):
                time.sleep(draw.uniform(0.003, 0.007))  # any phase of the control cycle
                sent.append(time.monotonic())  # the latency to the program's own clock
                agent.topics.publish(TOPIC, float64(duty(number)), reliable=False)
            time.sleep(0.2)  # the last one arrives, and the program publishes nothing
        finally:
            process.terminate()
            status = process.wait(timeout=10)
    assert status == 130
    return parse(file, sent, read_trace(trace))
