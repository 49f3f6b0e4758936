# SPDX-License-Identifier: Apache-2.0
"""Measures the time from a press of the space bar or of *Stop* to an actuator that is safe.

A target on this computer has 20 signals and runs at 1 kHz.  It notes the time at which its actuator becomes safe.  Full
load: the page plots all signals, and EPG builds the target again and again on all processors.  In the terminal, `epg
live` shows all signals meanwhile.  Slow page: it plots all signals, and Chromium gives it a quarter of a processor.
Without load, nothing is plotted and nothing is built.
"""

from __future__ import annotations

import contextlib
import os
import pty
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from measure import EPG, ROOT
from report import Table, arguments, command_line, show

from tests.connect.browser.conftest import FLAGS, NAMES
from tests.connect.browser.served import Served
from tests.live.witness import PROJECT, Robot, build_robot

ENABLE = """(async () => {
  const { request } = await import(new URL("live_commands.js", location));
  const { page, live } = await import(new URL("live_events.js", location));
  const body = { page, line: "enable unattended", after: live.state?.stop ?? "", unattended: true };
  return (await request("command", body)).error ?? null;
})()"""
"""Enables the target without a lease: on a very busy computer, a lease could end before the press.  Null: no error."""
PATIENCE = 60.0
"""Seconds that a very busy page may need before its answers are in time."""
SLOWDOWN = 4
"""Factor by which Chromium slows a slow page down."""
HEAD = ["pressed", "load", "presses", "min", "median", "99%", "max", "of the median without load"]


def main() -> None:
    options = arguments(__doc__, count=200)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        project = copy_project(folder / "project")
        program = build_robot(folder / "build")
        with Robot(program, folder) as robot:
            idle, slow, full = (
                measure_page(project, robot, options.count, load) for load in ("none", "slow page", "full")
            )
            quiet, busy = (measure_terminal(program.parent, robot, options.count, load) for load in (False, True))
    found = {
        "page, space bar": {"none": idle[0], "slow page": slow[0], "full": full[0]},
        "page, button": {"none": idle[1], "slow page": slow[1], "full": full[1]},
        "epg live, space bar": {"none": quiet, "full": busy},
    }
    rows = [
        row(name, load, times, measured["none"]) for name, measured in found.items() for load, times in measured.items()
    ]
    notes = [
        "In ms. From the call that presses the key or the mouse button in Chromium, or writes the blank to the "
        "terminal, to the safe actuator. The target first ends its cycle: up to 1 ms. Slow page: it has a quarter of a "
        "processor, and plots all signals.",
    ]
    table = Table("From pressing Stop to the safe actuator", HEAD, rows, notes)
    show("live_stop", [table], options.write, command_line("live_stop"))


def measure_page(project: Path, robot: Robot, count: int, load: str) -> tuple[list[float], list[float]]:
    """The times of the space bar and of the button.  ``load``: "none", "slow page" or "full"."""
    with (
        page_of(project, robot, plots=load != "none") as (epg, page),
        repeated(lambda: build_in_page(epg, project), load == "full"),
    ):
        if load == "slow page":
            page.context.new_cdp_session(page).send("Emulation.setCPUThrottlingRate", {"rate": SLOWDOWN})
        button = page.get_by_role("button", name="Stop robot")

        def enable() -> None:
            """As a user does: the page refuses while it does not answer in time, which passes."""
            end = time.monotonic() + PATIENCE
            while (error := page.evaluate(ENABLE)) is not None:
                assert time.monotonic() < end, error
                time.sleep(1)

        def release() -> None:
            page.mouse.move(1, 1)  # a click on the button would stop again
            page.mouse.up()
            button.hover()

        button.hover()
        by_key = measure(robot, enable, lambda: page.keyboard.press("Space"), count)
        return by_key, measure(robot, enable, page.mouse.down, count, after=release)


def measure_terminal(build_folder: Path, robot: Robot, count: int, load: bool) -> list[float]:
    """The times of the space bar.  With ``load``, all signals are shown, and the target is built."""
    with terminal(robot, load) as keys, repeated(lambda: build(build_folder), load):

        def enable() -> None:
            """The program may not know the number of the last stop yet: the target then refuses."""
            for _ in range(20):
                os.write(keys, b"enable\r")
                with contextlib.suppress(AssertionError):
                    robot.wait(driven=True, seconds=1)
                    return

        return measure(robot, enable, lambda: os.write(keys, b" "), count)


