# SPDX-License-Identifier: Apache-2.0
"""``epg doctor``: the installed tools, and the commands that install missing ones."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from epg.cli.main import main

ROOT = Path(__file__).resolve().parent.parent.parent


@pytest.fixture(autouse=True)
def bare(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """No SDK in the home folder, the environment or EPG's cache; a PATH with only the programs of the test."""
    for name in list(os.environ):
        if name.endswith(("_PATH", "_BASE", "_DIR")) or name in ("CC", "CXX", "EPG_NO_INSTALL"):
            monkeypatch.delenv(name)
    (tmp_path / "bin").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("USERPROFILE", str(tmp_path / "home"))
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    return tmp_path


def program(folder: Path, name: str, says: str) -> None:
    file = folder / "bin" / name
    file.write_text(f"#!/bin/sh\necho '{says}'\n")
    file.chmod(0o755)


def host_programs(folder: Path, cmake: str = "3.25.1") -> None:
    program(folder, "cmake", f"cmake version {cmake}")
    program(folder, "ninja", "1.11.1")
    program(folder, "cc", "cc (Debian 12.2.0-14) 12.2.0")


def doctor(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, dict[str, Any]], bool]:
    """Exit status, items by name, and True if the host target can be built."""
    status = main(["doctor", "--json", *arguments])
    data = json.loads(capsys.readouterr().out)
    return status, {item["name"]: item for item in data["items"]}, data["host"]


