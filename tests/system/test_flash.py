# SPDX-License-Identifier: Apache-2.0
"""The images of a system are written to the right boards, or to none.

Stand-ins for picotool, OpenOCD and STM32CubeProgrammer run here.  They check their arguments: picotool's as the real
one of version 2.2.0 does, which accepts the options that choose a board only one after the other.  A file describes the
boards.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.cmake import PathNames
from epg.generator.emit.outputs import application_outputs
from epg.generator.tools import usb_boards
from epg.system import flash
from epg.system.check_system import check_system
from epg.system.images import images_of
from epg.system.load_system import load_system
from tests.cmake.project import ROOT, copy_jiwy

FIRST, SECOND = "E6614103E7452D2F", "E66118604B5A7C31"
PROBE = "066AFF555054877567044634"
SYSTEM = f"""version: 1
system: three
targets:
  leader: {{tcf: rpi_pico_bare_metal_jiwy, model: model, bindings: jiwy.bindings.yaml, serial: {FIRST}}}
  follower: {{tcf: rpi_pico2_freertos_jiwy, model: model, bindings: jiwy.bindings.yaml, serial: {SECOND}}}
  third: {{tcf: nucleo_h743zi_bare_metal_jiwy, model: model, bindings: jiwy.bindings.yaml, probe: {PROBE}}}
connections:
  - {{from: leader/pan_publisher, to: [follower/pan_subscriber, third/pan_subscriber]}}
  - {{from: leader/tilt_publisher, to: [follower/tilt_subscriber, third/tilt_subscriber]}}
world: {{sends: [leader/pan_subscriber, leader/tilt_subscriber]}}
"""

PICOTOOL = r"""
import json, os, re, sys
here = os.path.dirname(os.path.abspath(__file__))
boards = json.load(open(os.path.join(here, "boards.json")))
words = sys.argv[1:]
print(*["picotool", *words], sep="\t", file=open(os.path.join(here, "log.txt"), "a"))

def end(text, status):
    print(text)
    json.dump(boards, open(os.path.join(here, "boards.json"), "w"))
    sys.exit(status)

# sources of picotool 2.2.0: the options of a command, its file, then those that choose the board
line = " ".join(words)
choice = r"( --ser (\w+)| --bus (\d+) --address (\d+))"
match = re.fullmatch(r"(info -a|reboot|reboot -u -f|load -v -x (\S+\.elf))" + choice, line)
if match is None:
    end("\nERROR: unexpected option: " + words[-1], 255)
if boards["no usb"]:
    end("This version of picotool was compiled without USB support. Some commands are not\navailable.", 255)
verb, image, serial, place = words[0], match[2], match[4], [match[5], match[6]]
chosen = [b for b in boards["picos"] if (b["serial"] == serial if serial else b.get("place") == place)]
ready = [b for b in chosen if b["bootsel"]]
if verb == "reboot" and "-f" in words:
    if len(chosen) != 1 or chosen[0].get("foreign"):
        end("No accessible RP-series devices in BOOTSEL mode were found found with serial\nnumber " + serial + ".", 249)
    chosen[0]["bootsel"] = 1 + boards["slow"]
    end("\nThe device was rebooted into BOOTSEL mode.\n", 0)
if ready and ready[0]["bootsel"] > 1:
    ready[0]["bootsel"] -= 1
    ready = []
if len(ready) != 1:
    end("No accessible RP-series devices in BOOTSEL mode were found found with serial\nnumber %s." % serial, 249)
if verb == "reboot":
    ready[0]["bootsel"] = 0
    end("The device was rebooted into application mode.\n", 0)
if verb == "load":
    if boards["broken"] == serial:
        end("ERROR: The RP2040 device returned an error: not permitted", 1)
    ready[0] |= {"bootsel": 0, "image": image}
    end("Loading into Flash:   [==============================]  100%", 0)