def measure(
    robot: Robot,
    enable: Callable[[], object],
    press: Callable[[], object],
    count: int,
    after: Callable[[], object] = lambda: None,
) -> list[float]:
    """Presses ``count`` times while the actuator is driven; returns the times in s until it is safe."""
    draw, found = random.Random(1), []
    while len(found) < count:
        enable()
        robot.wait(driven=True, seconds=20)
        time.sleep(draw.uniform(0.05, 0.15))
        begin = time.monotonic()
        press()
        robot.wait(driven=False, seconds=20)
        after()
        safe = robot.spans()[-1].safe
        if safe > begin:  # else a lease has ended before: the computer is very busy
            found.append(safe - begin)
    return found


def row(name: str, load: str, times: list[float], reference: list[float]) -> list[str]:
    ordered = sorted(1000 * time for time in times)
    numbers = [ordered[0], statistics.median(ordered), ordered[-(-99 * len(ordered) // 100) - 1], ordered[-1]]
    ratio = statistics.median(times) / statistics.median(reference)
    return [name, load, str(len(times)), *(f"{number:.1f}" for number in numbers), f"{ratio:.1f} x"]


def copy_project(folder: Path) -> Path:
    shutil.copytree(PROJECT, folder)
    cmake = folder / "CMakeLists.txt"
    text = cmake.read_text(encoding="utf-8")
    cmake.write_text(text.replace("${CMAKE_CURRENT_SOURCE_DIR}/../../..", ROOT.as_posix()), encoding="utf-8")
    return folder


@contextmanager
def page_of(project: Path, robot: Robot, plots: bool) -> Iterator[tuple[Served, Any]]:
    """A page that is connected with the robot, with plots of all signals or none."""
    from playwright.sync_api import sync_playwright

    chromium = next(filter(None, map(shutil.which, NAMES)), None)
    if chromium is None:
        raise SystemExit("Chromium is not installed: apt install chromium")
    with sync_playwright() as playwright, Served(project) as epg:
        page = playwright.chromium.launch(executable_path=chromium, args=FLAGS).new_page()
        page.goto(epg.address)
        page.get_by_role("tab", name="Live").click()
        page.get_by_label("Port").fill(str(robot.port))
        page.get_by_role("button", name="Connect", exact=True).click()
        page.get_by_role("button", name="Larger").click()
        page.get_by_role("button", name="Stop robot").wait_for()
        for box in page.locator(".live-signals input").all():
            box.set_checked(plots)
        if plots:
            page.wait_for_timeout(10_000)  # the plots are full
        yield epg, page


@contextmanager
def terminal(robot: Robot, all_signals: bool) -> Iterator[int]:
    """``epg live`` in a terminal; the file of its keyboard."""
    process, keys = pty.fork()
    if process == 0:
        os.environ["TERM"] = "xterm"
        chosen = [] if all_signals else ["--signals", "none"]
        os.execv(sys.executable, [sys.executable, str(EPG), "live", str(robot.port), *chosen])
    over = threading.Event()

    def read() -> None:
        with contextlib.suppress(OSError):  # it has ended
            while not over.is_set():
                os.read(keys, 65536)

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    time.sleep(3)
    try:
        yield keys
    finally:
        over.set()
        os.kill(process, signal.SIGTERM)
        os.waitpid(process, 0)


def build(folder: Path) -> None:
    subprocess.run(["cmake", "--build", folder, "--clean-first"], capture_output=True, check=True)


def build_in_page(epg: Served, project: Path) -> None:
    """Builds the target as *Generate* does."""
    shutil.rmtree(project / "build", ignore_errors=True)
    epg.generate()
    state = epg.until(lambda state: state["build"]["state"] not in ("idle", "running"))
    assert state["build"]["state"] == "done", state["build"]


@contextmanager
def repeated(act: Callable[[], None], does: bool) -> Iterator[None]:
    """Does something all the time meanwhile."""
    over = threading.Event()

    def repeat() -> None:
        while not over.is_set():
            act()

    thread = threading.Thread(target=repeat)
    if does:
        thread.start()
    try:
        yield
    finally:
        over.set()
        if does:
            thread.join()


if __name__ == "__main__":
    main()