def test_a_computer_with_what_the_host_needs(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    host_programs(bare)
    status, items, host = doctor(capsys)
    assert (status, host) == (0, True)
    assert items["cmake"]["version"] == "3.25.1"
    assert items["c_compiler"]["path"] == (bare / "bin/cc").as_posix()
    assert items["python"]["path"] == sys.executable
    assert items["pyyaml"]["version"]
    assert items["cxx_compiler"]["status"] == "missing"
    assert not items["cxx_compiler"]["required"]


def test_a_computer_without_a_compiler(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    host_programs(bare)
    (bare / "bin/cc").unlink()
    status, items, host = doctor(capsys)
    assert (status, host) == (4, False)
    assert items["c_compiler"]["status"] == "missing"
    assert main(["doctor"]) == 4
    assert capsys.readouterr().out.endswith("\nthe host target cannot be built\n")


def test_an_old_cmake(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    host_programs(bare, cmake="3.18.4")
    status, items, _ = doctor(capsys)
    assert status == 4
    assert items["cmake"]["status"] == "old"
    assert "3.22 or newer" in items["cmake"]["note"]


@pytest.mark.parametrize(
    ("manager", "command"),
    [("apt-get", "apt install cmake"), ("brew", "brew install cmake"), ("", "python -m pip install cmake")],
)
def test_the_command_is_that_of_the_package_manager(
    manager: str, command: str, bare: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if manager:
        program(bare, manager, "")
    _, items, _ = doctor(capsys)
    assert items["cmake"]["remedy"].removeprefix("sudo ") == command


def test_sdks_are_found_where_their_installers_put_them(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for version in ("2.1.1", "2.2.0"):
        folder = bare / "home/.pico-sdk/sdk" / version
        folder.mkdir(parents=True)
        (folder / "pico_sdk_init.cmake").write_text("")
    _, items, _ = doctor(capsys)
    assert items["pico_sdk"]["path"] == (bare / "home/.pico-sdk/sdk/2.2.0").as_posix()
    assert items["pico_sdk"]["source"] == "~/.pico-sdk/sdk/*"
    assert items["zephyr"]["status"] == "missing"
    assert items["zephyr"]["remedy"].startswith("west init")


def test_commands_put_sdks_into_the_cache(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, items, _ = doctor(capsys)
    assert items["pico_sdk"]["remedy"].endswith(f" {(bare / 'cache').as_posix()}/pico-sdk-2.2.0")


def test_picotool_is_built_with_an_sdk_and_with_usb(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The build of picotool needs the SDK's folder; without libusb, `picotool load` finds no board."""
    program(bare, "apt-get", "")
    _, items, _ = doctor(capsys)
    sdk = (bare / "cache/pico-sdk-2.2.0").as_posix()
    assert items["pico_sdk"]["remedy"].endswith(sdk)
    assert f" -DPICO_SDK_PATH={sdk} " in items["picotool"]["remedy"]
    assert " libusb-1.0-0-dev && " in items["picotool"]["remedy"]
    assert "NO_LIBUSB" not in items["picotool"]["remedy"]
    here = bare / "home/.pico-sdk/sdk/2.1.1"
    here.mkdir(parents=True)
    (here / "pico_sdk_init.cmake").touch()
    _, items, _ = doctor(capsys)
    assert f" -DPICO_SDK_PATH={here.as_posix()} " in items["picotool"]["remedy"]


def project(folder: Path, tcf: str, more: str = "") -> None:
    """The CMakeLists.txt of a project with one target."""
    (folder / "CMakeLists.txt").write_text(
        f"project(x C)\nepg_add_target(jiwy TCF {tcf} MODEL {ROOT}/examples/jiwy/model\n"
        f"  BINDINGS {ROOT}/examples/jiwy/jiwy.bindings.yaml {more})\n"
    )


def test_one_project(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    project(bare, "rpi_pico_freertos_jiwy.tcf", "SET communication.middleware=xrce")
    assert main(["doctor", "--project", str(bare)]) == 4
    text = capsys.readouterr().out
    assert "Micro-CDR" in text and "FreeRTOS kernel" in text and "Zephyr" not in text
    assert main(["doctor", "--json", "--project", str(bare)]) == 4
    items = {item["name"]: item for item in json.loads(capsys.readouterr().out)["items"]}
    assert {"arm_gcc", "pico_sdk", "freertos_kernel", "micro_cdr", "micro_xrce_dds_client"} <= set(items)
    (bare / "CMakeLists.txt").write_text("project(x C)\n")
    main(["doctor", "--project", str(bare)])
    assert "no target with readable files was found" in capsys.readouterr().out


def test_a_project_with_headers_of_its_own(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    project(bare, "nucleo_h743zi_freertos_jiwy.tcf")
    for file, left in (
        ("Drivers/CMSIS/Include/core_cm7.h", {"cmsis_device_h7"}),
        ("Drivers/CMSIS/Device/ST/STM32H7xx/Include/stm32h7xx.h", set()),
    ):
        (bare / file).parent.mkdir(parents=True)
        (bare / file).touch()
        main(["doctor", "--json", "--project", str(bare)])
        items = {item["name"] for item in json.loads(capsys.readouterr().out)["items"]}
        assert {name for name in items if name.startswith("cmsis")} == left and "freertos_kernel" in items
        assert "tinyusb" not in items


def test_a_project_with_usb(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    project(bare, "nucleo_h743zi_freertos_jiwy.tcf", "SET communication.transport=usb")
    main(["doctor", "--json", "--project", str(bare)])
    assert "tinyusb" in {item["name"] for item in json.loads(capsys.readouterr().out)["items"]}


def test_a_variable_that_leads_nowhere(
    bare: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PICO_SDK_PATH", str(bare))
    main(["doctor"])
    text = capsys.readouterr().out
    assert "there is no pico_sdk_init.cmake at this path" in text
    assert "correct or unset the environment variable PICO_SDK_PATH" in text


def test_variables_of_a_build_folder(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (bare / "sdk").mkdir()
    (bare / "sdk/pico_sdk_init.cmake").write_text("")
    (bare / "build").mkdir()
    (bare / "build/CMakeCache.txt").write_text(f"PICO_SDK_PATH:PATH={bare}/sdk\n")
    _, items, _ = doctor(capsys, "--build", str(bare / "build"))
    assert items["pico_sdk"]["source"] == "CMake variable PICO_SDK_PATH"
    assert main(["doctor", "--build", str(bare / "nothing")]) == 1
    assert "there is no file 'CMakeCache.txt'" in capsys.readouterr().err


def test_programs_of_a_build_folder_are_not_started(bare: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The cache in a build folder may come from anyone, and may name any program."""
    host_programs(bare)
    program(bare, "evil", "")
    (bare / "bin/evil").write_text(f"#!/bin/sh\n: > '{bare}/started'\necho 1.2.3\n")
    (bare / "build").mkdir()
    lines = [
        f"{name}:FILEPATH={bare}/bin/evil" for name in ("CMAKE_MAKE_PROGRAM", "CMAKE_C_COMPILER", "CMAKE_CXX_COMPILER")
    ]
    (bare / "build/CMakeCache.txt").write_text("\n".join(lines) + "\n")
    _, items, _ = doctor(capsys, "--build", str(bare / "build"))
    assert items["build_program"]["path"] == f"{bare}/bin/evil" and items["build_program"]["version"] == ""
    assert "--run starts" in items["build_program"]["note"] and items["cmake"]["version"] == "3.25.1"
    assert not (bare / "started").exists()
    _, items, _ = doctor(capsys, "--build", str(bare / "build"), "--run")
    assert (bare / "started").exists() and "--run" not in items["build_program"]["note"]


def test_packages_that_are_missing(bare: Path) -> None:
    """In a Python without packages (``-S``); ``epg doctor`` does not install any."""
    host_programs(bare)
    environment = {**os.environ, "EPG_NO_INSTALL": "1"}
    command = [sys.executable, "-S", "-E", str(ROOT / "epg"), "doctor", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.stderr == ""
    items = {item["name"]: item for item in json.loads(done.stdout)["items"]}
    assert done.returncode == 4
    assert items["jsonschema"]["status"] == "missing"
    assert items["jsonschema"]["remedy"] == f"{sys.executable} -m pip install jsonschema"
    assert items["cmake"]["status"] == "found"
    assert not (bare / "cache").exists()


def test_packages_of_the_cache_count(
    bare: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from epg.generator import bootstrap

    real = bootstrap.requirements
    others = {"plot": {"plotpackage": ("plotpackage", (1, 2))}}
    monkeypatch.setattr(bootstrap, "requirements", lambda group: others.get(group) or real(group))
    folder = bootstrap.package_folder("plot") / "plotpackage-1.3.dist-info"
    _, items, _ = doctor(capsys)
    assert items["plotpackage"]["status"] == "later"
    folder.mkdir(parents=True)
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: plotpackage\nVersion: 1.3\n")
    _, items, _ = doctor(capsys)
    found = items["plotpackage"]
    assert (found["status"], found["version"], found["source"]) == ("found", "1.3", "EPG's cache")


def test_a_wrong_table_of_the_user(
    bare: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (bare / "mine/tools").mkdir(parents=True)
    (bare / "mine/tools/x.json").write_text("{")
    monkeypatch.setenv("EPG_TARGETS_PATH", str(bare / "mine"))
    assert main(["doctor"]) == 1
    assert "this is not JSON" in capsys.readouterr().err


def test_the_real_computer(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The computer that runs these tests builds host targets, so it must have everything."""
    monkeypatch.undo()
    assert main(["doctor"]) == 0
    assert capsys.readouterr().out.endswith("\nthe host target can be built\n")
