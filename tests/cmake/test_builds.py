# SPDX-License-Identifier: Apache-2.0
"""A project around EPG may have any options: every build computes the same bits."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.cmake.project import Project

FAST = "-Ofast -ffast-math -fno-math-errno"
STRICT = "-Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wundef -Werror"

STEP = """
/* Sums, quotients and constants whose bits depend on the order, on the precision and on the mode of the processor. */
static double state = 0.3;
enum mode { OFF, ON };

void controller_step(const controller_inputs_t *inputs, controller_outputs_t *outputs)
{
    const char sign = -1; /* for compilers whose char has no sign, too */
    const enum mode mode = inputs->go > 0.5 ? ON : OFF;
    state = 2.6 * state * (1.0 - state) + (state + 0.1 - state) / 3.0 + (double)(signed char)sign * 1e-3;
    outputs->duty = mode == ON ? state : 0.0;
    outputs->log = 4e-320 * inputs->go;
    outputs->reset = (state / 7.0 * 7.0 - state) * 1e15 + (0.1 + state * 0.7 - 0.1 - state * 0.7) * 1e15;
}
"""


@dataclass(frozen=True)
class Build:
    name: str
    options: tuple[str, ...] = ()  #: of CMake
    needs: str = ""  #: a compiler
    compiles: str = ""  #: a program that the compiler must be able to build with ``flags``
    flags: str = ""


def c(flags: str) -> str:
    return f"-DCMAKE_C_FLAGS={flags}"


BUILDS = [
    Build("single-precision constants", (c("-fsingle-precision-constant"),)),
    Build("fast mathematics", (c(f"{FAST} -march=native"),)),
    Build("parts of fast mathematics", (c("-O3 -ffinite-math-only -fassociative-math -freciprocal-math "
                                          "-fno-signed-zeros -fno-trapping-math -fexcess-precision=fast"),)),
    Build("unity, Debug with a postfix", ("-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_BUILD_TYPE=Debug",
                                          "-DCMAKE_DEBUG_POSTFIX=d", "-DBUILD_SHARED_LIBS=ON")),
    Build("link-time optimisation, hidden", ("-DCMAKE_INTERPROCEDURAL_OPTIMIZATION=ON", "-DCMAKE_BUILD_TYPE=Release",
                                             c("-fvisibility=hidden"))),
    Build("small, other C types, C99", ("-DCMAKE_BUILD_TYPE=MinSizeRel", "-DCMAKE_C_STANDARD=99",
                                        c("-fshort-enums -funsigned-char"))),
    Build("strict warnings", ("-DCMAKE_BUILD_TYPE=RelWithDebInfo", c(STRICT))),
    Build("sanitizers", (c("-fsanitize=address,undefined -fno-sanitize-recover=all"),)),
    Build("clang, fast mathematics", ("-DCMAKE_C_COMPILER=clang", c(FAST)), needs="clang"),
    Build("32 bits", (c("-m32"),), needs="gcc", flags="-m32"),
    Build("musl", ("-DCMAKE_C_COMPILER=musl-gcc",), needs="musl-gcc"),
]  # fmt: skip
"""Each must compute the bits of the plain build."""


def trace(build: Build, folder: Path) -> bytes:
    """Configures, builds and runs the project like its user; returns the trace."""
    project = Project(folder, "robot")
    text = (project.source / "model/controller.c").read_text(encoding="utf-8")
    project.edit("model/controller.c", text[text.index("void controller_step") :], STEP.lstrip())
    project.configure(*build.options)
    project.build()
    file = folder / "trace.csv"
    subprocess.run(
        [project.build_folder / "robot_host", "--duration=0.5", f"--trace={file}", "--quiet"], check=True, timeout=60
    )
    return file.read_bytes()


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    content = trace(Build("plain"), tmp_path_factory.mktemp("plain"))
    assert b",3.9999" in content, "a subnormal number"
    return content


@pytest.mark.parametrize("build", BUILDS, ids=lambda build: build.name.replace(" ", "-"))
def test_the_bits_are_those_of_the_plain_build(build: Build, plain: bytes, tmp_path: Path) -> None:
    if build.needs:
        compiler = shutil.which(build.needs)
        if compiler is None:
            pytest.skip(f"{build.needs} is not installed")
        (tmp_path / "empty.c").write_text('#include <stdio.h>\nint main(void) { return puts("") < 0; }\n')
        command = [compiler, *build.flags.split(), str(tmp_path / "empty.c"), "-o", str(tmp_path / "empty")]
        if subprocess.run(command, capture_output=True).returncode != 0:
            pytest.skip(f"{build.needs} cannot link with {build.flags}: sudo apt install gcc-multilib")
    assert trace(build, tmp_path) == plain


SMALL = "-DCMAKE_C_FLAGS_RELEASE=-Os"


@pytest.mark.parametrize(
    ("options", "of_epg", "of_the_user"),
    [
        ((), ["-O2"], []),
        (("-DCMAKE_BUILD_TYPE=Debug",), ["-O2"], []),
        (("-DCMAKE_BUILD_TYPE=Debug", SMALL, "-DCMAKE_C_FLAGS_DEBUG=-O0 -g3"), ["-O0", "-Os"], ["-O0"]),
        (("-DCMAKE_BUILD_TYPE=Release",), ["-O3"], ["-O3"]),
        ((c("-Os"),), ["-Os"], ["-Os"]),
        (("-DCMAKE_BUILD_TYPE=Debug", "-DEPG_OPTIMIZE=OFF"), [], []),
        (("-DCMAKE_C_COMPILER=clang", "-DCMAKE_BUILD_TYPE=Debug"), ["-O2"], []),
    ],
    ids=["no type", "Debug", "Debug of STM32CubeMX", "Release", "an own option", "switched off", "clang"],
)
def test_epgs_code_is_optimised(
    options: tuple[str, ...], of_epg: list[str], of_the_user: list[str], tmp_path: Path
) -> None:
    if "-DCMAKE_C_COMPILER=clang" in options and not shutil.which("clang"):
        pytest.skip("clang is not installed")
    project = Project(tmp_path, "robot")
    (project.source / "user.c").write_text("int user;\n")
    (project.source / "CMakeLists.txt").open("a").write("add_library(user STATIC user.c)\n")
    project.configure(*options)
    entries = json.loads((project.build_folder / "compile_commands.json").read_text())
    commands = {Path(entry["file"]).name: entry["command"].split() for entry in entries}
    for name in ("robot_app.c", "controller.c", "control.c", "host.c", "main.c"):
        assert [word for word in commands[name] if word.startswith("-O")] == of_epg, name
        assert "-DCMAKE_BUILD_TYPE=Debug" not in options or {"-g", "-g3"} & set(commands[name])
    assert [word for word in commands["user.c"] if word.startswith("-O")] == of_the_user


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("-ffast-math", "EPG: an option of the compiler changes results: remove -ffast-math"),
        ("-fsingle-precision-constant", "constants must have double precision: remove -fsingle-precision-constant"),
    ],
)
def test_what_cannot_be_undone_stops_the_build(option: str, message: str, tmp_path: Path) -> None:
    """The options of a source come behind all others."""
    project = Project(tmp_path, "robot")
    (project.source / "CMakeLists.txt").open("a").write(
        f'set_source_files_properties("${{CMAKE_SOURCE_DIR}}/model/controller.c" PROPERTIES COMPILE_OPTIONS {option})\n'
    )
    project.configure()
    output = project.build(check=False)
    assert message in output
    assert not (project.build_folder / "robot_host").exists()
