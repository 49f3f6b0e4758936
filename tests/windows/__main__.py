# SPDX-License-Identifier: Apache-2.0
"""Runs EPG as Windows' Python does it, under Wine, and prints a report: ``.ci/windows [FOLDER]``.

What Windows writes is compared byte for byte with what Linux writes from the same files.  Then the programs of Windows
read a checkout whose lines end as on Windows.
"""

from __future__ import annotations

import contextlib
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path, PurePath
from typing import Any

import yaml

from epg.live.udp import PortLocked, UdpPort
from tests.checkout import ROOT
from tests.cmake.project import copy_jiwy
from tests.connect.browser import acts
from tests.connect.browser.conftest import chromium, pages_of
from tests.connect.robots import new_project, write_model
from tests.doubles.toolchain import Missing, arm_gcc, node, pico_sdk, rp2040js
from tests.platforms.pico.closed_loop.board import Board, image
from tests.platforms.pico.xrce.line import Line
from tests.system.test_flash import (
    FIRST,
    OPENOCD,
    PICOTOOL,
    PROBE,
    PROGRAMMER,
    PROGRAMMER_PLACE,
    SECOND,
    SYSTEM,
    Bench,
    stand_in,
)
from tests.twenty_sim.generate import generate_from
from tests.waiting import read_until, until
from tests.windows.computer import HERE, MISSING, Computer, is_here, windows

TARGETS = ("host", "rpi_pico2_freertos", "nucleo_h743zi_bare_metal", "rpi_pico_zephyr")
"""The targets for which sources are generated."""

PATIENT = 600
"""Seconds for a build under Wine."""
INSTALL = "py -m pip install ."
GET = "Get it: winget install BrechtSanders.WinLibs.POSIX.UCRT"
PYTHON_TESTS = 1500
"""Tests that must pass with Python of Windows."""
KEYS = (
    ("", "inputs.position_pan"),
    (" ", "by=program"),
    ("à\x7f\x1b[A\x1bOP", ""),  # a letter, deleted; keys without letters
    ("enable\r", "enabled=1"),
    ("\x1b[A ", "enabled=0"),
)
"""Typed at the screen of ``epg live``, each with a text that must follow."""


class Report:
    """Counts the steps, and prints each."""

    def __init__(self) -> None:
        self.passed, self.failed = 0, 0

    def step(self, name: str, work: Callable[[], str | None]) -> None:
        """Runs one step, which returns a remark, and fails by an exception."""
        try:
            result = f"passed  {name}: {work() or 'good'}"
            self.passed += 1
        except Missing as problem:
            result = f"skipped {name}: {problem}"
        except Exception as error:
            result = f"FAILED  {name}: {type(error).__name__}: {error}"
            self.failed += 1
        print(result, flush=True)


def expect(done: subprocess.CompletedProcess[str], status: int = 0) -> str:
    if done.returncode != status:
        raise RuntimeError(f"status {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    return done.stdout


def expect_no_warning(done: subprocess.CompletedProcess[str]) -> None:
    text = expect(done) + done.stderr
    if "warning" in text.lower():
        raise RuntimeError(text[-3000:])


def here(*command: str) -> str:
    """Runs a program of this computer."""
    return expect(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False))


def same_folders(ours: Path, theirs: Path, renamed: Mapping[Path, Path]) -> int:
    """The number of files of two equal folders.  ``renamed`` has the folders of Windows' run and those of Linux'."""
    names = [sorted(str(path.relative_to(folder)) for path in folder.rglob("*")) for folder in (ours, theirs)]
    if names[0] != names[1]:
        raise RuntimeError(f"files differ: {sorted(set(names[0]) ^ set(names[1]))}")
    files = [name for name in names[0] if (ours / name).is_file()]
    for name in files:
        found = (theirs / name).read_bytes()
        for one, other in renamed.items():
            found = found.replace(f"Z:{one}".encode(), str(other).encode())
        if found != (ours / name).read_bytes():
            raise RuntimeError(f"contents differ: {name}")
    if not files:
        raise RuntimeError("there are no files")
    return len(files)


