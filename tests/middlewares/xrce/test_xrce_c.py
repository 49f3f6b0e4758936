# SPDX-License-Identifier: Apache-2.0
"""Framing, and the middleware with eProsima's client in the clock of a test: each ``TEST(name)`` in ``c/``.

Everything, also the client library, is compiled with sanitizers.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.doubles.toolchain import Missing, xrce_libraries
from tests.middlewares.test_console_c import program

ROOT = Path(__file__).resolve().parents[3]
XRCE = ROOT / "targets" / "middlewares" / "xrce"
HERE = Path(__file__).resolve().parent / "c"
AGENT = ROOT / "tests" / "doubles" / "xrce_agent" / "clocked"


@pytest.fixture(scope="session")
def client(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """The client library as EPG compiles it, with sanitizers: the archive, and options for its headers."""
    try:
        xrce_libraries()
    except Missing as missing:
        pytest.skip(str(missing))
    if not shutil.which("ninja"):
        pytest.skip("Ninja is not installed: sudo apt install ninja-build")
    folder = tmp_path_factory.mktemp("xrce_client")
    (folder / "CMakeLists.txt").write_text(
        f"""cmake_minimum_required(VERSION 3.22)
project(client LANGUAGES C)
include("{ROOT.as_posix()}/cmake/EPGConfig.cmake")
include("{XRCE.as_posix()}/middleware.cmake")
add_library(middleware STATIC "{XRCE.as_posix()}/xrce_clock.c")
target_include_directories(middleware PRIVATE "{ROOT.as_posix()}/targets/runtime/include")
_epg_middleware_xrce(middleware)
set_target_properties(epg_micro_xrce_dds_client PROPERTIES EXCLUDE_FROM_ALL FALSE)
get_target_property(folders epg_micro_xrce_dds_client INTERFACE_INCLUDE_DIRECTORIES)
get_target_property(sources epg_micro_xrce_dds_client SOURCES)
file(WRITE "${{CMAKE_BINARY_DIR}}/folders.txt" "${{folders}}")
file(WRITE "${{CMAKE_BINARY_DIR}}/sources.txt" "${{sources}}")
"""
    )
    flags = " ".join(["-O1", "-g", *program.ADDRESS_SANITIZER])
    for command in (
        ["cmake", "-S", str(folder), "-B", str(folder / "build"), "-G", "Ninja", f"-DCMAKE_C_FLAGS={flags}"],
        ["cmake", "--build", str(folder / "build"), "--target", "epg_micro_xrce_dds_client"],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    folders = (folder / "build" / "folders.txt").read_text().split(";")
    options = [option for name in folders for option in ("-isystem", name)]
    return folder / "build" / "libepg_micro_xrce_dds_client.a", options


@pytest.fixture(scope="session")
def link_tests(tmp_path_factory: pytest.TempPathFactory) -> Path:
    output: Path = program.compile_program(
        tmp_path_factory.mktemp("xrce_link") / "link_tests",
        [HERE / "link_tests.c", XRCE / "xrce_link.c"],
        includes=[XRCE, HERE],
    )
    return output


@pytest.fixture(scope="session")
def session_tests(client: tuple[Path, list[str]], tmp_path_factory: pytest.TempPathFactory) -> Path:
    archive, options = client
    sources = [
        HERE / "session_tests.c",
        AGENT / "agent.c",
        *program.FAKES,
        *sorted(XRCE.glob("*.c")),
        *program.runtime_sources(),
    ]
    output: Path = program.compile_program(
        tmp_path_factory.mktemp("xrce_session") / "session_tests",
        [*sources, archive],
        options=("-O1", *program.ADDRESS_SANITIZER, *options),
        includes=[XRCE, HERE, AGENT],
    )
    return output


@pytest.mark.parametrize("name", program.names_in(HERE / "link_tests.c"))
def test_link(link_tests: Path, name: str) -> None:
    done = program.run_program([link_tests, name])
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", program.names_in(HERE / "session_tests.c"))
def test_session(session_tests: Path, name: str) -> None:
    done = program.run_program([session_tests, name])
    assert done.returncode == 0, done.stderr


def test_it_needs_no_heap(client: tuple[Path, list[str]], tmp_path: Path) -> None:
    """Besides EPG's runtime, middleware and client library need only functions that copy and compare bytes."""
    archive, options = client
    undefined: set[str] = set()
    defined: set[str] = set()
    library = (archive.parent / "sources.txt").read_text().split(";")
    sources = [*XRCE.glob("*.c"), *program.runtime_sources(), *map(Path, library)]
    for number, source in enumerate(sources):
        output = tmp_path / f"{number}.o"
        command = ["gcc", "-Os", "-w", "-fno-stack-protector", "-fno-builtin", f"-I{program.RUNTIME / 'include'}"]
        subprocess.run([*command, *options, "-c", str(source), "-o", str(output)], check=True)
        for line in subprocess.run(["nm", str(output)], capture_output=True, text=True, check=True).stdout.splitlines():
            letter, name = line.split()[-2:]
            (undefined if letter == "U" else defined).add(name)
    text = {"memcpy", "memmove", "memset", "memchr", "memcmp", "strchr", "strcmp", "strcspn", "strlen", "strncmp"}
    text |= {"strrchr", "strspn", "strstr"}
    needed = {name for name in undefined - defined if not name.startswith("epg_port_")}
    assert needed <= {*text, "_GLOBAL_OFFSET_TABLE_"}


@pytest.mark.parametrize("core", ["cortex-m0plus", "cortex-m33", "cortex-m7"])
def test_it_compiles_for_microcontrollers_without_a_warning(
    client: tuple[Path, list[str]], tmp_path: Path, core: str
) -> None:
    compiler = shutil.which("arm-none-eabi-gcc")
    if compiler is None:
        pytest.skip("arm-none-eabi-gcc is not installed: sudo apt install gcc-arm-none-eabi libnewlib-arm-none-eabi")
    command = [compiler, f"-mcpu={core}", "-mthumb", "-Os", "-std=c11", *program.WARNINGS, "-c"]
    command += [f"-I{program.RUNTIME / 'include'}", *client[1]]
    for source in XRCE.glob("*.c"):
        done = subprocess.run(
            [*command, str(source), "-o", str(tmp_path / f"{source.stem}.o")],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
