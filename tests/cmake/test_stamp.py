# SPDX-License-Identifier: Apache-2.0
"""A configure run starts Python and changes files only if one of its inputs has changed."""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.cmake.project import NINJA, ROOT, Project, snapshot
from tests.doubles.twenty_sim.exports import Export

SITECUSTOMIZE = 'import os\nwith open(os.environ["PYTHON_STARTS"], "a") as log:\n    log.write("start\\n")\n'

KIND = """version: 1
kind: lamp
api: 1
"""


class Watched:
    """A project in which every start of Python is counted."""

    def __init__(self, folder: Path, name: str = "robot") -> None:
        hook = folder / "hook"
        hook.mkdir(parents=True)
        (hook / "sitecustomize.py").write_text(SITECUSTOMIZE)
        self.log = folder / "starts"
        self.user_folder = folder / "user targets"
        (self.user_folder / "robots" / "mine").mkdir(parents=True)
        path = os.pathsep.join(filter(None, (str(hook), os.environ.get("PYTHONPATH"))))
        environment = {"PYTHONPATH": path, "PYTHON_STARTS": str(self.log), "EPG_TARGETS_PATH": str(self.user_folder)}
        self.project = Project(folder, name, environment)
        # Project() hides EPG_TARGETS_PATH of the environment and then adds this one
        self.outputs = self.project.build_folder / "epg"

    def configure(self, *arguments: str, **options: object) -> int:
        """Configures; returns the number of starts of Python."""
        time.sleep(0.02)  # earlier edits must be older than the files that follow
        self.log.unlink(missing_ok=True)
        self.output = self.project.configure(*arguments, **options)  # type: ignore[arg-type]
        return len(self.log.read_text().splitlines()) if self.log.exists() else 0

    def times(self) -> dict[str, int]:
        return {str(path): path.stat().st_mtime_ns for path in sorted(self.outputs.rglob("*"))}

    def write(self, path: Path, text: str) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def replace(self, file: str, old: str, new: str) -> None:
        path = self.project.source / file
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new), encoding="utf-8")


@pytest.fixture(scope="module")
def configured(tmp_path_factory: pytest.TempPathFactory) -> Watched:
    watched = Watched(tmp_path_factory.mktemp("robot"))
    assert watched.configure() > 0
    return watched


@pytest.fixture
def robot(configured: Watched) -> Iterator[Watched]:
    """The configured project; afterwards, its files and those of the user's targets are as they were before."""
    trees = [configured.project.source, configured.user_folder]
    before = [snapshot(tree) for tree in trees]
    folders = {path for tree in trees for path in tree.rglob("*") if path.is_dir()}
    configured.configure()
    assert configured.configure() == 0
    yield configured
    for tree, files in zip(trees, before, strict=True):
        for name, content in snapshot(tree).items():
            if files.get(name) != content:
                (tree / name).unlink()
        for path in sorted(tree.rglob("*"), reverse=True):
            if path.is_dir() and path not in folders:
                path.rmdir()
        for name, content in files.items():
            if not (tree / name).is_file():
                (tree / name).write_bytes(content)


@pytest.mark.parametrize("generator", ["Ninja", "Unix Makefiles"])
@pytest.mark.parametrize("name", ["robot", "models"])
def test_an_unchanged_configure_starts_no_python_and_touches_nothing(tmp_path: Path, name: str, generator: str) -> None:
    watched = Watched(tmp_path, name)
    examples = f"-DEXAMPLES={ROOT / 'examples'}"
    assert watched.configure(examples, generator=generator) > 0
    before = watched.times()
    assert before
    assert watched.configure(examples, generator=generator) == 0
    assert watched.times() == before


CHANGES: dict[str, Callable[[Watched], object]] = {
    "a value of the .tcf": lambda w: w.replace("robot.tcf", "4096", "2048"),
    "a comment of the .tcf": lambda w: w.replace("robot.tcf", "# A motor", "# The motor"),
    "the bindings": lambda w: w.replace("bindings.yaml", "log: position", "log: {to: position, scale: 2}"),
    "a source of the model": lambda w: w.replace("model/controller.c", "0.0", "0.5"),
    "a new file in the model's folder": lambda w: w.write(w.project.source / "model/more.c", "int more;\n"),
    "an argument": lambda w: w.replace("CMakeLists.txt", "TCF robot.tcf", "TCF robot.tcf NODE other"),
    "an output that is gone": lambda w: (w.outputs / "robot/robot_app.c").unlink(),
    "an output that somebody edited": lambda w: w.write(w.outputs / "robot/robot.h", "mine\n"),
    "the description that is gone": lambda w: (w.outputs / "robot/robot.cmake").unlink(),
    "a stamp that is damaged": lambda w: w.write(w.project.build_folder / "CMakeFiles/epg/robot.stamp", "\0"),
    "a new file in the user's targets": lambda w: w.write(w.user_folder / "components/lamp/component.yaml", KIND),
}