def same_columns(ours: Path, theirs: Path, without: Sequence[str]) -> int:
    """The number of rows of two tables with equal columns, but for those whose names have a word of ``without``."""
    tables = [list(csv.reader(path.read_text(encoding="utf-8").splitlines())) for path in (ours, theirs)]
    for one, other in zip(*(zip(*table, strict=True) for table in tables), strict=True):
        if one != other and not any(word in one[0] for word in without):
            raise RuntimeError(f"{ours.name}: {one[0]} differs")
    return len(tables[0])


class Run:
    """The steps.  ``source`` is a checkout, in which the commands run; ``work`` takes what they write."""

    def __init__(self, computer: Computer, source: Path, work: Path) -> None:
        self.computer, self.source, self.work = computer, source, work
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir(parents=True)

    def epg(self, *words: str | Path, status: int = 0) -> str:
        return expect(self.computer.run(self.computer.python, "-m", "epg", *words, cwd=self.source), status)

    def epg_here(self, *words: str | Path) -> str:
        return here(sys.executable, "-m", "epg", *map(str, words))

    @property
    def program(self) -> Path:
        """JIWY, after :meth:`main_job`."""
        return next((self.work / "Ninja jiwy").glob("**/jiwy_host.exe"))

    def generated(self, target: str) -> str:
        """Generates the sources of JIWY for ``target``, on both systems."""
        words = ["generate", "jiwy", "--tcf", f"{target}_jiwy.tcf", "--model", "examples/jiwy/model"]
        words += ["--bindings", "examples/jiwy/jiwy.bindings.yaml", "--output"]
        if target == "host":
            words[1:1] = ["--plant", "examples/jiwy/plant", "--plant-bindings", "examples/jiwy/plant.bindings.yaml"]
        ours, theirs = self.work / f"linux_{target}", self.work / f"windows_{target}"
        self.epg_here(*words, ours)
        self.epg(*words, theirs)
        return f"{same_folders(ours, theirs, {self.source: ROOT})} files are equal"

    def new(self) -> str:
        words = ("new", "--target", "rpi_pico2_freertos_jiwy", "--model", "examples/jiwy/model", "--name", "robot")
        self.epg_here(*words, self.work / "linux/robot")
        self.epg(*words, self.work / "windows/robot")
        count = same_folders(self.work / "linux/robot", self.work / "windows/robot", {self.source: ROOT})
        return f"{count} files are equal"

    def picture(self) -> str:
        words = ("graph", "host_jiwy.tcf", "--model", "examples/jiwy/model")
        words += ("--bindings", "examples/jiwy/jiwy.bindings.yaml", "--output")
        self.epg_here(*words, self.work / "linux.svg")
        self.epg(*words, self.work / "windows.svg")
        if (self.work / "linux.svg").read_bytes() != (self.work / "windows.svg").read_bytes():
            raise RuntimeError("the pictures differ")
        return "the pictures are equal"

    def same_text(self, *words: str) -> str:
        """Runs a command whose output must be that of Linux, without the form of its line ends and paths."""
        ours, theirs = (text.replace("\\", "/").split() for text in (self.epg_here(*words), self.epg(*words)))
        if ours != theirs:
            raise RuntimeError("\n".join(("the outputs differ", *map(str, (ours[:200], theirs[:200])))))
        return f"{len(ours)} words are equal"

    def built(self, example: str, generator: str, target: str) -> tuple[Path, Path]:
        """Builds ``target`` of an example on both systems, without a warning of CMake or the compiler."""
        build, ours = self.work / f"{generator} {example}", self.work / f"linux_{example}"
        if not ours.exists():
            python = f"-DPython3_EXECUTABLE={sys.executable}"
            here("cmake", "-S", str(ROOT / "examples" / example), "-B", str(ours), python)
            here("cmake", "--build", str(ours), "--target", target)
        settings = ("-G", generator, "-DCMAKE_C_COMPILER=gcc", f"-DPython3_EXECUTABLE=Z:{self.computer.python}")
        expect_no_warning(
            self.computer.run("cmake.exe", "-S", self.source / "examples" / example, "-B", build, *settings)
        )
        expect_no_warning(self.computer.run("cmake.exe", "--build", build, "--target", target))
        return ours, build

    def main_job(self, generator: str) -> str:
        """README's main job: builds and simulates JIWY, and compares the trace with that of Linux."""
        ours, build = self.built("jiwy", generator, "tracking")
        count = same_folders(ours / "epg/jiwy", build / "epg/jiwy", {self.source: ROOT, build: ours})
        rows = same_columns(ours / "trace.csv", build / "trace.csv", ())
        # The reference is an ideal loop, calculated with the C library's sine, which differs in the last digits.
        same_columns(ours / "tracking.csv", build / "tracking.csv", ("reference",))
        pictures = len(list(build.glob("**/tracking.png")))
        return f"{count} files and {rows} rows are equal; {pictures} plot"

    def cell(self) -> str:
        """A system: the production cell, each of whose machines loses its power."""
        ours, build = self.built("production_cell", "Ninja", "killed")
        files = [file.relative_to(ours) for file in (*ours.glob("traces/*.csv"), ours / "topics.csv")]
        # The plant places the blocks by the C library's sine.
        rows = [same_columns(ours / file, build / file, ("outputs.x", "outputs.y")) for file in files]
        return f"{len(files)} files with {sum(rows)} rows are equal"

    def described(self) -> str:
        description = "linux_host/jiwy.json"  # what `epg generate host` has written
        words = ("describe", self.work / description, "--plotjuggler", "--output")
        self.epg_here(*words, self.work / "linux_description")
        self.epg(*words, self.work / "windows_description")
        folders = (self.work / "linux_description", self.work / "windows_description")
        return f"{same_folders(*folders, {self.source: ROOT})} files are equal"

    def simulated(self) -> str:
        return self.epg(
            "simulate", self.program, "--scenario", "examples/jiwy/tracking.yaml", "--output", self.work / "simulated"
        ).splitlines()[-1]

    def ports(self) -> str:
        """The list of ports, from keys of the registry like those of a composite device of Windows."""
        text = expect(self.computer.run(self.computer.python, HERE / "write_registry.py"))
        if "device='USB Serial Device (COM12)', vendor='2e8a', serial='E6614103E7174A21'" not in text:
            raise RuntimeError(text)
        return "COM12 has the serial number of its parent"

    def system(self) -> str:
        """Jobs of Windows, and a removable drive with the label of a board."""
        drive, letter = self.work / "drive", self.computer.prefix / "dosdevices/u:"
        drive.mkdir()
        (drive / "INFO_UF2.TXT").write_text("UF2 Bootloader v3.0\r\nBoard-ID: RPI-RP2\r\n")
        (drive / ".windows-label").write_text("RPI-RP2\n")
        letter.unlink(missing_ok=True)
        letter.symlink_to(drive)
        expect(self.computer.run("reg", "add", r"HKLM\Software\Wine\Drives", "/v", "u:", "/d", "floppy", "/f"))
        text = expect(self.computer.run(self.computer.python, HERE / "use_system.py", self.program)).strip()
        if "RPI-RP2 is U:\\" not in text:
            raise RuntimeError(text)
        return text

    def page(self) -> str:
        """A user with Chromium of this computer and ``epg connect`` of Windows: from wires to a robot that moves."""
        project = self.work / "page"
        self.epg("new", "--target", "host_jiwy", "--model", "examples/jiwy/model", "--name", "robot", project)
        lists = project / "CMakeLists.txt"
        lists.write_text(lists.read_text().replace(" C CXX)", " C)"))  # Debian's compiler for C++ is not installed
        command = (self.computer.python, "-m", "epg", "connect", project, "--no-browser")
        with chromium() as launch, self.computer.start(*command, cwd=self.source) as served:
            assert served.stdout is not None
            try:
                address = next(match[0] for line in served.stdout if (match := re.search(r"http://127\S+#\S+", line)))
                with pages_of(launch()) as opened:
                    return self.used(opened(address), project, served.pid)
            finally:
                served.kill()

    def keys(self) -> set[Path]:
        """The keys of consoles by UDP; a program that was killed with its EPG leaves one."""
        return {*(self.computer.prefix / "drive_c/users").glob("*/AppData/Roaming/epg/keys/*")}

    def used(self, page: Any, project: Path, process: int) -> str:
        """Connects a port, builds, runs, tunes and stops a robot on the page of ``process``."""
        panel, patience, before = page.get_by_role("tabpanel"), 1000 * PATIENT, self.keys()
        acts.field(page, "setpoint_pan").select_option("")
        page.get_by_text("1 error", exact=True).wait_for()
        acts.field(page, "setpoint_pan").select_option("pan_subscriber")
        page.get_by_text("No problems", exact=True).wait_for()

        acts.generate(page)
        page.get_by_role("progressbar").wait_for()
        page.get_by_role("button", name="Cancel", exact=True).click()
        page.locator(".outcome.cancelled", has_text="Cancelled.").wait_for(timeout=patience)
        page.get_by_role("button", name="Generate", exact=True).click()
        page.locator(".outcome.done").wait_for(timeout=patience)

        acts.run_program(page, "robot_host.exe")
        page.get_by_role("tab", name="Live").click()
        page.get_by_text("the program that runs").wait_for(timeout=patience)
        port = PurePath(page.get_by_label("Port", exact=True).input_value())
        try:
            UdpPort(port)
            raise RuntimeError(f"{port} needs no key")
        except PortLocked as locked:
            said = str(locked)
        page.get_by_role("button", name="Connect", exact=True).click()
        page.get_by_role("button", name="Larger").click()
        page.get_by_role("tab", name="Live ○ disabled").wait_for(timeout=patience)
        acts.enable(page, process)
        for name, value in (("Pan\\PID\\kp", "2.2"), ("pan_subscriber", "0.5")):
            entry = page.get_by_role("textbox", name=re.compile(f"^{re.escape(name)}( |$)"))
            entry.fill(value)
            entry.press("Enter")
        console = page.get_by_role("log", name="Console")
        until(lambda: {"ok set", "ok setpoint"} <= set(console.inner_text().splitlines()), console.inner_text, PATIENT)
        page.get_by_role("button", name="Stop robot").click()
        page.get_by_role("tab", name="Live ○ disabled").wait_for(timeout=patience)
        page.get_by_role("button", name="Smaller").click()

        source = next(project.rglob("xxsubmod.c"))
        source.write_text(source.read_text() + "\n")
        page.get_by_role("button", name="Generate", exact=True).click()
        stopped = panel.get_by_text("because Windows does not let a running program be replaced").first
        stopped.wait_for(timeout=patience)
        page.locator(".outcome.done").wait_for(timeout=patience)
        said += f"; {stopped.inner_text()}"
        panel.get_by_role("button", name="Run robot_host.exe in real time").click()  # it asks once
        page.get_by_role("button", name="End program", exact=True).click()
        panel.get_by_text("robot_host.exe was stopped.").wait_for(timeout=patience)
        if new := self.keys() - before:
            raise RuntimeError(f"keys stay: {new}")
        return f"Chromium {page.context.browser.version}; {said}"

    def flash(self) -> str:
        """Programs in their usual places write images to boards.  They are stand-ins, which check their arguments."""
        folder, drive = self.work / "flash", self.computer.prefix / "drive_c"
        copy_jiwy(folder, "model")
        (folder / "tools").mkdir()
        bench = Bench(folder)
        bench.system.write_text(SYSTEM)
        picos = [{"serial": FIRST, "chip": "RP2040"}, {"serial": SECOND, "chip": "RP2350"}]
        boards = {"picos": [{**pico, "bootsel": 1, "program": ""} for pico in picos], "broken": "", "no usb": False}
        (folder / "tools/boards.json").write_text(json.dumps({**boards, "nucleos": [], "slow": 0}))
        bench.build("leader", "follower", "third")
        sdk = next((drive / "users").glob("*/AppData")).parent / ".pico-sdk"
        places = {
            "picotool": sdk / "picotool/2.2.0/picotool",
            "openocd": sdk / "openocd/0.12.0+dev",
            "STM32_Programmer_CLI": drive / "Program Files" / PROGRAMMER_PLACE,
        }
        for (name, place), text in zip(places.items(), (PICOTOOL, OPENOCD, PROGRAMMER), strict=True):
            stand_in(folder / "tools", name, text, self.computer.scripts)
            place.mkdir(parents=True, exist_ok=True)
            shutil.copy(self.computer.scripts / "gcc.exe", place / f"{name}.exe")
        (places["picotool"] / "picotoolConfig.cmake").touch()
        try:
            for number in range(2):
                bench.change(nucleos=[{"probe": PROBE, "idcode": "10036450"}])
                self.epg("flash", bench.system, *(("--target", "third") if number else ()))
                if bench.written() != {FIRST: "leader_firmware", SECOND: "follower_firmware", PROBE: "third_firmware"}:
                    raise RuntimeError(str(bench.boards))
                shutil.rmtree(places["openocd"], ignore_errors=True)  # STM32CubeProgrammer takes its place
        finally:
            shutil.rmtree(sdk)
            shutil.rmtree(drive / "Program Files/STMicroelectronics")
        return f"{len(bench.calls())} commands of {', '.join({call[0]: '' for call in bench.calls()})}"

    @staticmethod
    def sent(*lines: str) -> list[str]:
        """The options by which ``epg live`` sends these commands."""
        return [word for line in lines for word in ("--send", line)]

    @contextlib.contextmanager
    def com7(self, program: Path) -> Iterator[None]:
        """COM7 is the terminal of a host program of this computer."""
        port = self.work / "port"
        command = [str(program), "--realtime", "--console-pty", str(port), "--duration", "600"]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL) as target:
            until(port.exists, "the target has no port")
            self.computer.connect("com7", port)
            try:
                yield
            finally:
                target.kill()

    @contextlib.contextmanager
    def pico_at_com7(self) -> Iterator[None]:
        """COM7 is the USB port of an emulated RP2040 with EPG's firmware, which runs all the time."""
        for need in (pico_sdk, arm_gcc, node, rp2040js):
            need()
        over = threading.Event()
        with Board(image("bare_metal"), {"pan": 0.12, "tilt": 0.12}) as board, ThreadPoolExecutor() as pool:
            board.home()
            with contextlib.closing(Line(board.pico)) as line:
                self.computer.connect("com7", Path(line.path))
                runs = pool.submit(line.run_until, over.is_set, 600_000)
                try:
                    yield
                finally:
                    over.set()
                    assert runs.result(), "the chip did not run to the end"

    def live(self) -> str:
        """Twenty signals of every control cycle, for a minute."""
        ports = {f"in_{number}": "{unit: rad}" for number in range(10)}
        model = write_model(self.work / "twenty", "twenty", ports, {f"out_{each}": f"in->{each}" for each in ports})
        project, build = new_project(self.work / "twenty_signals", "host", model), self.work / "twenty_build"
        here(
            "cmake",
            "-S",
            str(project),
            "-B",
            str(build),
            f"-DPython3_EXECUTABLE={sys.executable}",
            f"-DEPG_PATH={ROOT}",
        )
        here("cmake", "--build", str(build))
        rows = self.work / "rows.csv"
        with self.com7(next(build.rglob("robot_host"))):
            text = self.epg("live", "COM7", "--duration", "60", "--every", "1", "--csv", rows)
        if ", 0 dropped, 0 damaged" not in text:
            raise RuntimeError(text)
        with rows.open(encoding="utf-8") as file:
            signals = sum(name.startswith(("inputs.", "outputs.")) for name in next(csv.reader(file)))
        return f"{signals} signals, {text.strip()}"

    def session(self) -> str:
        """A lease, a setpoint, a parameter; a program of Windows replays the recording, and a motor is found."""
        run, rows, picture = self.work / "run.jsonl", self.work / "run.csv", self.work / "motor.png"
        jogs = self.sent(*(f"jog pwm_pan {duty}" for duty in ("0 100", "0.15 250", "0 300", "-0.1 400")))
        motor = ("actuators.pwm_pan", "encoders.encoder_pan")
        capture = self.sent("enable", "pan_subscriber=0.25", "capture setpoint_pan position_pan rows=200")
        moved = self.sent("enable", "set Pan\\PID\\kp=3", "pan_subscriber=0.5")
        quiet = ("--signals", "none", "--duration", "1")
        with self.com7(self.work / "linux_jiwy/jiwy_host"):
            self.epg("live", "COM7", "--signals", ",".join(motor), "--csv", rows, "--duration", "0.3", *jogs)
            said = self.epg("live", "COM7", *quiet, *capture)
            said += self.epg("live", "COM7", *quiet, *self.sent("capture read", "stats"))
            self.epg("live", "COM7", *moved, "--duration", "8", "--record", run)
        if said.count("csv ") < 200 or "stat enabled=0" not in said:
            raise RuntimeError(said)
        found = self.epg("identify", rows, "--duty", motor[0], "--position", motor[1], "--output", picture)
        replayed = self.epg("replay", run, self.program)
        return f"{found.strip().splitlines()[0]}; {replayed.strip().splitlines()[-1]}"

    def pico(self) -> str:
        """A chip that is slower than real time: its cycles are judged.  A program of Windows replays the recording."""
        rows, run, shown = self.work / "pico.csv", self.work / "pico.jsonl", ("live", "COM7", "--duration", "20")
        tuned = self.sent("disable", "enable", "set Pan\\PID\\kp=3", "pan_subscriber=0.5")
        quiet = ("live", "COM7", "--signals", "none", "--duration", "1")
        with self.pico_at_com7():
            text = self.epg(*shown, "--every", "1", "--csv", rows) + self.epg(*shown, *tuned, "--record", run)
            text += self.epg(*quiet, *self.sent("enable", "capture setpoint_pan position_pan rows=50"))
            text += self.epg(*quiet, *self.sent("capture read", "stats"))
        with rows.open(encoding="utf-8") as file:
            times = [round(1000 * float(row["time"])) for row in csv.DictReader(file)]
        words = (", 0 dropped, 0 damaged", "stat enabled=0", "stat overruns=0", "stat missed=0", "stat outputs_late=0")
        if [text.count(word) for word in words] != [2, 1, 1, 1, 1] or text.count("csv ") != 51:
            raise RuntimeError(text)
        if times != list(range(len(times))) or len(times) < 100:
            raise RuntimeError(f"{len(times)} rows, but not one for each cycle")
        replayed = self.epg("replay", run, self.program)
        return f"{len(times)} cycles, {text.count('ok ')} answers, none lost; {replayed.strip().splitlines()[-1]}"

    def screen(self) -> str:
        """Keys at the screen of ``epg live``.  The console of Wine is a terminal of this computer."""
        ours, theirs = os.openpty()
        command = ("wine", windows(self.computer.python), "-m", "epg", "live", "COM7")
        with self.com7(self.work / "linux_jiwy/jiwy_host"):
            ends = {"stdin": theirs, "stdout": theirs, "stderr": theirs}
            program = subprocess.Popen(command, cwd=self.source, env=self.computer.environment, **ends)
            os.close(theirs)
            for typed, text in KEYS:
                os.write(ours, typed.encode())
                read_until(ours, text)
            os.write(ours, b"\x04")  # Ctrl-D; by Ctrl-C, the terminal ends Wine's console
            read_until(ours, "rows, 0 dropped, 0 damaged")
            if program.wait(20) != 0:
                raise RuntimeError(f"status {program.returncode}")
        os.close(ours)
        return f"{len(KEYS)} times keys, Ctrl-D"

    def python_tests(self) -> str:
        """Tests of `check` that need no program of Linux, with Python of Windows."""
        listed = yaml.safe_load((HERE / "python_tests.yaml").read_text(encoding="utf-8"))
        without = [f"--deselect={name}" for name in listed["without"]]
        pytest = ("-m", "pytest", "-q", "-m", "check", "-o", "pythonpath=.", "-p", "no:cacheprovider", "--tb=line")
        done = self.computer.run(
            self.computer.python, *pytest, *listed["tests"], *without, cwd=self.source, timeout=7200
        )
        last = expect(done).splitlines()[-1]
        if int(last.partition(" passed")[0]) < PYTHON_TESTS:
            raise RuntimeError(last)
        return last

    def all(self, report: Report) -> None:
        jiwy = ("--model", "examples/jiwy/model", "--bindings", "examples/jiwy/jiwy.bindings.yaml")
        pico = ("--tcf", "rpi_pico2_freertos_jiwy.tcf", *jiwy)
        report.step("epg check", partial(self.same_text, "check", "--hardware", *pico))
        report.step("epg ports", partial(self.same_text, "ports", "examples/jiwy/model"))
        report.step("epg explain", partial(self.same_text, "explain", "setpoint_pan", *pico))
        report.step("epg doctor", lambda: f"{len(self.epg('doctor').splitlines())} lines")
        for target in TARGETS:
            report.step(f"epg generate {target}", partial(self.generated, target))
        report.step("epg new", self.new)
        report.step("epg graph", self.picture)
        report.step("epg describe", self.described)
        for generator in ("Ninja", "Ninja Multi-Config"):
            report.step(f"cmake --build --target tracking ({generator})", partial(self.main_job, generator))
        report.step("epg simulate", self.simulated)
        report.step("the simulation of a system", self.cell)
        report.step("ports of the registry", self.ports)
        report.step("programs and drives of Windows", self.system)
        report.step("epg connect in Chromium", self.page)
        report.step("epg flash with the tools' usual places", self.flash)
        report.step("epg live COM7 for 60 s", self.live)
        report.step("a lease, a recording, its replay and a motor at COM7", self.session)
        report.step("the screen of epg live", self.screen)
        report.step("an emulated Pico at COM7", self.pico)


