# SPDX-License-Identifier: Apache-2.0
"""A motor is moved, identified, and written into the plant, which then moves as the motor does.

The robot is JIWY's program in real time, whose plant has other parameters than the project's plant.  The commands are
those of docs/identify.md.
"""

from __future__ import annotations

import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import pytest

from epg.generator import bootstrap
from epg.generator.diagnostics import Diagnostics
from epg.identify.bound_plant import BoundPlant, load_plant
from epg.live.client import Client
from epg.live.port import SerialPort
from epg.live.rows import Recorder, Stream
from epg.runs.csv_file import CsvFile
from tests.live.target import let_pass
from tests.waiting import until

bootstrap.ensure("plot")

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "identify.md").read_text(encoding="utf-8")
LONGEST_GAP = 0.005
"""The longest time in s between two rows of a recording of every cycle."""
ROBOT = r"""
parameters:
  'Pan\Motor\k': 0.0215
  'Pan\Camera\J': 5.1e-4
  'Pan\Motor\coulomb': 4.4e-4
"""


class Project:
    """A folder with the example, as the page's commands expect it.  ``robot`` is the program of the real robot."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.example = folder / "examples" / "jiwy"
        shutil.copytree(ROOT / "examples" / "jiwy", self.example)
        bindings = self.example / "plant.bindings.yaml"
        guessed = bindings.read_text(encoding="utf-8")
        bindings.write_text(guessed + ROBOT, encoding="utf-8")
        self.true = self.plant()
        self.robot = shutil.copy(self.build(), folder / "robot")
        bindings.write_text(guessed, encoding="utf-8")
        self.guessed = shutil.copy(self.build(), folder / "guessed")

    def build(self) -> Path:
        build = self.folder / "build" / "jiwy"
        configure = ["cmake", "-S", str(self.example), "-B", str(build), "-G", "Ninja", f"-DEPG_PATH={ROOT}"]
        for command in (
            [*configure, f"-DPython3_EXECUTABLE={sys.executable}"],
            ["cmake", "--build", str(build), "--target", "jiwy_host"],
        ):
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
            assert done.returncode == 0, done.stdout + done.stderr
        return build / "jiwy_host"

    def plant(self) -> BoundPlant:
        diagnostics = Diagnostics()
        found = load_plant(self.example / "plant", self.example / "plant.bindings.yaml", diagnostics)
        return diagnostics.checked(found)

    @contextmanager
    def running(self, program: Path) -> Iterator[Path]:
        """The terminal of a program in real time."""
        port = self.folder / "port"
        port.unlink(missing_ok=True)
        command = [str(program), "--realtime", "--console-pty", str(port)]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, cwd=self.folder)
        try:
            until(port.exists, "the robot has no port")
            yield port
        finally:
            process.kill()
            process.wait()

    def run(self, command: str) -> str:
        """The output of a command of the page."""
        words = shlex.split(command.replace("/tmp/jiwy", str(self.folder / "port")))
        assert words[0] == "epg"
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            [sys.executable, "-m", "epg", *words[1:]],
            capture_output=True,
            text=True,
            cwd=self.folder,
            env=environment,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def jog(self, program: Path) -> None:
        """Makes the page's recording.  Repeats it if the computer has stopped the robot: then cycles are missing."""
        for _ in range(5):
            with self.running(program):
                self.run(f"{page_command('epg live')} --force")
            with (self.folder / "pan.csv").open(encoding="utf-8") as file:
                times = [float(row[0]) for row in csv.reader(file) if row[0] != "time"]
            if max(after - before for before, after in pairwise(times)) < LONGEST_GAP:
                return
        pytest.fail(f"five robots in turn missed all cycles of {LONGEST_GAP} s: the computer has other work")

    def identified(self, command: str) -> dict[str, float]:
        found = json.loads(self.run(f"{command} --json"))
        return {name: each["value"] for name, each in found["values"].items()}


def page_command(start: str) -> str:
    """The first command on the page that begins so, as one line."""
    text = PAGE.replace("\\\n", " ")
    return next(line.strip() for line in text.splitlines() if line.strip().startswith(start))


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Project:
    for tool in ("cmake", "ninja"):
        if not shutil.which(tool):
            pytest.skip(f"{tool} is not installed: sudo apt install {tool}")
    return Project(tmp_path_factory.mktemp("identify"))