def test_each_change_is_noticed(robot: Watched) -> None:
    for change, make in CHANGES.items():
        before = {name: (robot.outputs / name).read_bytes() for name in ("robot/robot.h", "robot/robot_app.c")}
        make(robot)
        assert robot.configure() > 0, change
        assert robot.configure() == 0, change
        if "output" in change or "gone" in change:
            assert {name: (robot.outputs / name).read_bytes() for name in before} == before, change


def test_a_change_that_keeps_the_files_times_is_noticed(robot: Watched) -> None:
    path = robot.project.source / "robot.tcf"
    status = path.stat()
    robot.replace("robot.tcf", "4096", "2048")
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert robot.configure() > 0


def test_a_touched_file_is_no_change(robot: Watched) -> None:
    (robot.project.source / "robot.tcf").touch()
    assert robot.configure() == 0


def test_a_file_that_was_not_there_and_now_comes_first_is_noticed(robot: Watched) -> None:
    """The predefined robot is found in the user's folder, then beside the CMakeLists.txt."""
    tcf = (robot.project.source / "robot.tcf").read_text(encoding="utf-8")
    robot.write(robot.user_folder / "robots/mine/my_robot.tcf", tcf)
    robot.replace("CMakeLists.txt", "TCF robot.tcf", "TCF my_robot.tcf")
    assert robot.configure() > 0
    assert robot.configure() == 0
    robot.write(robot.project.source / "my_robot.tcf", tcf.replace("node: robot", "node: nearer"))
    assert robot.configure() > 0
    assert '"nearer"' in (robot.outputs / "robot/robot_app.c").read_text()
    (robot.project.source / "my_robot.tcf").unlink()
    assert robot.configure() > 0
    assert '"nearer"' not in (robot.outputs / "robot/robot_app.c").read_text()


def test_files_beside_a_models_folder_are_noticed(robot: Watched) -> None:
    source = robot.project.source
    pan = Export().write(source / "pan")
    (source / "common").mkdir()
    shutil.move(pan / "xxtypes.h", source / "common" / "xxtypes.h")
    robot.replace(
        "CMakeLists.txt", "find_package(EPG REQUIRED)", "find_package(EPG REQUIRED)\nepg_add_model(pan MODEL pan)"
    )
    for starts in (True, False):
        assert (robot.configure() > 0) == starts
        assert (
            "these files are from '../common', because the model's folder does not have them: xxtypes.h" in robot.output
        )
    robot.replace("common/xxtypes.h", "double", "long double")
    assert robot.configure() > 0
    assert robot.configure() == 0
    robot.write(source / "include" / "xxtypes.h", (source / "common" / "xxtypes.h").read_text())  # the same contents
    assert robot.configure() > 0
    assert robot.configure() == 0
    robot.replace("include/xxtypes.h", "long double", "float")
    assert robot.configure(check=False) > 0
    assert "2 different ones are beside it" in robot.output
    robot.write(pan / "xxtypes.h", (source / "common" / "xxtypes.h").read_text())
    assert robot.configure() > 0
    assert "these files are from" not in robot.output


def test_a_template_of_a_users_kind_is_noticed(robot: Watched) -> None:
    shutil.copytree(ROOT / "targets/components/constant", robot.user_folder / "components/constant")
    assert robot.configure() > 0
    assert robot.configure() == 0
    (template,) = (robot.user_folder / "components/constant").glob("*.j2")
    template.write_text(template.read_text(encoding="utf-8") + "{# changed #}\n", encoding="utf-8")
    assert robot.configure() > 0


def test_another_interpreter_is_noticed(robot: Watched, tmp_path: Path) -> None:
    other = tmp_path / "other python"
    other.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    other.chmod(0o755)
    assert robot.configure(f"-DPython3_EXECUTABLE={other}") > 0
    assert robot.configure(f"-DPython3_EXECUTABLE={other}") == 0


