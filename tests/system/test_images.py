# SPDX-License-Identifier: Apache-2.0
"""The images of a system: one command builds all of them, and one that cannot be built does not stop the others.

`tests/cmake/test_zephyr_target.py` configures an image of Zephyr quickly; here one is built.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from epg.cli.main import main
from tests.cmake.project import ROOT, Project, copy_jiwy
from tests.doubles.toolchain import arm_gcc, pico_sdk, skip_if_missing, tool
from tests.zephyr.workspace import c_library, run, workspace

SYSTEM = """version: 1
system: two
targets:
  leader: {tcf: rpi_pico_bare_metal_jiwy, model: model, bindings: jiwy.bindings.yaml}
  follower: {tcf: nucleo_h743zi_bare_metal_jiwy, model: model, bindings: jiwy.bindings.yaml}
  watcher:
    tcf: host_jiwy
    model: model
    bindings: jiwy.bindings.yaml
    set: {communication: {middleware: xrce}}
    project: watcher
connections:
  - {from: leader/pan_publisher, to: [follower/pan_subscriber, watcher/pan_subscriber]}
  - {from: leader/tilt_publisher, to: [follower/tilt_subscriber, watcher/tilt_subscriber]}
world: {sends: [leader/pan_subscriber, leader/tilt_subscriber]}
"""
LISTS = """cmake_minimum_required(VERSION 3.22)
project(two LANGUAGES C CXX)
find_package(EPG REQUIRED)
epg_add_system(two SYSTEM two.system.yaml)
"""
OWN = """cmake_minimum_required(VERSION 3.22)
find_package(EPG REQUIRED)
project(watcher C CXX)
epg_add_target(watcher SYSTEM ../two.system.yaml)
epg_add_executable(watcher_program EPG::watcher)
"""


@pytest.fixture
def project(tmp_path: Path) -> Project:
    needed = ("micro_xrce_dds_client", "micro_cdr", "cmsis_core", "cmsis_device_h7")
    skip_if_missing(arm_gcc, pico_sdk, *(lambda name=name: tool(name) for name in needed))
    made = Project(tmp_path, "two")
    copy_jiwy(made.source, "model")
    (made.source / "two.system.yaml").write_text(SYSTEM)
    (made.source / "CMakeLists.txt").write_text(LISTS)
    (made.source / "watcher").mkdir()
    (made.source / "watcher/CMakeLists.txt").write_text(OWN)
    return made


def test_one_command_builds_all_images(project: Project) -> None:
    project.environment["PICO_SDK_PATH"] = str(project.folder / "no SDK")
    project.configure()
    output = project.build("--target", "two_images", check=False)
    assert "these images were not built: leader." in output
    assert "PICO_SDK_PATH" in output
    images = project.build_folder / "two_images"
    assert b"/two/leader/pan_publisher" in (images / "follower/follower_firmware.elf").read_bytes()
    assert (images / "watcher/watcher_program").is_file(), "a project of its own is built on any platform"

    del project.environment["PICO_SDK_PATH"]
    output = project.build("--target", "two_images")
    assert f"The images are in {images.as_posix()}" in output
    assert (images / "leader/leader_firmware.uf2").is_file()
    assert compiled(output) == {"leader"}, "the other image is up to date"
    assert compiled(project.build("--target", "two_images")) == set()

    output = project.build("--target", "two_flash", check=False)
    assert compiled(output) == set()
    assert "image-outdated" not in output, "each image contains the hash of its files"
    assert "the board of 'leader' is not known" in output and "the board of 'follower' is not known" in output


def test_an_image_of_zephyr(project: Project, capfd: pytest.CaptureFixture[str]) -> None:
    skip_if_missing(lambda: workspace("rpi_pico"), c_library)
    here = workspace("rpi_pico")
    project.environment |= here.environment() | {"ZEPHYR_MODULES": ";".join(str(module) for module in here.modules)}
    project.edit("two.system.yaml", "rpi_pico_bare_metal_jiwy", "rpi_pico_zephyr_jiwy")
    project.edit(
        "two.system.yaml", "nucleo_h743zi_bare_metal_jiwy", "host_jiwy, set: {communication: {middleware: xrce}}"
    )
    project.edit("two.system.yaml", "leader: {", "leader: {serial: E6614103E7452D2F, ")
    project.configure(f"-DPython3_EXECUTABLE={here.python}")
    assert compiled(project.build("--target", "two_images")) == {"leader", "watcher"}
    assert compiled(project.build("--target", "two_images")) == set()
    project.edit("two.system.yaml", "system: two", "# a comment\nsystem: two")
    output = project.build("--target", "two_images")
    assert compiled(output) == {"leader"}, "Zephyr links again after each configure run"
    assert "leader_app.c" not in output

    images = project.build_folder / "two_images"
    assert main(["flash", str(project.source / "two.system.yaml"), "--images", str(images), "--dry-run"]) == 0
    assert f"load -v -x {images}/leader/zephyr/zephyr.elf --ser E6614103E7452D2F" in capfd.readouterr().out


def test_images_of_sysbuild(project: Project) -> None:
    """epg_add_system() in sysbuild.cmake of an application adds the targets on Zephyr."""
    skip_if_missing(lambda: workspace("rpi_pico"), c_library)
    here = workspace("rpi_pico")
    project.edit("two.system.yaml", "rpi_pico_bare_metal_jiwy", "rpi_pico_zephyr_jiwy")
    app = project.source
    (app / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.22)\nfind_package(Zephyr REQUIRED HINTS $ENV{ZEPHYR_BASE})\n"
        "project(empty)\ntarget_sources(app PRIVATE main.c)\n"
    )
    (app / "main.c").write_text("int main(void) { return 0; }\n")
    (app / "prj.conf").touch()
    (app / "sysbuild.cmake").write_text(
        f'include("{ROOT.as_posix()}/cmake/EPGConfig.cmake")\nepg_add_system(two SYSTEM two.system.yaml)\n'
    )
    build = app / "build"
    modules = ";".join(str(module) for module in here.modules)
    settings = {"APP_DIR": app, "BOARD": "rpi_pico", "ZEPHYR_MODULES": modules, **c_library()}
    configure = ["cmake", "-G", "Ninja", "-S", str(here.base / "share/sysbuild"), "-B", str(build)]
    run([*configure, *(f"-D{name}={value}" for name, value in settings.items())], here)
    run(["ninja", "-C", str(build)], here)
    assert (build / "leader/zephyr/zephyr.uf2").is_file() and not (build / "follower").exists()


def compiled(output: str) -> set[str]:
    """The images for which something was compiled or linked."""
    found, image = set(), ""
    for line in output.splitlines():
        image = line.removeprefix("-- Image of ") if line.startswith("-- Image of ") else image
        if re.search(r"Building C|Building ASM|Linking C", line):
            found.add(image)
    return found
