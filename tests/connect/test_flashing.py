# SPDX-License-Identifier: Apache-2.0
"""Flash: a product is written to the board that the user has confirmed, by the drive, picotool, OpenOCD or west.

Stand-ins for the tools run here, those of tests/system/test_flash.py.  A file describes their boards.
"""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from epg.connect.activity import Outcome
from epg.connect.build.build_run import Build
from epg.connect.projects import Job
from epg.connect.run.flash import Boards, FlashRun, boards_for
from epg.connect.session import Session
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import load_application
from epg.generator.system import on_posix
from epg.generator.tools import uf2_drives, usb_boards
from epg.system import flash
from tests.connect.builds import job_of
from tests.connect.page import Denied, serving, session_of
from tests.connect.robots import new_project
from tests.system.test_flash import FIRST, OPENOCD, PICOTOOL, PROBE, PROGRAMMER, SECOND, stand_in, usb
from tests.waiting import until

WEST = r"""
import os, sys
here = os.path.dirname(os.path.abspath(__file__))
print(*["west", *sys.argv[1:]], sep="\t", file=open(os.path.join(here, "log.txt"), "a"))
if os.path.exists(os.path.join(here, "unplugged")):
    print("FATAL ERROR: command exited with status 1: openocd")
    sys.exit(1)
"""