def test_an_interpreter_that_is_too_old_or_none_is_refused(tmp_path: Path) -> None:
    old = tmp_path / "python3"
    old.write_text("#!/bin/sh\necho 3.8 /usr/bin/python3.8\n")
    old.chmod(0o755)
    project = Project(tmp_path / "p", "robot")
    output = " ".join(project.fails_to_configure(f"-DPython3_EXECUTABLE={old}").split())
    assert f"needs Python 3.10 or newer; this is 3.8: {old}" in output
    assert "cmake -DPython3_EXECUTABLE=<path>" in output
    project = Project(tmp_path / "q", "robot")
    output = " ".join(project.fails_to_configure(f"-DPython3_EXECUTABLE={tmp_path / 'none'}").split())
    assert "cannot be started" in output


def test_another_generator_is_noticed_whatever_its_times(tmp_path: Path) -> None:
    checkout = tmp_path / "checkout"
    for name in ("epg", "cmake", "schemas", "targets"):
        shutil.copytree(ROOT / name, checkout / name, ignore=shutil.ignore_patterns("__pycache__"))
    watched = Watched(tmp_path / "project")

    def configure() -> int:
        return watched.configure(f"-DEPG_DIR={checkout / 'cmake'}", epg_dir=False)

    assert configure() > 0
    assert configure() == 0
    for name in (
        "epg/generator/emit/templates/app.c.j2",
        "epg/generator/quantity.py",
        "schemas/tcf.schema.json",
        "targets/components/pwm_h_bridge/component.yaml",
    ):
        path = checkout / name
        status = path.stat()
        path.write_bytes(path.read_bytes() + b"\n")
        os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
        assert configure() > 0, name
        assert configure() == 0, name
    (checkout / "epg/generator/quantity.py").touch()
    (checkout / "schemas/editor").mkdir(exist_ok=True)
    (checkout / "schemas/editor/tcf.schema.json").write_text("{}")
    assert configure() == 0
    (checkout / "epg/generator/check/new.py").touch()
    assert configure() > 0