def check_values(project: Project, values: dict[str, float]) -> None:
    motor = project.true.bindings.motors["duty_pan"]
    gain, time_constant, friction = motor.values(project.true.known())
    assert values["gain"] == pytest.approx(gain, rel=0.03)
    assert values["time_constant"] == pytest.approx(time_constant, rel=0.03)
    assert values["friction"] == pytest.approx(friction, abs=0.003)
    assert values["delay"] < 0.001


def test_the_written_plant_moves_as_the_robot_does(project: Project) -> None:
    command = page_command("epg identify")
    project.jog(project.guessed)
    guess = project.identified(command)
    project.jog(project.robot)
    assert "--write" not in command
    before = (project.example / "plant.bindings.yaml").read_text(encoding="utf-8")
    robot = project.identified(command)
    check_values(project, robot)
    assert guess["gain"] > 1.1 * robot["gain"]
    assert (project.example / "plant.bindings.yaml").read_text(encoding="utf-8") == before

    shown = project.run(f"{command} --write")
    after = (project.example / "plant.bindings.yaml").read_text(encoding="utf-8")
    assert after.startswith(before)  # comments and order stay
    for line in after.removeprefix(before).splitlines():
        assert f"+{line}" in shown
    assert shown.endswith("\nwrote examples/jiwy/plant.bindings.yaml\n")
    true = project.true.values
    new = project.plant().values
    for name in (r"Pan\Motor\k", r"Pan\Camera\J"):
        assert new[name] == pytest.approx(true[name], rel=0.05)
    assert new[r"Tilt\Motor\k"] == true[r"Tilt\Motor\k"]

    project.jog(project.build())
    written = project.identified(command)
    assert written["gain"] == pytest.approx(robot["gain"], rel=0.01)
    assert written["time_constant"] == pytest.approx(robot["time_constant"], rel=0.02)
    assert written["friction"] == pytest.approx(robot["friction"], abs=0.002)


def test_a_step_while_the_robot_is_enabled_gives_the_same_values(project: Project) -> None:
    names = ["actuators.pwm_pan", "encoders.encoder_pan"]
    with project.running(project.robot) as path, SerialPort(path) as port:
        client = Client(port)
        try:
            client.enable()
            let_pass(client, 5.0)  # homing
            sink = CsvFile(project.folder / "step.csv", names)
            recording = Recorder(Stream(names), [sink])
            known = [signal.name for signal in client.description.streamed]
            recording.start(client, [known.index(name) for name in names], 1)
            for setpoint in (1.2, 0.4):
                let_pass(client, 0.1)
                client.command(f"pan_subscriber={setpoint}")
                let_pass(client, 0.6)
            client.stop_stream()
            recording.drain()
            sink.close()
        finally:
            client.stop()
    check_values(project, project.identified(page_command("epg identify").replace("pan.csv", "step.csv")))


def test_the_page_shows_what_is_printed(project: Project) -> None:
    """The page's robot has the parameters of the project's plant.  Numbers of a run in real time differ a little."""
    project.jog(project.guessed)
    output = project.run(page_command("epg identify"))
    block = re.search(r"```\n(\d+\.\d+ s to .*?)```", PAGE, re.DOTALL)
    assert block is not None
    shown, printed = block[1].splitlines(), output.splitlines()

    def words(lines: list[str]) -> list[list[str]]:
        """The table without its numbers and lines."""
        return [[word for word in line.split() if not re.fullmatch(r"[\d.e+-]+", word)] for line in lines[2:8]]

    assert words(shown) == words(printed)
    for quantity in ("gain", "time constant", "friction"):
        numbers = [
            float(next(line for line in lines if line.startswith(quantity)).removeprefix(quantity).split()[0])
            for lines in (shown, printed)
        ]
        assert numbers[0] == pytest.approx(numbers[1], rel=0.03, abs=0.001)
    if os.environ.get("EPG_UPDATE_GOLDEN"):
        picture = f" --output {ROOT / 'docs/pictures/identify.png'}"
        project.run(page_command("epg identify") + picture)