features = "EPG 0.1.0 target %s f2e32e0041e79a7e" % ready[0]["program"]
program = " name:              some_firmware\n features:          %s" % features if ready[0]["program"] else " none"
text = "Program Information\n%s\n\nMetadata Block 1\n image type:        ARM Secure\n\nDevice Information\n" % program
end(text + " type:              %s\n flash id:          0x%s" % (ready[0]["chip"], ready[0]["serial"]), 0)
"""

OPENOCD = r"""
import json, os, re, sys
here = os.path.dirname(os.path.abspath(__file__))
boards = json.load(open(os.path.join(here, "boards.json")))
words = sys.argv[1:]
print(*["openocd", *words], sep="\t", file=open(os.path.join(here, "log.txt"), "a"))
print("Open On-Chip Debugger 0.12.0", file=sys.stderr)
assert words[0::2] == ["-f", "-c", "-c"], words
assert re.fullmatch(r"board/st_nucleo_\w+\.cfg", words[1]), words
board = [b for b in boards["nucleos"] if words[3] == "adapter serial " + b["probe"]]
if not board:
    print("Error: open failed\n\n", file=sys.stderr)
    sys.exit(1)
if words[5] == "init; mdw 0x5c001000; shutdown":
    print("0x5c001000: %s \n" % board[0]["idcode"], file=sys.stderr)
    print("shutdown command invoked", file=sys.stderr)
else:
    match = re.fullmatch(r"program {(.+\.elf)} verify reset exit", words[5])
    assert match and os.path.isfile(match[1]), words
    board[0]["image"] = match[1]
    json.dump(boards, open(os.path.join(here, "boards.json"), "w"))
"""

PROGRAMMER = r"""
import json, os, re, sys
here = os.path.dirname(os.path.abspath(__file__))
boards = json.load(open(os.path.join(here, "boards.json")))
words = sys.argv[1:]
if words == ["--version"]:
    sys.exit(print("STM32CubeProgrammer version: 2.15.0"))
print(*["STM32_Programmer_CLI", *words], sep="\t", file=open(os.path.join(here, "log.txt"), "a"))
# user manual UM2237, 3.2
match = re.fullmatch(r"-c port=SWD( mode=HOTPLUG)? sn=(\w+)( -w (\S+\.elf) -v -rst)?", " ".join(words))
assert match and bool(match[1]) != bool(match[3]), words
board = [b for b in boards["nucleos"] if b["probe"] == match[2]]
if not board:
    sys.exit(print("Error: No debug probe detected.") or 1)
print("ST-LINK SN  : %s\nDevice ID   : 0x%s\nDevice name : STM32" % (match[2], board[0]["idcode"][-3:]))
if match[4]:
    assert os.path.isfile(match[4]), words
    board[0]["image"] = match[4]
    json.dump(boards, open(os.path.join(here, "boards.json"), "w"))
"""
PROGRAMMER_PLACE = "STMicroelectronics/STM32Cube/STM32CubeProgrammer/bin"
"""The folder of STM32CubeProgrammer in the home folder."""


def stand_in(folder: Path, name: str, text: str, place: Path | None = None) -> None:
    """The program ``name`` in ``place``, or in ``folder``, where its script and its data are."""
    (folder / f"{name}.py").write_text(text)
    program = (place or folder) / name
    program.parent.mkdir(parents=True, exist_ok=True)
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{folder / name}.py" "$@"\n')
    program.chmod(0o755)


WATCHER = """targets:
  watcher: {tcf: host_jiwy, model: model, bindings: jiwy.bindings.yaml, set: {communication: {middleware: xrce}}}