def test_an_upgraded_wheel_is_noticed_by_its_record(tmp_path: Path) -> None:
    site = tmp_path / "prefix/lib/python3/site-packages"
    shutil.copytree(ROOT / "epg", site / "epg", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("cmake", "schemas", "targets"):
        shutil.copytree(ROOT / name, site / "epg/_data" / name)
    information = site / "epg-1.dist-info"
    information.mkdir()
    (information / "RECORD").write_text("epg/__init__.py,sha256=1,1\n")
    watched = Watched(tmp_path / "project")

    def configure() -> int:
        return watched.configure(f"-DEPG_DIR={site}/epg/_data/cmake", epg_dir=False)

    assert configure() > 0
    assert configure() == 0
    (information / "RECORD").write_text("epg/__init__.py,sha256=2,1\n")
    os.utime(information / "RECORD", (1, 1))
    assert configure() > 0
    assert configure() == 0
    information.rename(site / "epg-2.dist-info")
    (site / "epg-2.dist-info/RECORD").write_text("epg/__init__.py,sha256=3,1\n")
    assert configure() > 0


def test_outputs_no_longer_generated_are_deleted(tmp_path: Path) -> None:
    watched = Watched(tmp_path, "all_kinds")
    watched.configure()
    folder = watched.outputs / "robot"
    assert list(folder.glob("*_plant*"))
    watched.replace("CMakeLists.txt", " PLANT plant PLANT_BINDINGS plant.bindings.yaml", "")
    watched.configure()
    assert not list(folder.glob("*_plant*"))
    assert (folder / "robot_app.c").exists()


def test_a_mistake_is_reported_until_it_is_mended(robot: Watched) -> None:
    robot.replace("robot.tcf", "kind: constant", "kind: constnt")
    for _ in range(2):
        assert robot.configure(check=False) > 0
        assert "unknown-kind" in robot.output
    robot.replace("robot.tcf", "kind: constnt", "kind: constant")
    assert robot.configure() > 0
    assert robot.configure() == 0


def test_warnings_are_said_again(robot: Watched) -> None:
    robot.replace("bindings.yaml", "log: position, ", "")
    robot.configure()
    warning = next(line for line in robot.output.splitlines() if " warning: " in line)
    assert robot.configure() == 0
    assert robot.output.splitlines().count(warning) == 1
    robot.replace("bindings.yaml", "duty: motor, ", "duty: motor, log: position, ")
    robot.configure()
    assert " warning: " not in robot.output
    robot.configure()
    assert " warning: " not in robot.output


def test_a_file_with_a_time_in_the_future_is_read_at_its_changes_only(robot: Watched) -> None:
    """Its time cannot tell if it was edited during the run: EPG runs twice and compares contents around the second."""
    for old, new in (("4096", "2048"), ("2048", "1024")):
        robot.replace("robot.tcf", old, new)
        later = (robot.project.source / "robot.tcf").stat().st_mtime + 3600
        os.utime(robot.project.source / "robot.tcf", (later, later))
        assert robot.configure() == 2
        assert robot.configure() == 0
        assert f"{new}" in (robot.outputs / "robot/robot_app.c").read_text()
    os.utime(robot.project.source / "robot.tcf")
    assert robot.configure() == 0


@pytest.mark.parametrize("generator", ["Ninja", "Unix Makefiles"])
def test_the_build_itself_notices_a_new_file_in_the_models_folder(tmp_path: Path, generator: str) -> None:
    watched = Watched(tmp_path)
    watched.configure(generator=generator)
    watched.project.build()
    time.sleep(1.1)  # make compares the times that its file system stores
    watched.write(watched.project.source / "model/notes.txt", "")
    assert "Configuring done" in watched.project.build()
    assert "Configuring done" not in watched.project.build()


def test_a_model_around_the_build_folder_does_not_configure_without_end(tmp_path: Path) -> None:
    """An in-source build: CMake writes its files into the model's folder."""
    watched = Watched(tmp_path)
    source = watched.project.source
    for path in list((source / "model").iterdir()):
        path.rename(source / path.name)
    watched.replace("CMakeLists.txt", "MODEL model", 'MODEL "${CMAKE_CURRENT_SOURCE_DIR}"')
    project = watched.project
    if not NINJA:
        pytest.skip("Ninja is not installed: sudo apt install ninja-build")
    command = ["cmake", "-G", "Ninja", f"-DPython3_EXECUTABLE={sys.executable}", f"-DEPG_DIR={ROOT / 'cmake'}"]
    project._run([*command, "-S", str(source), "-B", str(source)], True)
    project._run(["cmake", "--build", str(source)], True)
    assert "Configuring" not in project._run(["cmake", "--build", str(source)], True)


def test_one_start_of_python_is_enough_for_all_that_changed(tmp_path: Path) -> None:
    watched = Watched(tmp_path, "models")
    examples = f"-DEXAMPLES={shutil.copytree(ROOT / 'examples', tmp_path / 'examples')}"
    watched.configure(examples)
    assert watched.configure(examples) == 0
    before = {path: path.read_bytes() for path in watched.outputs.rglob("*") if path.is_file()}
    for source in (tmp_path / "examples" / "jiwy/model").glob("xxmodel.c"):  # first and second
        source.write_text(source.read_text() + "\n/* edited */\n")
    watched.replace("../robot/model/controller.c", "0.0", "0.5")  # by_hand
    for damaged in ("first", "by_hand"):
        (watched.outputs / damaged / f"{damaged}.h").unlink()
    assert watched.configure(examples) == 1
    assert {path: path.read_bytes() for path in watched.outputs.rglob("*") if path.is_file()} == before
    assert watched.configure(examples) == 0


def test_a_mistake_of_a_target_that_another_start_generates_is_reported(tmp_path: Path) -> None:
    watched = Watched(tmp_path, "models")
    examples = f"-DEXAMPLES={shutil.copytree(ROOT / 'examples', tmp_path / 'examples')}"
    watched.configure(examples)
    (watched.outputs / "first" / "first.h").unlink()
    watched.replace("../robot/model/model.yaml", "step: 1 ms", "stepp: 1 ms")
    assert watched.configure(examples, check=False) == 2
    assert watched.output.count("error: unknown key 'stepp'") == 1
    assert "model 'by_hand' was not generated" in watched.output
    # Without the call, its mistake is not reported.
    watched.replace("../robot/model/model.yaml", "stepp: 1 ms", "step: 1 ms")
    assert watched.configure(examples) == 1
    watched.replace("../robot/model/model.yaml", "step: 1 ms", "stepp: 1 ms")
    text = (watched.project.source / "CMakeLists.txt").read_text(encoding="utf-8")
    text = text.replace("epg_add_model(by_hand MODEL ../robot/model)\n", "").replace(" EPG::by_hand", "")
    watched.write(watched.project.source / "CMakeLists.txt", text)
    (watched.outputs / "first" / "first.h").unlink()
    assert watched.configure(examples) == 1
    assert "stepp" not in watched.output
    assert watched.configure(examples) == 0
