# SPDX-License-Identifier: Apache-2.0
"""`epg connect --terminal` asks the same questions in a pipe and in a terminal, and writes the same files."""

from __future__ import annotations

import io
import os
import re
import select
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.connect.session import Session
from epg.connect.terminal.console import Console
from epg.connect.terminal.dialog import run
from tests.connect.builds import processes
from tests.connect.page import session_of
from tests.connect.robots import own_axis_project, with_second_target
from tests.waiting import until

ROOT = Path(__file__).resolve().parents[2]
MODEL = ROOT / "examples/jiwy/model"
Answer = str | Callable[[], object]


class Answers(io.StringIO):
    """The user's lines; a function among them is called before the next line is read."""

    def __init__(self, *answers: Answer) -> None:
        super().__init__()
        self.left = list(answers)

    def readline(self, size: int | None = -1, /) -> str:
        while self.left:
            answer = self.left.pop(0)
            if isinstance(answer, str):
                return f"{answer}\n"
            answer()
        return ""


def talk(session: Session, *answers: Answer) -> tuple[int, str]:
    """The exit status, and the whole output."""
    output = io.StringIO()
    given = Answers(*answers)
    status = run(session, given, output)
    assert not given.left, f"nobody has asked for {given.left}\n{output.getvalue()}"
    return status, output.getvalue()


def status_without_build(said: str) -> int:
    """The exit status of a dialog that has saved and ends without a build: a missing SDK is a mistake."""
    return 1 if "[tool-missing]" in said else 0


def open_ports(bindings: Path, *names: str) -> str:
    """Removes ports from a file; returns its new text."""
    lines = bindings.read_text().splitlines(keepends=True)
    text = "".join(line for line in lines if line.strip().partition(":")[0] not in names)
    bindings.write_text(text)
    return text


@pytest.fixture
def export(tmp_path: Path) -> Path:
    """A model without a project."""
    return Path(shutil.copytree(MODEL, tmp_path / "servo_export"))


def snapshot(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file() and "build" not in path.relative_to(folder).parts)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


# from a model to a program --------------------------------------------------------------------------------------------