"""
WORLD = "sends: [watcher/pan_subscriber, watcher/tilt_subscriber, "


@dataclass
class Bench:
    """A table with boards.  The tools read and change ``boards.json``, and write their arguments into ``log.txt``."""

    folder: Path

    @property
    def system(self) -> Path:
        return self.folder / "three.system.yaml"

    @property
    def boards(self) -> dict:
        return json.loads((self.folder / "tools/boards.json").read_text())

    def change(self, **values: object) -> None:
        (self.folder / "tools/boards.json").write_text(json.dumps(self.boards | values))

    def edit(self, old: str, new: str) -> None:
        text = self.system.read_text()
        assert old in text
        self.system.write_text(text.replace(old, new))

    def calls(self) -> list[list[str]]:
        """The commands that ran."""
        log = self.folder / "tools/log.txt"
        return [line.split("\t") for line in log.read_text().splitlines()] if log.exists() else []

    def written(self) -> dict[str, str]:
        """The images that were written, by serial number."""
        boards = [
            (b.get("serial") or b["probe"], b.get("image")) for b in self.boards["picos"] + self.boards["nucleos"]
        ]
        return {number: Path(image).stem for number, image in boards if image}

    def build(self, *names: str) -> None:
        """Writes images as a build would: programs that contain the hash of their target."""
        kept = HASHES.setdefault(re.sub(r", (serial|probe): \w+", "", self.system.read_text()), {})
        for name in names:
            if name not in kept:
                kept.update(hashes(self.system))
            folder = self.folder / "build/three_images" / name
            folder.mkdir(parents=True, exist_ok=True)
            (folder / f"{name}_firmware.elf").write_bytes(b"\x7fELF" + kept[name].encode())
            (folder / "bs2_default.elf").write_bytes(b"\x7fELF")


HASHES: dict[str, dict[str, str]] = {}
"""The hashes of targets, by the text of the system without serial numbers."""


def hashes(path: Path) -> dict[str, str]:
    """The hashes of the targets with images."""
    diagnostics = Diagnostics()
    system = load_system(path, diagnostics)
    assert system is not None
    checked = check_system(system, (), diagnostics)
    assert checked is not None, [item.message for item in diagnostics]
    found = {}
    for name in (name for name, _, _ in images_of(checked)):
        files = application_outputs(checked.applications[name], checked.loader.roots, PathNames(None))
        found[name] = json.loads(files[f"{name}.json"])["hash"]
    return found


def usb(folder: Path, name: str, **facts: str) -> None:
    (folder / name).mkdir(parents=True)
    for key, text in facts.items():
        (folder / name / key).write_text(f"{text}\n")


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    copy_jiwy(tmp_path, "model")
    tools = tmp_path / "tools"
    tools.mkdir()
    stand_in(tools, "picotool", PICOTOOL)
    stand_in(tools, "openocd", OPENOCD)
    made = Bench(tmp_path)
    made.system.write_text(SYSTEM)
    first = {"serial": FIRST, "chip": "RP2040", "bootsel": 0, "program": "leader"}
    second = {"serial": SECOND, "chip": "RP2350", "bootsel": 1, "program": ""}
    boards = {"picos": [first, second], "nucleos": [{"probe": PROBE, "idcode": "10036450"}]}
    (tools / "boards.json").write_text(json.dumps(boards | {"broken": "", "no usb": False, "slow": 0}))
    monkeypatch.setenv("PATH", f"{tools}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setattr(usb_boards, "DEVICES", tmp_path / "usb")
    monkeypatch.setattr(flash, "_PAUSE", 0.0)
    return made


def attach(bench: Bench) -> None:
    """Attaches the boards in a way that Linux lists them."""
    folder = bench.folder / "usb"
    usb(folder, "1-1", idVendor="2e8a", idProduct="000a", serial=FIRST, product="Pico", busnum="1", devnum="5")
    usb(folder, "1-2", idVendor="2e8a", idProduct="000f", serial=SECOND, product="RP2350 Boot", busnum="1", devnum="6")
    usb(folder, "1-3", idVendor="0483", idProduct="374e", serial=PROBE, product="STLINK-V3", busnum="1", devnum="7")
    usb(folder, "1-4", idVendor="046d", idProduct="c31c", product="Keyboard", busnum="1", devnum="8")
    usb(folder, "1-4:1.0", bInterfaceClass="03")


def commands(output: str) -> list[list[str]]:
    """The commands that EPG printed."""
    return [shlex.split(line, comments=True) for line in output.splitlines() if line.startswith(("pico", "open"))]


def run(bench: Bench, *arguments: str, status: int = 0) -> None:
    assert main(["flash", str(bench.system), *arguments]) == status


def test_all_boards(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    attach(bench)
    bench.change(slow=3)  # a board needs some time after a restart
    bench.build("leader", "follower", "third")
    run(bench)
    assert bench.written() == {FIRST: "leader_firmware", SECOND: "follower_firmware", PROBE: "third_firmware"}
    verbs = [call[1] if call[0] == "picotool" else "-f" for call in bench.calls()]
    assert verbs == ["info", "info", "-f", "reboot", *["info"] * 4, "load", "load", "-f"]
    assert "flashed leader, follower, third" in capfd.readouterr().out


def test_a_dry_run_prints_the_commands_and_runs_none(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    bench.build("leader", "follower", "third")
    run(bench, "--dry-run")
    planned = commands(capfd.readouterr().out)
    assert not bench.calls() and not bench.written()
    images = bench.folder / "build/three_images"
    probe = ["openocd", "-f", "board/st_nucleo_h743zi.cfg", "-c", f"adapter serial {PROBE}", "-c"]
    assert planned == [
        ["picotool", "info", "-a", "--ser", FIRST],
        ["picotool", "info", "-a", "--ser", SECOND],
        [*probe, "init; mdw 0x5c001000; shutdown"],
        ["picotool", "reboot", "-u", "-f", "--ser", FIRST],
        ["picotool", "info", "-a", "--ser", FIRST],
        ["picotool", "reboot", "-u", "-f", "--ser", SECOND],
        ["picotool", "info", "-a", "--ser", SECOND],
        ["picotool", "load", "-v", "-x", f"{images}/leader/leader_firmware.elf", "--ser", FIRST],
        ["picotool", "load", "-v", "-x", f"{images}/follower/follower_firmware.elf", "--ser", SECOND],
        [*probe, f"program {{{images}/third/third_firmware.elf}} verify reset exit"],
    ]
    bench.change(picos=[board | {"bootsel": 0} for board in bench.boards["picos"]])
    run(bench)
    assert commands(capfd.readouterr().out) == bench.calls() == planned


def test_the_page(bench: Bench, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """docs/systems.md shows a dry run of its example."""
    page = (ROOT / "docs/systems.md").read_text()
    system = page.split("<!-- two jiwys -->\n```yaml\n")[1].split("```")[0]
    for target, serial in (("leader", FIRST), ("follower", SECOND)):
        system = system.replace(f"  {target}: {{", f"  {target}: {{serial: {serial}, ")
    path = bench.folder / "two_jiwys.system.yaml"
    path.write_text(system)
    monkeypatch.chdir(bench.folder)
    for target, hash in hashes(path).items():
        folder = Path("build/two_jiwys_images") / target
        folder.mkdir(parents=True)
        (folder / f"{target}_firmware.elf").write_text(hash)
    command = re.search(r"epg (flash .*)", page)
    assert command is not None and main(command[1].split()) == 0
    assert capfd.readouterr().out in page and SECOND in page


def test_one_target(bench: Bench) -> None:
    bench.build("third")
    run(bench, "--target", "third")
    assert bench.written() == {PROBE: "third_firmware"}


def test_a_wrong_chip(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    bench.build("leader", "follower", "third")
    bench.change(nucleos=[{"probe": PROBE, "idcode": "10016451"}])
    run(bench, status=1)
    text = capfd.readouterr().err
    assert (
        f"{bench.system}:6:3: error: the board {PROBE} has the chip 451, but 'third' is for the STM32H743, which is 450"
        in text
    )
    assert not bench.written()
    assert not any("reboot" in call for call in bench.calls()), "no program was disturbed"


def test_a_board_of_another_target(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    """The restarted board starts its program again."""
    bench.build("leader")
    boards = bench.boards["picos"]
    bench.change(picos=[boards[0] | {"program": "follower"}, boards[1]])
    run(bench, "--target", "leader", status=1)
    text = capfd.readouterr().err
    assert f"the board {FIRST} has the program of the target 'follower', and not of 'leader'" in text
    assert "add --replace" in text
    assert not bench.written() and bench.boards["picos"][0]["bootsel"] == 0
    assert bench.calls()[-1] == ["picotool", "reboot", "--ser", FIRST]
    run(bench, "--target", "leader", "--replace")
    assert bench.written() == {FIRST: "leader_firmware"}


def test_a_board_that_is_not_attached(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    attach(bench)
    bench.edit(FIRST, FIRST.replace("E661", "E660").lower())
    bench.build("leader", "follower", "third")
    run(bench, status=1)
    text = capfd.readouterr().err
    assert "the board E6604103E7452D2F of 'leader' does not answer" in text
    assert f"hold BOOTSEL while you plug it in; attached are {FIRST} (Pico), {SECOND} (RP2350 Boot)" in text
    assert not bench.written() and not any("reboot" in call for call in bench.calls())


def test_a_board_that_cannot_be_restarted(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    bench.build("leader", "follower", "third")
    bench.change(picos=[board | {"foreign": True} for board in bench.boards["picos"]])
    run(bench, "--target", "leader", status=1)
    assert "hold BOOTSEL while you plug it in" in capfd.readouterr().err
    assert not bench.written()


def test_a_failure_while_writing(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    bench.build("leader", "follower", "third")
    bench.change(broken=SECOND)
    run(bench, status=1)
    output = capfd.readouterr()
    assert "the image of 'follower' was not written: picotool ended with status 1" in output.err
    assert "hint: written: leader. not written: third. correct the error" in output.err
    assert "not permitted" in output.err and set(bench.written()) == {FIRST}


def test_boards_without_names(bench: Bench, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """One target and one fitting board need no serial number."""
    bench.edit(f", serial: {FIRST}", "")
    bench.edit(f", probe: {PROBE}", "")
    bench.build("leader", "follower", "third")
    run(bench, "--target", "third", status=1)
    assert "EPG lists attached boards on Linux and Windows only" in capfd.readouterr().err
    windows = [f"USB\\VID_0483&PID_374E\\{PROBE}", r"USB\VID_0483&PID_374E&MI_00\6&2B1A&0&0000", r"USB\ROOT_HUB30\4&1"]
    with monkeypatch.context() as of_windows:
        of_windows.setattr(usb_boards.here, "usb_devices", lambda: windows)
        run(bench, "--target", "third")
    assert bench.written() == {PROBE: "third_firmware"}
    attach(bench)
    run(bench, "--target", "third")
    run(bench, "--target", "leader", status=1)
    text = capfd.readouterr().err
    assert "the board of 'leader' is not known: the system has 2 targets for such boards" in text
    assert f"write 'serial: <serial number>' for it in the system file; attached are {FIRST} (Pico)" in text
    usb(bench.folder / "usb", "1-9", idVendor="0483", idProduct="374b", serial="0670FF", product="ST-LINK/V2.1")
    run(bench, "--target", "third", status=1)
    assert "2 fitting boards are attached" in capfd.readouterr().err


def test_a_new_board_without_a_name(bench: Bench) -> None:
    """An RP2040 in BOOTSEL mode has no serial number on USB: it is chosen by its place there."""
    bench.edit(f", serial: {FIRST}", "")
    bench.edit("rpi_pico2_freertos_jiwy", "nucleo_f767zi_bare_metal_jiwy")
    bench.build("leader")
    new = {"serial": FIRST, "chip": "RP2040", "bootsel": 1, "program": "", "place": ["1", "5"]}
    bench.change(picos=[new])
    usb(bench.folder / "usb", "1-1", idVendor="2e8a", idProduct="0003", serial="E0C9125B0D9B", busnum="1", devnum="5")
    run(bench, "--target", "leader")
    assert bench.written() == {FIRST: "leader_firmware"}
    assert bench.calls()[-1][-4:] == ["--bus", "1", "--address", "5"]


def test_an_image_of_other_files(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    bench.build("leader", "follower", "third")
    bench.edit("system: three", "# a comment\nsystem: three")
    run(bench, "--dry-run")
    bench.edit("targets:\n", WATCHER)
    bench.edit("sends: [", WORLD)
    run(bench, "--dry-run", "--target", "third")
    run(bench, "--target", "watcher", status=1)
    assert "EPG cannot flash 'watcher': EPG builds no image for the platform 'host'" in capfd.readouterr().err
    bench.edit("third: {", "third: {set: {node: other}, ")
    run(bench, status=1)
    text = capfd.readouterr().err
    assert text.count("was not built from the files as they are now") == 1
    assert not bench.calls()


def test_an_image_of_a_project_of_the_users_own(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    """The project's call can have other arguments, so the hash is that of its build."""
    folder = bench.folder / "build/three_images/third"
    (folder / "epg/third").mkdir(parents=True)
    (folder / "robot.elf").write_text("0123456789abcdef")
    (folder / "epg/third/third.json").write_text('{"hash": "0123456789abcdef"}')
    run(bench, "--target", "third", status=1)
    assert "[image-outdated]" in capfd.readouterr().err
    (bench.folder / "firmware").mkdir()
    (bench.folder / "firmware/CMakeLists.txt").touch()
    bench.edit("third: {", "third: {project: firmware, ")
    run(bench, "--target", "third")
    assert bench.written() == {PROBE: "robot"}


