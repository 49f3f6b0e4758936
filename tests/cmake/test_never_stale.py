# SPDX-License-Identifier: Apache-2.0
"""No build uses old generated code: all that EPG has read is watched right after the first configure run.

The rule is tested, not a list of files.  A hook in the interpreter records every file that a run of EPG opens, every
folder that it lists and every path that it does not find.  Of those in EPG and in the project, each must be watched by
the build, or be a part of the fingerprint that identifies EPG.
"""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.cmake.project import NINJA, ROOT, Project, compiled
from tests.doubles.twenty_sim.exports import Export
from tests.models.fmus import FMU2, FMU3, pack

pytestmark = pytest.mark.skipif(not NINJA, reason="Ninja is not installed: sudo apt install ninja-build")

HOOK = """
import os
import sys

if {"generate", "generate-model", "generate-system", "generate-all"}.intersection(sys.orig_argv):
    EVENTS = {"open": "opened", "os.listdir": "listed", "os.scandir": "listed"}
    log = os.open(os.environ["EPG_TEST_READS"], os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    stat, lstat = os.stat, os.lstat

    def note(event, path):
        if isinstance(path, (str, bytes, os.PathLike)):  # and not a number of an open file
            os.write(log, f"{event} {os.path.abspath(os.fsdecode(path))}\\n".encode())

    def hook(event, arguments):
        if event in EVENTS and not isinstance(arguments[0], int):
            path = arguments[0] or os.curdir
            try:
                stat(path)
                note(EVENTS[event], path)
            except OSError:
                note("missed", path)

    def noting(function):
        def wrapped(path, *arguments, **options):
            try:
                return function(path, *arguments, **options)
            except OSError:  # a search for a missing file raises no event
                note("missed", path)
                raise
        return wrapped

    os.stat, os.lstat = noting(stat), noting(lstat)
    sys.addaudithook(hook)

    after, _, edit = os.environ.get("EPG_TEST_EDIT", "").partition("|")
    if edit:
        file, old, new = edit.split("|")

        def edit_once(event, arguments, done=[]):
            if event == "open" and not done and str(arguments[0]).endswith(after):
                done.append(True)
                with open(file) as read:
                    text = read.read()
                with open(file, "w") as written:
                    written.write(text.replace(old, new))

        sys.addaudithook(edit_once)
"""

EVERYTHING = """cmake_minimum_required(VERSION 3.22)
project(everything LANGUAGES C CXX)
find_package(EPG REQUIRED)
set(jiwy MODEL examples/jiwy/model BINDINGS examples/jiwy/jiwy.bindings.yaml)
set(plant PLANT examples/jiwy/plant PLANT_BINDINGS examples/jiwy/plant.bindings.yaml)
epg_add_target(jiwy TCF host_jiwy.tcf ${jiwy} ${plant})
epg_add_target(robot TCF robot/robot.tcf MODEL robot/model BINDINGS robot/bindings.yaml)
epg_add_target(own TCF mine ${jiwy})
epg_add_model(wheels MODEL examples/relbot/model INSTANCES 2)
epg_add_model(packed MODEL fmus/servo.fmu)
epg_add_model(unpacked MODEL fmus/axes)
epg_add_model(tokens_only MODEL tokens)
epg_add_model(pan MODEL controllers/pan)
epg_add_model(deep MODEL nested/exports)
epg_add_system(cell SYSTEM examples/production_cell/production_cell.system.yaml)
epg_add_system(situation SYSTEM examples/network_situations/situation_1.system.yaml)

# Targets of boards are only generated: their SDKs are not needed for that.
foreach(board
    rpi_pico_bare_metal rpi_pico2_freertos rpi_pico_zephyr nucleo_h743zi_bare_metal native_sim my_pico_freertos)
  set(arguments --source-dir "${CMAKE_SOURCE_DIR}" --caller "${CMAKE_CURRENT_LIST_FILE}"
    --tcf ${board}_jiwy.tcf --beside "${CMAKE_CURRENT_SOURCE_DIR}"
    --model "${CMAKE_CURRENT_SOURCE_DIR}/examples/jiwy/model"
    --bindings "${CMAKE_CURRENT_SOURCE_DIR}/examples/jiwy/jiwy.bindings.yaml")
  _epg_generate(good ${board} "${CMAKE_BINARY_DIR}/epg/${board}" generate ${board} ${arguments})
  if(NOT good)
    message(FATAL_ERROR "${board}")
  endif()
endforeach()
set(cubemx "${CMAKE_CURRENT_SOURCE_DIR}/examples/existing_cubemx_repository")
_epg_generate(good station "${CMAKE_BINARY_DIR}/epg/station" generate station --source-dir "${CMAKE_SOURCE_DIR}"
  --tcf "${cubemx}/controller/turntable.tcf" --beside "${CMAKE_CURRENT_SOURCE_DIR}" --ioc "${cubemx}/station.ioc"
  --model "${cubemx}/controller/model" --bindings "${cubemx}/controller/turntable.bindings.yaml")
if(NOT good)
  message(FATAL_ERROR "station")
endif()
"""