def test_from_a_model_to_a_program_by_answers_from_a_file(export: Path, tmp_path: Path) -> None:
    answers = [
        "jiwy",
        "host_jiwy",
        str(tmp_path / "robot"),
        "pan_tilt",
        "setpoint_p",
        "c",
        "tilt",
        "1/4",
        "0.5",
        "",
        "-1 1",
    ]
    answers += ["pan_l", "-", "", "y", "y"]
    command = [sys.executable, "-m", "epg", "connect", "--terminal", str(export)]
    done = subprocess.run(
        command, cwd=ROOT, input="\n".join(answers) + "\n", capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stderr == ""
    (program,) = re.findall(r"^(/.*/pan_tilt_host)$", done.stdout, re.MULTILINE)
    ran = subprocess.run([program, "--duration", "0.1"], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr

    session = Session([], model=export)
    body = {"configuration": "host_jiwy", "folder": str(tmp_path / "page"), "name": "pan_tilt"}
    session.act("create", body)
    end = {"reference": "tilt_subscriber", "scale": "1/4", "offset": "0.5", "limits": ["-1", "1"]}
    session.act("connect", {"port": "setpoint_pan", "ends": [end]})
    session.act("connect", {"port": "pan_logging", "ends": []})
    session.act("save", {})
    assert snapshot(tmp_path / "robot") == snapshot(tmp_path / "page"), "terminal and page write the same"
    bindings = (tmp_path / "robot/pan_tilt.bindings.yaml").read_text()
    assert "setpoint_pan: {from: tilt_subscriber, scale: 1/4, offset: 0.5, limits: [-1, 1]}\n" in bindings


@pytest.mark.skipif(sys.platform == "win32", reason="this system has no pseudo-terminals")
def test_in_a_terminal_a_build_takes_one_line(export: Path, tmp_path: Path) -> None:
    import pty
    import termios

    parent, child = pty.openpty()
    settings = termios.tcgetattr(child)
    settings[3] &= ~termios.ECHO
    termios.tcsetattr(child, termios.TCSANOW, settings)
    termios.tcsetwinsize(child, (40, 100)) if sys.version_info >= (3, 11) else None
    command = [sys.executable, "-m", "epg", "connect", "--terminal", str(export)]
    process = subprocess.Popen(command, cwd=ROOT, stdin=child, stdout=child, stderr=child, close_fds=True)
    os.close(child)
    dialog = [
        ("or q: ", "host_jiwy"),
        ("new project", str(tmp_path / "robot")),
        ("name of the target [robot]: ", ""),
        ("to continue: ", ""),
        ("build? (y/n) [y]: ", ""),
    ]
    seen = ""

    def ended() -> bool:
        nonlocal seen
        if dialog and dialog[0][0] in seen.rpartition("\n")[2]:
            os.write(parent, f"{dialog.pop(0)[1]}\n".encode())
        if select.select([parent], [], [], 0.1)[0]:
            try:
                seen += os.read(parent, 65536).decode().replace("\r\n", "\n")
            except OSError:  # the other end is closed
                return True
        return False

    until(ended, lambda: seen, 240, pause=0.0)
    os.close(parent)
    assert process.wait(10) == 0, seen
    assert not dialog
    progress = re.findall(r"\rbuild (\d+)/(\d+), \d+ s", seen)
    assert len(progress) > 3 and progress == sorted(progress, key=lambda found: int(found[0]))
    assert "\n" not in seen[seen.index("\rbuild ") : seen.rindex("\rbuild ")], "one line"
    assert (tmp_path / "robot/build/robot_host").is_file() and "robot_host\n" in seen


@pytest.mark.skipif(not Path("/proc/self/cmdline").exists(), reason="this system does not list processes in /proc")
def test_ctrl_c_cancels_the_build(export: Path, tmp_path: Path) -> None:
    answers = ["host_jiwy", str(tmp_path / "robot"), "", "", "y"]
    command = [sys.executable, "-m", "epg", "connect", "--terminal", str(export)]
    process = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdin is not None and process.stdout is not None
    process.stdin.write("\n".join(answers) + "\n")
    process.stdin.flush()
    for line in process.stdout:
        if line == "build ...\n":
            break
    process.send_signal(signal.SIGINT)
    rest = process.stdout.read()
    assert process.wait(20) == 1
    assert rest == "the build was cancelled\n"
    assert processes(tmp_path / "robot") == []
    process.stdin.close()
    process.stdout.close()


def test_missing_tools_are_shown_before_the_question(project: Path, tmp_path: Path) -> None:
    places = {"HOME": str(tmp_path / "home"), "EPG_CACHE": str(tmp_path / "cache")}
    environment = {name: value for name, value in os.environ.items() if name != "PICO_SDK_PATH"} | places
    command = [sys.executable, "-m", "epg", "connect", "--terminal", str(project)]
    done = subprocess.run(command, cwd=ROOT, input="\nn\n", capture_output=True, text=True, env=environment)
    assert "\nerror: Raspberry Pi Pico SDK was not found [tool-missing]\nhint: get it: git clone " in done.stdout
    assert done.stdout.endswith("build anyway? (y/n) [n]: n\n") and done.returncode == 1, done.stdout[-500:]
    assert not (project / "build").exists()


# ports ----------------------------------------------------------------------------------------------------------------


def test_enter_takes_proposals_and_the_rest_of_the_file_stays(project: Path, bindings: Path) -> None:
    whole = bindings.read_text()
    text = open_ports(bindings, "setpoint_pan", "pwm_tilt")
    status, said = talk(session_of(project), "", "", "", "y", "n")
    assert status == status_without_build(said), said
    assert "setpoint_pan <- [pan_subscriber]: " in said and "pwm_tilt -> [pwm_tilt]: " in said
    assert "10 ports, 2 of them to connect" in said
    added = [line for line in bindings.read_text().splitlines() if line not in text.splitlines()]
    assert sorted(added) == ["  pwm_tilt: pwm_tilt", "  setpoint_pan: pan_subscriber"]
    # `epg bind` has also proposed what the setpoint follows; the terminal binds, and no more.
    bound = whole.replace("{from: pan_subscriber, follows: position_pan}", "pan_subscriber")
    assert sorted(bindings.read_text().splitlines()) == sorted(bound.splitlines())


def test_parts_that_no_port_uses_are_left_out(one_axis: Path) -> None:
    status, said = talk(session_of(one_axis), "", "y", "y", "n")
    assert status == status_without_build(said), said
    assert "no port uses encoder_tilt, pwm_tilt, guard_tilt, " in said and "guard_pan.homing: leave them out?" in said
    assert "  guard_pan: {homing: null}\n" in (one_axis / "robot.tcf").read_text()


def test_numbers_names_and_as_much_of_a_name_as_no_other_has(project: Path, bindings: Path) -> None:
    open_ports(bindings, "setpoint_pan", "setpoint_tilt", "pwm_pan")
    status, said = talk(session_of(project), "4", "nothing", "enc", "pan", "pwm", "pwm_p", "", "y", "n")
    assert status == status_without_build(said), said
    assert "there is no candidate 'nothing'" in said
    assert "which one: encoder_pan, encoder_tilt?" in said and "which one: pwm_pan, pwm_tilt?" in said
    text = bindings.read_text()
    for line in ("setpoint_pan: tilt_subscriber", "setpoint_tilt: pan_subscriber", "pwm_pan: pwm_pan"):
        assert f"  {line}\n" in text


def test_outputs_can_be_unconnected_or_have_several_and_inputs_cannot(project: Path, bindings: Path) -> None:
    open_ports(bindings, "setpoint_pan", "pan_logging", "tilt_logging")
    status, said = talk(session_of(project), "-", "", "-", "pan_p, tilt_p", "", "y", "n")
    assert status == status_without_build(said), said
    assert "an input needs a value" in said
    assert "  pan_logging: unconnected\n" in bindings.read_text()
    assert "  tilt_logging: [pan_publisher, tilt_publisher]\n" in bindings.read_text()


def test_candidates_are_explained(project: Path, bindings: Path) -> None:
    open_ports(bindings, "position_pan")
    _, said = talk(session_of(project), "?", "q")
    assert re.search(r"^1  encoder_pan +angle of the load; in rad; quadrature_encoder; a GP10, b", said, re.MULTILINE)
    assert re.search(r"^3  pan_subscriber +.*ros_subscriber", said, re.MULTILINE)


def test_back_undo_and_taking_away(project: Path, bindings: Path) -> None:
    text = open_ports(bindings, "pwm_pan", "pwm_tilt")
    status, said = talk(session_of(project), "pwm_tilt", "b", "u", "", "pan_p", "u", "pwm_p", "d", "", "", "y", "n")
    assert status == status_without_build(said), said
    assert said.count("pwm_pan -> [pwm_tilt]: ") == 1, "the port before, with what it has now"
    assert "undone: pwm_pan -> (open)" in said and "undone: pwm_tilt -> (open)" in said
    added = [line for line in bindings.read_text().splitlines() if line not in text.splitlines()]
    assert added == ["  pwm_pan: pwm_pan"]


def test_leaving_asks_where_something_would_be_lost(project: Path, bindings: Path) -> None:
    text = open_ports(bindings, "pwm_pan")
    assert talk(session_of(project), "q")[0] == 0
    status, said = talk(session_of(project), "", "q", "", "q", "y")
    assert status == 0 and said.count("quit without saving? (y/n) [n]") == 2
    assert bindings.read_text() == text


def test_answers_that_end_save_nothing(project: Path, bindings: Path) -> None:
    text = open_ports(bindings, "pwm_pan")
    status, said = talk(session_of(project), "")
    assert status == 1 and "the input has ended: nothing was saved" in said
    assert bindings.read_text() == text
    assert talk(session_of(project))[0] == 0, "nothing had been changed"


def test_a_conflict_is_said_at_once_as_the_command_line_says_it(
    project: Path, bindings: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    open_ports(bindings, "pwm_pan")
    status, said = talk(session_of(project), "pwm_tilt", "", "y")
    assert status == 1 and "there are errors: the project cannot be built" in said
    monkeypatch.chdir(project)
    check = ["check", "--tcf", "robot.tcf", "--model", "model", "--bindings", "robot.bindings.yaml"]
    assert main(check) == 1
    expected = [re.sub(r"\^~*", "^", line) for line in capsys.readouterr().err.splitlines()]
    assert len(expected) > 6 and "bound-twice" in expected[0]
    after = said[said.index("[pwm_pan]: pwm_tilt\n") :]
    assert "\n".join(expected) in after[: after.index("\nport ")], "before the table"


def test_what_does_not_fit_is_refused_in_epgs_words(project: Path, bindings: Path) -> None:
    open_ports(bindings, "position_pan")
    status, said = talk(session_of(project), "pwm_pan", "", "y")
    assert status == 1 and "[wrong-direction]" in said


def test_conversions_can_be_changed_and_taken_away(project: Path, bindings: Path) -> None:
    answers = ["c", "", "0.5", "1", "", ""]
    talk(session_of(project), "pwm_pan", *answers, "", "y", "n")
    assert "  pwm_pan: {to: pwm_pan, scale: 0.5, offset: 1}\n" in bindings.read_text()
    _, said = talk(session_of(project), "pwm_pan", "c", "", "", "-", "", "", "", "y", "n")
    assert "scale, such as 0.5 or 1/4 [0.5]: " in said
    assert "  pwm_pan: {to: pwm_pan, scale: 0.5}\n" in bindings.read_text()


def test_edits_outside_are_noticed_and_never_overwritten_unasked(project: Path, bindings: Path) -> None:
    open_ports(bindings, "pwm_pan", "pwm_tilt")

    session = session_of(project)

    def edit() -> None:
        bindings.write_text("# mine\n" + bindings.read_text())
        until(lambda: session.wait(session.state()["version"], 1)["draft"]["external"])

    _, said = talk(session, "", edit, "", "", "y", "n")
    assert "another program changed" in " ".join(said.split())
    assert ": your change was applied to the new text" in " ".join(said.split())
    text = bindings.read_text()
    assert text.startswith("# mine\n") and "  pwm_pan: pwm_pan\n" in text and "  pwm_tilt: pwm_tilt\n" in text


def test_a_conflict_with_edits_outside_is_asked_about(project: Path, bindings: Path) -> None:
    text = open_ports(bindings, "pwm_pan", "pwm_tilt")
    theirs = "inputs: ["  # no change can be applied to this text

    session = session_of(project)

    def edit() -> None:
        bindings.write_text(theirs)
        until(lambda: session.wait(session.state()["version"], 1)["draft"]["conflict"])

    status, said = talk(session, "", "", edit, "", "y", "")
    assert status == 1 and "save anyway, and overwrite the other program's changes? (y/n) [n]" in said
    assert bindings.read_text() == theirs
    bindings.write_text(text)
    status, said = talk(session_of(project), "", "", edit, "", "y", "y", "n")
    assert status == status_without_build(said), said
    assert "  pwm_pan: pwm_pan\n" in bindings.read_text()


def test_bindings_that_need_an_editor(project: Path, bindings: Path) -> None:
    bindings.write_text("inputs: [")
    status, said = talk(session_of(project))
    assert status == 1 and "must first be corrected in an editor" in said and "robot.bindings.yaml:1:9: error: " in said


def test_one_of_several_targets(project: Path) -> None:
    text = (project / "CMakeLists.txt").read_text()
    again = text[text.index("epg_add_target(") : text.index("epg_add_executable(")].replace("(robot", "(second", 1)
    (project / "CMakeLists.txt").write_text(text + again)
    _, said = talk(session_of(project), "s", "q")
    assert "target [robot]: s\n" in said and "\nsecond: model with robot.tcf" in said


# places and words -----------------------------------------------------------------------------------------------------


def test_folders_and_names_that_cannot_be_are_asked_for_again(export: Path, project: Path, tmp_path: Path) -> None:
    before = snapshot(project)
    answers = ["host_jiwy", str(project), "robot", str(tmp_path / "new"), "", str(tmp_path / "another"), "", "", "n"]
    status, said = talk(Session([], model=export), *answers)
    assert status == 0, said
    assert "this folder already has files of the project" in said, said
    assert "error: target 'new' is a reserved word of C or C++" in said
    assert snapshot(project) == before and not (tmp_path / "new").exists()
    assert (tmp_path / "another/another.tcf").is_file(), "called after its folder"


def test_choosing_filters_and_says_what_nothing_has(export: Path) -> None:
    status, said = talk(Session([], model=export), "pico2 freertos", "quantum", "q")
    assert status == 0
    filtered = said[said.index("pico2 freertos\n") : said.index("quantum")]
    names = re.findall(r"^ *\d+  (\S+)", filtered, re.MULTILINE)
    names = [name for name in names if "_w_" not in name]
    assert names == ["rpi_pico2_freertos_jiwy", "rpi_pico2_freertos", "rpi_pico2_freertos_relbot"], "best first"
    assert "no target matches 'quantum'" in said


def test_lines_fit_80_columns_and_any_encoding(project: Path, bindings: Path) -> None:
    open_ports(bindings, "pwm_pan")
    raw = io.BytesIO()
    output = io.TextIOWrapper(raw, encoding="ascii")
    given = Answers("?", "h", "c", "", "1/2", "", "", "", "", "n")
    assert run(session_of(project), given, output) == 1
    output.flush()
    lines = raw.getvalue().decode("ascii").splitlines()
    assert [line for line in lines if len(line) > 80] == []
    assert any("?1/2" in line for line in lines), "a sign that the encoding has not"


def test_a_terminal_obeys_no_text_of_a_file() -> None:
    output = io.StringIO()
    console = Console(io.StringIO("\x1b[2J\n"), output)
    console.say("a\x1b[31m\rb")
    console.table(("", ""), [("1", "c\x07")])
    assert console.ask("d\x1b[0m", "") == "\x1b[2J"
    assert output.getvalue() == "a?[31m?b\n1  c?\nd?[0m: ?[2J\n"


def test_errors_in_other_targets_are_listed_before_saving(tmp_path: Path) -> None:
    folder = with_second_target(own_axis_project(tmp_path))
    session = session_of(folder)
    session.act("connect", {"port": "setpoint_x", "ends": [{"reference": "end_x"}]})
    session.act("connect", {"port": "position_x", "ends": [{"reference": "end_x"}]})
    session.act("remove", {"component": "position_x"})
    before = (folder / "robot.tcf").read_text()
    status, output = talk(session, "", "", "y", "n")
    assert status != 0 and "second: error: there is no component 'position_x'" in output
    assert (folder / "robot.tcf").read_text() == before
    talk(session, "", "", "y", "y", "n")
    assert "  position_x:" not in (folder / "robot.tcf").read_text()