class User:
    """A person with a checkout in the folder ``source``, who types commands."""

    def __init__(self, computer: Computer, source: Path, wheel: Path) -> None:
        self.computer, self.source, self.wheel = computer, source, wheel

    def readme(self) -> str:
        """README's commands for Windows.  pip under Wine does not build: it installs the wheel that Linux has built."""
        text = (self.source / "README.md").read_text(encoding="utf-8")
        lines = "".join(re.findall(r"^```powershell\n(.*?)^```", text, re.MULTILINE | re.DOTALL)).splitlines()
        for line in lines:
            installed = f"py -m pip install --no-index --no-deps --force-reinstall {windows(self.wheel)}"
            self.computer.type(installed if line == INSTALL else line, self.source)
        for made in ("build/jiwy/tracking.csv", "build/jiwy/tracking.png", "my_robot/CMakeLists.txt"):
            if INSTALL not in lines or not (self.source / made).is_file():
                raise RuntimeError(f"README's commands have not made {made}")
        return f"{len(lines)} commands"

    def refused(self, command: str, *words: str) -> str:
        """A command of CMake that EPG refuses, with ``words`` in the message."""
        text = " ".join(self.computer.type(command, self.source, status=1).split())
        for word in words:
            if word not in text:
                raise RuntimeError(text[-3000:])
        return words[0]

    def without_compiler(self) -> str:
        gcc = self.computer.scripts / "gcc.exe"
        gcc.rename(gcc.with_suffix(".away"))
        try:
            return self.refused(
                "cmake -S examples/jiwy -B build/no_gcc -G Ninja", "EPG: this computer has no C compiler 'gcc'", GET
            )
        finally:
            gcc.with_suffix(".away").rename(gcc)

    def other_places(self) -> str:
        """The build folder is on another drive, in the home folder of a user called Jörg Groß."""
        home = self.computer.prefix / "drive_c/users/Jörg Groß"
        shutil.rmtree(home, ignore_errors=True)
        home.mkdir()
        build = r"C:\users\Jörg Groß\build"
        run = partial(self.computer.run, cwd=self.source)
        settings = ("-G", "Ninja", "-DCMAKE_C_COMPILER=gcc")
        expect_no_warning(run("cmake.exe", "-S", "examples/jiwy", "-B", build, *settings))
        expect_no_warning(run("cmake.exe", "--build", build, "--target", "tracking"))
        if not (home / "build/tracking.csv").is_file():
            raise RuntimeError("the build wrote no tracking.csv")
        return "built and simulated"

    def command_file(self) -> str:
        """The command file of 20-sim finds EPG where README's commands have installed it."""
        folder = self.source.parent / "export of JIWY (1)"
        shutil.rmtree(folder, ignore_errors=True)
        generate_from(ROOT / "examples/jiwy/model/tokens.xml", folder)
        os.environ["XXSIM_SCRIPT_MODE"] = "1"  # no window opens
        text = self.computer.type("open_in_epg.cmd", folder)
        if "Next: connect its ports in the browser:" not in text:
            raise RuntimeError(text)
        return text.splitlines()[0]

    def network(self) -> str:
        """The checkout is in a folder of the network, and so is the folder for the generated files."""
        share = self.computer.prefix / "dosdevices/unc/server/share"
        share.parent.mkdir(parents=True, exist_ok=True)
        share.unlink(missing_ok=True)
        share.symlink_to(self.source.parent)
        jiwy, output = r"\\server\share\epg\examples\jiwy", r"\\server\share\generated"
        command = (
            f"py -m epg generate jiwy --tcf host_jiwy.tcf --model {jiwy}\\model --bindings {jiwy}\\jiwy.bindings.yaml"
        )
        self.computer.type(f"{command} --output {output}", self.source)
        return f"{len(list((share / 'generated').glob('*')))} files"

    def all(self, report: Report) -> None:
        report.step("README's commands", self.readme)
        nmake = "cmake -S examples/jiwy -B build/nmake"
        report.step(
            "CMake's own generator",
            partial(self.refused, nmake, "EPG: CMake uses the generator 'NMake Makefiles'", GET),
        )
        report.step("no compiler", self.without_compiler)
        report.step("another drive, a user called Jörg Groß", self.other_places)
        report.step("a folder of the network", self.network)
        report.step("20-sim's command file", self.command_file)