BOARD = "api: 1\nboard: my_pico\nextends: rpi_pico\nsummary: a Pico in a housing\n"

USUAL = ("cmake", "epg", "schemas", "targets", "docs")
"""The folders of a checkout that EPG needs."""


@dataclass(frozen=True)
class Epg:
    """One EPG that projects use.  ``data`` is the folder that contains targets/, ``package`` the Python package."""

    data: Path
    package: Path
    tree: Path
    upstream: Path | None = None

    @property
    def cmake(self) -> Path:
        return self.data / "cmake"

    def edit(self, file: str, old: str, new: str) -> None:
        """Changes a file of EPG: in place, or by an update of the submodule."""
        folder = self.upstream or self.data
        replace(folder / file, old, new)
        if self.upstream is not None:
            git(self.upstream, "commit", "-q", "-a", "-m", f"Edit {file}")
            git(self.tree.parent, "submodule", "-q", "update", "--remote", self.tree.name)


def replace(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def git(folder: Path, *arguments: str) -> None:
    settings = (
        "user.name=test",
        "user.email=test@example.org",
        "protocol.file.allow=always",
        "init.defaultBranch=main",
    )
    options = [word for setting in settings for word in ("-c", setting)]
    subprocess.run(["git", *options, "-C", folder, *arguments], check=True, capture_output=True)


def copy_of_epg(folder: Path) -> Path:
    for name in USUAL:
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def checkout(folder: Path) -> Epg:
    tree = copy_of_epg(folder / "epg")
    return Epg(tree, tree / "epg", tree)


def submodule(folder: Path) -> Epg:
    """EPG as a submodule of a repository in whose folders the projects are."""
    upstream = copy_of_epg(folder / "upstream")
    git(upstream, "init", "-q", "-b", "main")
    git(upstream, "add", "-A")
    git(upstream, "commit", "-q", "-m", "EPG")
    folder = folder / "repository"
    folder.mkdir()
    git(folder, "init", "-q")
    git(folder, "submodule", "-q", "add", "-b", "main", str(upstream), "epg")
    return Epg(folder / "epg", folder / "epg" / "epg", folder / "epg", upstream)


@pytest.fixture(scope="module", params=["checkout", "submodule", "wheel"])
def epg(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Epg:
    if request.param == "wheel":
        installed = tmp_path_factory.mktemp("wheel") / "prefix"
        shutil.copytree(request.getfixturevalue("prefix"), installed)
        (site,) = installed.glob("lib/*/site-packages")
        return Epg(site / "epg/_data", site / "epg", site / "epg")
    folder = tmp_path_factory.mktemp(request.param)
    return checkout(folder) if request.param == "checkout" else submodule(folder)


def around(epg: Epg, tmp_path: Path, name: str) -> Path:
    """The folder of a project: in the repository around a submodule, else somewhere else."""
    folder = tmp_path if epg.upstream is None else epg.tree.parent / name
    folder.mkdir(exist_ok=True)
    return folder


class Reads:
    """A project whose runs of EPG are recorded."""

    def __init__(self, folder: Path, epg: Epg, name: str = "robot") -> None:
        self.epg = epg
        hook = folder / "hook"
        hook.mkdir(parents=True)
        (hook / "sitecustomize.py").write_text(HOOK)
        self.log = folder / "reads"
        self.own = folder / "own targets"
        (self.own / "robots/mine").mkdir(parents=True)
        path = os.pathsep.join(filter(None, (str(hook), os.environ.get("PYTHONPATH"))))
        environment = {"PYTHONPATH": path, "EPG_TEST_READS": str(self.log), "EPG_TARGETS_PATH": str(self.own)}
        self.project = Project(folder, name, environment)
        self.project.source.mkdir(exist_ok=True)

    def configure(self, generator: str = "Ninja") -> str:
        time.sleep(0.02)  # earlier edits must be older than the files that follow
        self.log.unlink(missing_ok=True)
        return self.project.configure(f"-DEPG_DIR={self.epg.cmake}", generator=generator, epg_dir=False)

    def build(self, *arguments: str) -> str:
        time.sleep(0.02)  # earlier edits must be older than the files that follow
        return self.project.build(*arguments)

    def generated(self, name: str) -> str:
        return (self.project.build_folder / "epg" / name).read_text(encoding="utf-8")

    def found(self) -> Iterator[tuple[str, Path]]:
        """What the runs opened, listed and missed in EPG, in the project and in the user's folder of targets."""
        trees = [self.epg.tree, self.project.folder / "projects", self.own]
        for line in sorted(set(self.log.read_text(encoding="utf-8").splitlines())):
            event, _, name = line.partition(" ")
            path = Path(name)
            if path.suffix == ".pyc":  # instead of the source
                source = Path(importlib.util.source_from_cache(name.rpartition(".pyc")[0] + ".pyc"))
                event, path = "opened" if source.exists() else "missed", source
            if "__pycache__" not in path.parts and any(path.is_relative_to(tree) for tree in trees):
                yield event, path

    def unnoticed(self) -> list[str]:
        """What of :meth:`found` neither the build watches nor the fingerprint contains."""
        build = self.project.build_folder
        query = subprocess.run(
            ["ninja", "-C", build, "-t", "query", "build.ninja"], capture_output=True, text=True, check=True
        )
        inputs = re.findall(r"^    (?:\|\|? )?(.+)$", query.stdout, re.M)
        watched = {Path(os.path.normpath(build / name)) for name in inputs}
        globs = build / "CMakeFiles/VerifyGlobs.cmake"
        text = globs.read_text(encoding="utf-8") if globs.exists() else ""
        watched |= {Path(name) for name in re.findall(r'file\(GLOB NEW_GLOB .*? "(.+)"\)', text)}
        fingerprint = {path for path in watched if path.is_relative_to(self.epg.package) and path.is_file()}
        for record in self.epg.package.parent.glob("epg-*.dist-info/RECORD"):
            names = (line.split(",")[0] for line in record.read_text(encoding="utf-8").splitlines())
            if record in watched:
                fingerprint |= {record.parent.parent / name for name in names}
        listed = watched | {folder for path in fingerprint for folder in path.parents}

        def noticed(event: str, path: Path) -> bool:
            if event != "missed":
                return path in watched or path in (fingerprint if event == "opened" else listed)
            return path in watched or next(folder for folder in path.parents if folder.exists()) in listed

        return [f"{event} {path}" for event, path in self.found() if not noticed(event, path)]


def write_everything(project: Reads) -> None:
    """A project with models of all origins, systems, and a target of each platform and of the user's own folder."""
    source = project.project.source
    (source / "CMakeLists.txt").write_text(EVERYTHING, encoding="utf-8")
    for example in ("jiwy", "relbot", "production_cell", "network_situations", "existing_cubemx_repository"):
        shutil.copytree(ROOT / "examples" / example, source / "examples" / example)
    shutil.copytree(source.parent / "robot", source / "robot")
    pack(FMU2, source / "fmus/servo.fmu")
    shutil.copytree(FMU3, source / "fmus/axes")
    (source / "fmus/axes/sources/empty").mkdir()
    (source / "fmus/axes/binaries/x86_64-linux").mkdir(parents=True)
    (source / "tokens").mkdir()
    shutil.copy(ROOT / "examples/jiwy/model/tokens.xml", source / "tokens")
    pan = Export().write(source / "controllers/pan")
    Export(name="Tilt").write(source / "controllers/tilt")
    (source / "controllers/common").mkdir()
    shutil.move(pan / "xxtypes.h", source / "controllers/common")
    shutil.copy(source / "tokens/tokens.xml", pan / "old_tokens.xml")
    Export(name="Deep").write(source / "nested/exports/deep")
    (source / "nested/exports/helper.c").write_text("int helper;\n", encoding="utf-8")

    own = project.own
    lamp = shutil.copytree(ROOT / "targets/components/constant", own / "components/lamp")
    replace(lamp / "component.yaml", "kind: constant", "kind: lamp")
    replace(source / "robot/robot.tcf", "kind: constant", "kind: lamp")
    (own / "boards/my_pico").mkdir(parents=True)
    (own / "boards/my_pico/board.yaml").write_text(BOARD)
    (own / "robots/mine/mine.tcf").write_text("version: 1\nextends: host_jiwy.tcf\n")
    tcf = "version: 1\nextends: rpi_pico_freertos_jiwy.tcf\ntarget: my_pico_freertos\n"
    (own / "robots/mine/my_pico_freertos_jiwy.tcf").write_text(tcf)


def test_all_that_was_read_is_watched_after_the_first_configure(epg: Epg, tmp_path: Path) -> None:
    reads = Reads(around(epg, tmp_path, "read"), epg, "everything")
    write_everything(reads)
    reads.configure()
    found = list(reads.found())
    assert {event for event, _ in found} == {"opened", "listed", "missed"}
    opened = {path for event, path in found if event == "opened"}
    assert {
        epg.data / "targets/components/pwm_h_bridge/code.c.j2",
        epg.data / "targets/boards/rpi_pico/board.yaml",
        epg.package / "generator/emit/templates/app.c.j2",
        reads.own / "components/lamp/component.yaml",
        reads.project.source / "controllers/pan/xxsubmod.c",
    } <= opened
    assert "\n".join(reads.unnoticed()) == ""

    # One start of EPG generates all of them again.
    shared = epg.data / "targets/components/common"
    for file in sorted(shared.glob("*.yaml")):
        file.write_text(file.read_text(encoding="utf-8") + "# edited\n", encoding="utf-8")
    (reads.project.source / "examples/jiwy/model/xxtypes.h").open("a").write("/* edited */\n")
    reads.configure()
    assert len(list(reads.found())) > len(found) / 2
    assert "\n".join(reads.unnoticed()) == ""


KIND_FILE = "targets/components/pwm_h_bridge/code.c.j2"
KIND = "static epg_pwm_h_bridge_t {{ c.symbol }};"


@pytest.fixture
def robot(epg: Epg, tmp_path: Path) -> Iterator[Reads]:
    """A robot as a program for this computer, and in any firmware."""
    text = (epg.data / KIND_FILE).read_text(encoding="utf-8")
    reads = Reads(around(epg, tmp_path, re.sub(r"\W", "_", tmp_path.name)), epg)
    lists = reads.project.source / "CMakeLists.txt"
    lists.write_text(
        lists.read_text(encoding="utf-8")
        + "epg_add_target(board TCF robot.tcf MODEL model BINDINGS bindings.yaml\n"
        + '  SET target=firmware communication.middleware=console "clocks.timers=64 MHz")\n',
        encoding="utf-8",
    )
    lamp = shutil.copytree(ROOT / "targets/components/constant", reads.own / "components/lamp")
    replace(lamp / "component.yaml", "kind: constant", "kind: lamp")
    replace(reads.project.source / "robot.tcf", "kind: constant", "kind: lamp")
    yield reads
    now = (epg.data / KIND_FILE).read_text(encoding="utf-8")
    if now != text:
        epg.edit(KIND_FILE, now, text)


def test_an_edit_of_a_kind_of_epg_is_in_the_next_build(robot: Reads) -> None:
    robot.configure()
    robot.epg.edit(KIND_FILE, KIND, f"{KIND} /* edited */")
    output = robot.build()
    assert {"robot_app.c", "board_app.c"} <= compiled(output)
    for name in ("robot/robot_app.c", "board/board_app.c"):
        assert "/* edited */" in robot.generated(name)
    assert "Configuring done" not in robot.build()


def test_an_edit_of_the_search_for_variables_is_in_the_next_build(tmp_path: Path) -> None:
    """`epg model-variables` runs in the build, not while CMake configures.  An edit of any of its modules counts."""
    robot = Reads(tmp_path, checkout(tmp_path))
    robot.configure()
    assert "model-variables" in robot.build()
    for file in (
        "epg/generator/emit/licence.py",
        "epg/generator/documents/object_file.py",
        "epg/cli/model_variables.py",
    ):
        robot.epg.edit(file, "from __future__", "# edited\nfrom __future__")
        assert "model-variables" in robot.build(), file
        assert "model-variables" not in robot.build(), file


def test_targets_that_another_start_has_generated_are_watched(robot: Reads) -> None:
    robot.configure()
    robot.project.edit("bindings.yaml", "log: position", "log: {to: position, scale: 2}")
    robot.configure()
    (runs,) = {line for line in robot.log.read_text().splitlines() if line.endswith("/robot.runs.txt")}
    assert runs.startswith("opened")
    assert "\n".join(robot.unnoticed()) == ""
    robot.epg.edit(KIND_FILE, KIND, f"{KIND} /* edited */")
    assert {"robot_app.c", "board_app.c"} <= compiled(robot.build())
    for name in ("robot/robot_app.c", "board/board_app.c"):
        assert "/* edited */" in robot.generated(name)


def test_a_tcf_that_comes_first_is_in_the_next_build(tmp_path: Path) -> None:
    """A file that was missing when EPG looked for it.  Other files in its folder do not configure again."""
    robot = Reads(tmp_path, Epg(ROOT, ROOT / "epg", ROOT))
    tcf = (robot.project.source / "robot.tcf").read_text(encoding="utf-8")
    (robot.own / "robots/mine/mine.tcf").write_text(tcf, encoding="utf-8")
    replace(robot.project.source / "CMakeLists.txt", "TCF robot.tcf", "TCF mine.tcf")
    robot.configure()
    (robot.project.source / "notes.txt").touch()
    assert "Configuring done" not in robot.build()
    (robot.project.source / "mine.tcf").write_text(tcf.replace("node: robot", "node: nearer"), encoding="utf-8")
    assert "robot_app.c" in compiled(robot.build())
    assert '"nearer"' in robot.generated("robot/robot_app.c")
    assert "Configuring done" not in robot.build()
    (robot.project.source / "mine.tcf").unlink()
    robot.build()
    assert '"nearer"' not in robot.generated("robot/robot_app.c")


@pytest.mark.parametrize("generator", ["Ninja", "Unix Makefiles"])
def test_an_edit_while_epg_runs_is_in_the_next_build(tmp_path: Path, generator: str) -> None:
    """A hook edits the .tcf after EPG has read it, and before CMake has written the build files: EPG runs again."""
    robot = Reads(tmp_path, Epg(ROOT, ROOT / "epg", ROOT))
    tcf = robot.project.source / "robot.tcf"
    robot.project.environment["EPG_TEST_EDIT"] = f"model.yaml|{tcf}|node: robot|node: later"
    robot.configure(generator)
    assert "node: later" in tcf.read_text(encoding="utf-8")
    del robot.project.environment["EPG_TEST_EDIT"]
    assert "robot_app.c" in compiled(robot.build())
    assert '"later"' in robot.generated("robot/robot_app.c")
    assert "Configuring done" not in robot.build()


def test_a_folder_whose_name_is_a_pattern_is_searched(tmp_path: Path) -> None:
    """A name such as [a] is a pattern of CMake, too, which matches another folder."""
    robot = Reads(tmp_path / "[work]", Epg(ROOT, ROOT / "epg", ROOT))
    robot.configure()
    assert "\n".join(robot.unnoticed()) == ""
    for folder in (robot.project.source / "model", robot.own / "robots"):
        robot.configure()
        assert not robot.log.exists()
        (folder / "new.txt").touch()
        robot.configure()
        assert robot.log.exists()