def test_tools_that_are_missing(
    bench: Bench, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.build("leader", "follower", "third")
    bench.change(**{"no usb": True})
    run(bench, "--target", "leader", status=4)
    text = capfd.readouterr().err
    assert "picotool cannot reach boards: it was built without USB. Get it:" in text and "libusb" in text
    (bench.folder / "tools/openocd").unlink()
    monkeypatch.setenv("PATH", str(bench.folder / "tools"))
    run(bench, "--target", "third", status=4)
    assert re.search(r"the program openocd was not found\. Get it:\n  .*openocd", capfd.readouterr().err)
    run(bench, "--target", "third", "--dry-run")


def test_stm32cubeprogrammer_is_used_where_openocd_is_missing(
    bench: Bench, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.build("third")
    monkeypatch.setenv("HOME", str(bench.folder / "home"))
    monkeypatch.setenv("PATH", str(bench.folder / "tools"))
    stand_in(bench.folder / "tools", "STM32_Programmer_CLI", PROGRAMMER, bench.folder / "home" / PROGRAMMER_PLACE)
    run(bench, "--target", "third")
    assert [call[0] for call in bench.calls()] == ["openocd", "openocd"]
    (bench.folder / "tools/openocd").unlink()
    bench.change(nucleos=[{"probe": PROBE, "idcode": "10016451"}])
    run(bench, "--target", "third", status=1)
    assert "has the chip 451, but 'third' is for the STM32H743, which is 450" in capfd.readouterr().err
    bench.change(nucleos=[{"probe": PROBE, "idcode": "10036450"}])
    run(bench, "--target", "third")
    assert bench.written() == {PROBE: "third_firmware"}
    image = bench.folder / "build/three_images/third/third_firmware.elf"
    program = ["STM32_Programmer_CLI", "-c", "port=SWD"]
    find, write = [*program, "mode=HOTPLUG", f"sn={PROBE}"], [*program, f"sn={PROBE}", "-w", f"{image}", "-v", "-rst"]
    assert bench.calls()[2:] == [find, find, write]
    bench.change(nucleos=[])
    run(bench, "--target", "third", status=1)
    assert f"the board {PROBE} of 'third' does not answer: Error: No debug probe detected." in capfd.readouterr().err


def test_json(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    bench.build("leader", "follower", "third")
    run(bench, "--dry-run", "--json")
    data = json.loads(capfd.readouterr().out)
    assert [board["board"] for board in data["boards"]] == [FIRST, SECOND, PROBE]
    assert sum(" load " in command for command in data["commands"]) == 2
    run(bench, "--target", "follower", "--json")
    data = json.loads(capfd.readouterr().out)
    assert [command.split()[1] for command in data["commands"]] == ["info", "load"]