def main(arguments: Sequence[str]) -> int:
    if not is_here():
        print(MISSING)
        return 77
    folder = Path(arguments[0] if arguments else ROOT / "build/windows").resolve()
    computer, report = Computer(folder / "computer"), Report()
    wheels = folder / "wheel"
    shutil.rmtree(wheels, ignore_errors=True)
    pip = (sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", str(wheels), str(ROOT))
    report.step("Wine", computer.boot)
    report.step("compiler", computer.install_tools)
    report.step("Python", computer.install_python)
    report.step("EPG's wheel", lambda: here(*pip))
    report.step("installation", lambda: computer.install(*wheels.glob("*.whl")))
    here_run = Run(computer, ROOT, folder / "work")
    here_run.all(report)
    report.step("tests of check with Windows' Python", here_run.python_tests)
    changed = folder / "Größe und Maß/epg"
    shutil.rmtree(changed, ignore_errors=True)
    clone = ("git", "-c", "core.autocrlf=true", "clone", "-q", "--no-hardlinks", str(ROOT), str(changed))
    report.step(
        "a checkout with Windows' line ends",
        lambda: here(*clone),
    )
    run = Run(computer, changed, folder / "work Maß")
    for target in TARGETS:
        report.step(f"epg generate {target} from it", partial(run.generated, target))
    report.step("cmake --build --target tracking in it", partial(run.main_job, "Ninja"))
    User(computer, changed, next(iter(wheels.glob("*.whl")))).all(report)
    computer.end()
    print(f"{report.passed} passed, {report.failed} failed")
    return 1 if report.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