@pytest.fixture
def tools(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the stand-ins, which are the first in PATH.  No drive and no board is attached."""
    folder = tmp_path / "tools"
    folder.mkdir()
    for name, text in (("picotool", PICOTOOL), ("openocd", OPENOCD), ("west", WEST)):
        stand_in(folder, name, text)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
    (tmp_path / "usb").mkdir()
    monkeypatch.setattr(usb_boards, "DEVICES", tmp_path / "usb")
    (tmp_path / "mounts").write_text("sysfs /sys sysfs rw 0 0\n")
    monkeypatch.setattr(on_posix, "MOUNTS", tmp_path / "mounts")
    monkeypatch.setattr(flash, "_PAUSE", 0.0)
    return folder


def attach(tmp_path: Path, *picos: dict[str, object], nucleos: list[dict[str, str]] | None = None) -> None:
    boards = {"picos": list(picos), "nucleos": nucleos or [], "broken": "", "no usb": False, "slow": 0}
    (tmp_path / "tools/boards.json").write_text(json.dumps(boards))


def plug(tmp_path: Path, port: str, id: str, serial: str, product: str, address: str) -> None:
    """A USB device with the vendor and product ``id``."""
    vendor, _, number = id.partition(":")
    facts = {"idVendor": vendor, "idProduct": number, "serial": serial, "product": product}
    usb(tmp_path / "usb", port, **facts, busnum="1", devnum=address)


def pico(serial: str, program: str = "", bootsel: int = 0, chip: str = "RP2040") -> dict[str, object]:
    return {"serial": serial, "chip": chip, "bootsel": bootsel, "program": program}


def drive(tmp_path: Path, name: str, board: str) -> Path:
    """A drive of a boot program, mounted at a folder with a blank in its name."""
    folder = tmp_path / "media" / name
    folder.mkdir(parents=True)
    (folder / "INFO_UF2.TXT").write_text(f"UF2 Bootloader v3.0\r\nModel: Raspberry Pi\r\nBoard-ID: {board}\r\n")
    with (tmp_path / "mounts").open("a") as file:
        file.write(f"/dev/sdb1 {str(folder).replace(' ', chr(92) + '040')} vfat rw 0 0\n")
    return folder


def robot(tmp_path: Path, target: str = "rpi_pico_bare_metal_jiwy") -> tuple[Job, list[Path]]:
    """A project, and its products as a build would make them."""
    folder = new_project(tmp_path / "robot", target) / "build"
    folder.mkdir()
    made = [folder / "robot_firmware.uf2", folder / "robot_firmware.elf"]
    made[0].write_bytes(bytes(range(256)) * 1000)
    made[1].write_bytes(b"\x7fELF")
    return job_of(tmp_path / "robot"), made


def boards(job: Job, made: list[Path]) -> Boards:
    application = load_application(job.request, Diagnostics())
    assert application is not None
    return boards_for(job, application, made)


def write(found: Boards, number: int = 0, *, replace: bool = False) -> dict[str, object]:
    run = FlashRun(lambda: None)
    run.start(found, found.found[number], replace=replace)
    assert run.wait(30)
    return run.state()


def calls(tools: Path) -> list[str]:
    log = tools / "log.txt"
    lines = log.read_text().replace("\t", " ").splitlines() if log.exists() else []
    return [line for line in lines if not line.endswith(" --version")]  # EPG asks for versions at any time


def restarting(folder: Path) -> Callable[[], None]:
    """Plays the boot program: it takes the drive away when the file is complete.  Returns a function that waits."""

    def wait() -> None:
        until(lambda: any(copy.stat().st_size == 256_000 for copy in folder.glob("*.uf2")))
        (folder / "INFO_UF2.TXT").unlink()

    thread = threading.Thread(target=wait)
    thread.start()
    return thread.join


def test_a_drive_takes_the_uf2(tools: Path, tmp_path: Path) -> None:
    job, made = robot(tmp_path)
    drive(tmp_path, "RP2350", "RP2350")  # a Pico 2, for which this program is not
    folder = drive(tmp_path, "RPI RP2", "RPI-RP2")
    found = boards(job, made)
    assert [board.shown for board in found.found] == [f"RPI-RP2, the drive {folder}"]
    wait = restarting(folder)
    state = write(found)
    wait()
    assert state["state"] == "done" and state["done"] == state["total"] == 256_000, state
    assert (folder / "robot_firmware.uf2").read_bytes() == made[0].read_bytes()
    assert not any(call.startswith("picotool info") for call in calls(tools)), "no tool is needed"


def test_a_board_that_does_not_restart_is_reported(
    tools: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(uf2_drives, "PATIENCE", 0.2)
    job, made = robot(tmp_path)
    drive(tmp_path, "RPI-RP2", "RPI-RP2")
    state = write(boards(job, made))
    (message,) = state["messages"]  # type: ignore[misc]
    assert state["state"] == "failed" and "the board has not restarted" in message["message"]
    assert message["hint"].startswith("hold BOOTSEL")


def test_without_a_board_the_button_to_press_is_named(tools: Path, tmp_path: Path) -> None:
    job, made = robot(tmp_path)
    found = boards(job, made)
    assert found.found == () and found.problem == "no board was found"
    assert found.hint == "Hold BOOTSEL while you plug it in, and look again"


def test_picotool_writes_to_the_chosen_one_of_two_boards(tools: Path, tmp_path: Path) -> None:
    job, made = robot(tmp_path)
    attach(tmp_path, pico(FIRST, "robot"), pico(SECOND))
    plug(tmp_path, "1-1", "2e8a:000a", FIRST, "Pico", "4")
    plug(tmp_path, "1-2", "2e8a:000a", SECOND, "Pico", "5")
    found = boards(job, made)
    assert [board.shown for board in found.found] == [f"Pico {FIRST}", f"Pico {SECOND}"]
    state = write(found)
    assert state["state"] == "done", state
    assert calls(tools) == [
        f"picotool info -a --ser {FIRST}",
        f"picotool reboot -u -f --ser {FIRST}",
        f"picotool info -a --ser {FIRST}",
        f"picotool load -v -x {made[1]} --ser {FIRST}",
    ]
    written = json.loads((tools / "boards.json").read_text())["picos"]
    assert [board.get("image") for board in written] == [str(made[1]), None]


def test_the_program_of_another_target_is_replaced_only_on_request(tools: Path, tmp_path: Path) -> None:
    job, made = robot(tmp_path)
    attach(tmp_path, pico(FIRST, "leader"))
    plug(tmp_path, "1-1", "2e8a:000a", FIRST, "Pico", "4")
    found = boards(job, made)
    state = write(found)
    (message,) = state["messages"]  # type: ignore[misc]
    assert state["state"] == "failed" and state["can_replace"]
    assert "has the program of the target 'leader'" in message["message"] and "--replace" not in message["hint"]
    assert not any(" load " in call for call in calls(tools))
    assert write(found, replace=True)["state"] == "done"


def test_another_chip_and_a_tool_without_usb(tools: Path, tmp_path: Path) -> None:
    job, made = robot(tmp_path)
    attach(tmp_path, pico(FIRST, chip="RP2350", bootsel=1))
    plug(tmp_path, "1-1", "2e8a:000f", FIRST, "", "4")
    found = boards(job, made)
    state = write(found)
    (message,) = state["messages"]  # type: ignore[misc]
    assert "has the chip RP2350" in message["message"] and message["hint"].startswith("attach the board of this target")
    data = json.loads((tools / "boards.json").read_text())
    (tools / "boards.json").write_text(json.dumps(data | {"no usb": True}))
    (message,) = write(found)["messages"]  # type: ignore[misc]
    assert message["message"] == "picotool cannot reach boards: it was built without USB"
    assert message["hint"].startswith("hold BOOTSEL")


def test_a_device_that_the_user_may_not_use(tools: Path, tmp_path: Path) -> None:
    job, made = robot(tmp_path)
    attach(tmp_path)
    (tools / "picotool.py").write_text(  # sources of picotool 2.2.0, main.cpp
        'print("No accessible RP-series devices in BOOTSEL mode were found.\\n\\nbut:\\n\\nDevice at bus 1, address 4 '
        'appears to be a RP2040 device in BOOTSEL mode, but picotool was unable to connect.")\nraise SystemExit(249)\n'
    )
    plug(tmp_path, "1-1", "2e8a:0003", "", "RP2 Boot", "4")
    found = boards(job, made)
    assert found.found[0].shown == "RP2 Boot at bus 1, address 4"
    (message,) = write(found)["messages"]  # type: ignore[misc]
    assert "udev rules of picotool" in message["hint"]


def test_openocd_writes_to_a_nucleo(tools: Path, tmp_path: Path) -> None:
    job, made = robot(tmp_path, "nucleo_h743zi_bare_metal_jiwy")
    attach(tmp_path, nucleos=[{"probe": PROBE, "idcode": "10036450"}])
    assert boards(job, made[1:]).hint == "Connect its debug probe by USB, and look again"
    plug(tmp_path, "1-1", "0483:374e", PROBE, "STLINK-V3", "4")
    found = boards(job, made[1:])
    assert [board.shown for board in found.found] == [f"STLINK-V3 {PROBE}"]
    assert write(found)["state"] == "done"
    assert calls(tools)[-1] == (
        f"openocd -f board/st_nucleo_h743zi.cfg -c adapter serial {PROBE} -c program {{{made[1]}}} verify reset exit"
    )


def test_stm32cubeprogrammer_writes_to_a_nucleo(tools: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    job, made = robot(tmp_path, "nucleo_h743zi_bare_metal_jiwy")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("PATH", str(tools))
    (tools / "openocd").unlink()
    attach(tmp_path, nucleos=[{"probe": PROBE, "idcode": "10036450"}])
    plug(tmp_path, "1-1", "0483:374e", PROBE, "STLINK-V3", "4")
    assert boards(job, made[1:]).problem == "OpenOCD was not found"
    stand_in(tools, "STM32_Programmer_CLI", PROGRAMMER)
    assert write(boards(job, made[1:]))["state"] == "done"
    assert calls(tools)[-1] == f"STM32_Programmer_CLI -c port=SWD sn={PROBE} -w {made[1]} -v -rst"


def test_west_writes_programs_of_zephyr(tools: Path, tmp_path: Path) -> None:
    job, made = robot(tmp_path, "nucleo_h743zi_zephyr_jiwy")
    found = boards(job, [made[0].with_suffix(".hex"), made[1]])
    assert [board.shown for board in found.found] == ["the board that 'west flash' finds"]
    assert write(found)["state"] == "done"
    assert calls(tools) == [f"west flash --skip-rebuild -d {tmp_path / 'robot/build'}"]
    (tools / "unplugged").touch()
    state = write(found)
    assert state["state"] == "failed" and "openocd" in state["messages"][0]["message"]  # type: ignore[index]


# the session ----------------------------------------------------------------------------------------------------------


def built(session: Session, made: list[Path], *, runs: bool = False) -> None:
    """Puts the end of a build into the session."""
    listed = [{"path": str(path), "what": "", "runs": runs} for path in made]
    session.runs._build = Build(lambda: None)
    session.runs._build.begin(lambda: Outcome("done", (), {"products": listed}))
    assert session.runs._build.wait(10)


def test_a_board_is_written_only_after_it_was_found_and_confirmed(tools: Path, tmp_path: Path) -> None:
    _, made = robot(tmp_path)
    folder = drive(tmp_path, "RPI-RP2", "RPI-RP2")
    session = session_of(tmp_path / "robot")
    with serving(session) as page:
        with pytest.raises(Denied, match="no file for the board yet") as refusal:
            page.post("flash")
        assert refusal.value.hint == "generate first"
        built(session, made)
        id = f"drive {folder}"
        with pytest.raises(Denied, match="there is no board"):
            page.post("flash", board=id)
        state = page.post("flash")["flash"]
        assert state["boards"]["found"] == [{"id": id, "shown": f"RPI-RP2, the drive {folder}", "file": str(made[0])}]
        assert state["state"] == "idle" and not list(folder.glob("*.uf2"))
        with pytest.raises(Denied, match="there is no board"):
            page.post("flash", board="drive /elsewhere")
        page.post("flash", board=id)
        with pytest.raises(Denied, match="a board is being written"):
            page.post("generate")
        restarting(folder)()
        state = page.until(lambda state: state["flash"]["state"] != "running")["flash"]
        assert state["state"] == "done" and state["boards"] is None
        with pytest.raises(Denied, match="there is no board"):
            page.post("flash", board=id)
