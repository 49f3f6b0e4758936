# SPDX-License-Identifier: Apache-2.0
"""The messages in the output of CMake, compilers, linkers and EPG; recorded output for tools that do not run here."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from epg.connect.build.build_messages import LIMIT, BuildMessage, Messages, plain

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = {"arm-none-eabi-gcc": "gcc-arm-none-eabi", "ninja": "ninja-build"}


def read(text: str, *folders: Path, failed: bool = True) -> list[BuildMessage]:
    messages = Messages(folders or (Path("/project"), Path("/project/build")))
    for line in text.split("\n"):
        messages.read(plain(line))
    return messages.finish(failed=failed)


def said(folder: Path, *command: str) -> str:
    """The output of a program, stdout and stderr together."""
    if shutil.which(command[0]) is None:
        pytest.skip(f"{command[0]} is not installed: sudo apt install {PACKAGES.get(command[0], command[0])}")
    environment = {"PATH": "/usr/local/bin:/usr/bin:/bin", "LC_ALL": "C.UTF-8"}
    done = subprocess.run(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment, check=False
    )
    return done.stdout


def cmake(folder: Path, text: str) -> str:
    header = "cmake_minimum_required(VERSION 3.22)\nproject(test NONE)\n"
    (folder / "CMakeLists.txt").write_text(header + text)
    return said(folder, "cmake", "-S", str(folder), "-B", str(folder / "build"))


# CMake ----------------------------------------------------------------------------------------------------------------


def test_cmakes_paragraphs_are_put_together_again_and_the_remedy_is_the_hint(tmp_path: Path) -> None:
    long = "This sentence is much longer than what CMake leaves on one line of its messages, which is about eighty."
    command = (
        "git clone --depth 1 --branch 2.2.0 --recurse-submodules=lib/tinyusb https://example.org/sdk.git /a/folder"
    )
    text = f'message(SEND_ERROR "{long}\n  set(X 1)\n  set(Y 2)\nAnother.\n\nThe last. Get it:\n  {command}")\n'
    (found,) = read(cmake(tmp_path, text), tmp_path)
    assert (found.severity, found.file, found.line) == ("error", str(tmp_path / "CMakeLists.txt"), 3)
    assert found.message == f"{long}\n\n  set(X 1)\n  set(Y 2)\n\nAnother.\n\nThe last."
    assert found.hint == f"get it: {command}"


def test_a_message_about_several_missing_parts_is_one_for_each(tmp_path: Path) -> None:
    text = 'message(SEND_ERROR "This lacks parts.\nOne was not found. Get it:\n  get one\n'
    text += 'Another was not found. Get it:\n  get  another\nThen configure again.")\n'
    found = read(cmake(tmp_path, text), tmp_path)
    assert [(each.message, each.hint) for each in found] == [
        ("One was not found.", "get it: get one"),
        ("Another was not found.", "get it: get  another"),
    ]


def test_an_error_inside_a_library_stands_where_the_project_calls_it(tmp_path: Path) -> None:
    (tmp_path / "library").mkdir()
    (tmp_path / "library/own.cmake").write_text('function(own)\n  message(FATAL_ERROR "no")\nendfunction()\n')
    (tmp_path / "project").mkdir()
    text = 'include("${CMAKE_SOURCE_DIR}/../library/own.cmake")\nown()\n'
    (found,) = read(cmake(tmp_path / "project", text), tmp_path / "project")
    assert (found.message, found.file, found.line) == ("no", str(tmp_path / "project/CMakeLists.txt"), 4)


def test_warnings_and_several_errors_are_all_there_and_each_once(tmp_path: Path) -> None:
    text = 'message(WARNING "careful")\nforeach(i 1 2)\nmessage(SEND_ERROR "one")\nendforeach()\nunknown_command()\n'
    found = read(cmake(tmp_path, text), tmp_path)
    assert [(each.severity, each.message, each.line) for each in found] == [
        ("warning", "careful", 3),
        ("error", "one", 5),
        ("error", 'Unknown CMake command "unknown_command".', 7),
    ]


def test_a_parse_error_and_a_package_that_is_missing(tmp_path: Path) -> None:
    (found,) = read(cmake(tmp_path, "if(\n"), tmp_path)
    assert found.message.startswith("Parse error.") and found.line == 3
    (found,) = read(cmake(tmp_path, "find_package(Nonsense REQUIRED)\n"), tmp_path)
    assert '"Nonsense"' in found.message and "\n\n  NonsenseConfig.cmake\n" in found.message


def test_a_command_line_that_cmake_refuses(tmp_path: Path) -> None:
    (found,) = read(said(tmp_path, "cmake", "-S", "nowhere", "-B", "build"), tmp_path)
    assert found.message == f'The source directory "{tmp_path}/nowhere" does not exist.'


# compilers and linkers ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("compiler", ["gcc", "arm-none-eabi-gcc", "clang"])
def test_compilers(compiler: str, tmp_path: Path) -> None:
    source = 'int main(void)\n{\n    int x;\n    missing_type y;\n    return 0;\n}\n#include "missing.h"\n'
    (tmp_path / "main.c").write_text(source)
    output = said(tmp_path, compiler, "-Wall", "-fdiagnostics-color=always", "-c", "main.c")
    assert "\x1b[" in output
    found = read(output, tmp_path / "nowhere", tmp_path)
    assert {each.file for each in found} == {str(tmp_path / "main.c")}, "a relative name, found in the second folder"
    (header,) = [each for each in found if each.line == 7]
    assert header.severity == "error" and "missing.h" in header.message and header.column == 10
    if compiler != "clang":  # clang continues without the header
        return
    assert any(each.line == 4 and "missing_type" in each.message for each in found)


@pytest.mark.parametrize("linker", ["gcc", "arm-none-eabi-gcc"])
def test_linkers(linker: str, tmp_path: Path) -> None:
    (tmp_path / "a.c").write_text("void gone(void);\nint main(void)\n{\n    gone();\n    gone();\n}\n")
    (tmp_path / "b.c").write_text("int other = 2;\n")
    (tmp_path / "c.c").write_text("int other = 2;\n")
    for flags in ((), ("-g",)):
        output = said(tmp_path, linker, *flags, "-nostartfiles", "a.c", "b.c", "c.c")
        found = [each.message for each in read(output, tmp_path) if each.severity == "error"]
        assert [text.split(";")[0] for text in found] == [
            "multiple definition of `other'",
            "undefined reference to `gone'",
        ]


# Output of `gcc -g -nostartfiles a.c b.c c.c`, and without -g, with the linkers of Debian 12 and 13
BINUTILS_2_40 = """\
/usr/bin/ld: /tmp/ccVa.o:/project/c.c:1: multiple definition of `other'; /tmp/ccgW.o:/project/b.c:1: first defined here
/usr/bin/ld: /tmp/ccmy7B0y.o: in function `main':
/project/a.c:4: undefined reference to `gone'
/usr/bin/ld: /project/a.c:5: undefined reference to `gone'
collect2: error: ld returned 1 exit status
"""
BINUTILS_2_44 = """\
/usr/bin/ld: /tmp/ccnY.o:/project/c.c:1: multiple definition of `other'; /tmp/cchi.o:/project/b.c:1: first defined here
/usr/bin/ld: /tmp/ccJ8ZRQ7.o: in function `main':
/project/a.c:4:(.text+0x5): undefined reference to `gone'
/usr/bin/ld: /project/a.c:5:(.text+0xa): undefined reference to `gone'
collect2: error: ld returned 1 exit status
"""
WITHOUT_LINES = """\
/usr/bin/ld: /tmp/ccHD.o:(.data+0x0): multiple definition of `other'; /tmp/cciS.o:(.data+0x0): first defined here
/usr/bin/ld: /tmp/ccOs9f7b.o: in function `main':
a.c:(.text+0x5): undefined reference to `gone'
/usr/bin/ld: a.c:(.text+0xa): undefined reference to `gone'
collect2: error: ld returned 1 exit status
"""
MAKE = """\
gmake[2]: *** [CMakeFiles/own.dir/build.make:97: own] Error 1
gmake[1]: *** [CMakeFiles/Makefile2:83: CMakeFiles/own.dir/all] Error 2
gmake[1]: *** Waiting for unfinished jobs....
gmake: *** [Makefile:91: all] Error 2
"""


@pytest.mark.parametrize("after", ["", MAKE], ids=["ninja", "make"])
@pytest.mark.parametrize(("text", "lines"), [(BINUTILS_2_40, (1, 4)), (BINUTILS_2_44, (1, 4)), (WITHOUT_LINES, (0, 0))])
def test_linkers_as_they_were_recorded(text: str, lines: tuple[int, int], after: str) -> None:
    found = read(text + after)
    assert [(each.message.split(";")[0], each.line) for each in found] == [
        ("multiple definition of `other'", lines[0]),
        ("undefined reference to `gone'", lines[1]),
    ]
    assert Path(found[1].file).name == "a.c"


def test_make_adds_nothing_to_a_failure_that_nobody_understands() -> None:
    (found,) = read("the moon is in the wrong quarter\n" + MAKE)
    assert (found.id, found.message) == ("build-failed", "the moon is in the wrong quarter")


def test_a_memory_that_is_too_small(tmp_path: Path) -> None:
    (tmp_path / "a.c").write_text("const char big[4096] = {1};\n")
    (tmp_path / "a.ld").write_text(
        "MEMORY { FLASH(rx) : ORIGIN = 0, LENGTH = 1K }\nSECTIONS { .text : { *(.text*) *(.rodata*) } > FLASH }\n"
    )
    output = said(tmp_path, "arm-none-eabi-gcc", "-nostdlib", "-T", "a.ld", "a.c")
    texts = [each.message for each in read(output, tmp_path) if each.severity == "error"]
    assert len(texts) == 1 and "section `.text' will not fit in region `FLASH'" in texts[0], output


def test_a_program_of_windows_that_still_runs() -> None:
    lines = (
        "C:/mingw64/x86_64-w64-mingw32/bin/ld.exe: cannot open output file jiwy_host.exe: Permission denied\n"
        "collect2.exe: error: ld returned 1 exit status"
    )
    (message,) = read(lines)
    assert message.message == "cannot open output file jiwy_host.exe: Permission denied"
    assert message.hint == "the program may be running: end it, and generate again"


def test_a_library_and_an_option_that_are_not_there(tmp_path: Path) -> None:
    (tmp_path / "a.c").write_text("int main(void)\n{\n    return 0;\n}\n")
    (found,) = read(said(tmp_path, "gcc", "a.c", "-lnonsense_of_mine"), tmp_path)
    assert found.message.startswith("cannot find -lnonsense_of_mine")
    (found, *_) = read(said(tmp_path, "gcc", "-fnonsense-of-mine", "a.c"), tmp_path)
    assert "-fnonsense-of-mine" in found.message and found.severity == "error"


def test_ninja_itself(tmp_path: Path) -> None:
    (tmp_path / "build.ninja").write_text("rule copy\n  command = cp $in $out\nbuild a: copy missing\n")
    (found,) = read(said(tmp_path, "ninja"), tmp_path)
    assert found.message == "'missing', needed by 'a', missing and no known rule to make it"


def test_make_itself(tmp_path: Path) -> None:
    (tmp_path / "Makefile").write_text("a: missing\n\tcp missing a\n")
    (found,) = read(said(tmp_path, "make"), tmp_path)
    assert found.message.startswith("No rule to make target 'missing', needed by 'a'")


def test_microsofts_compiler() -> None:
    """The output of Visual Studio's compiler."""
    (found,) = read("C:\\robot\\main.c(4,5): error C2065: 'x': undeclared identifier [C:\\robot\\b\\r.vcxproj]")
    assert (found.file, found.line, found.column, found.id) == ("C:\\robot\\main.c", 4, 5, "C2065")


# EPG ------------------------------------------------------------------------------------------------------------------


def test_epgs_messages_are_whole_and_cmake_adds_nothing(tmp_path: Path) -> None:
    """The messages as on the command line, and then the output of CMake."""
    bindings = tmp_path / "jiwy.bindings.yaml"
    text = (ROOT / "examples/jiwy/jiwy.bindings.yaml").read_text()
    bindings.write_text(
        text.replace("pwm_tilt: pwm_tilt", "pwm_tilt: pwm_pan").replace("pan: encoder_pan", "pan: enc", 1)
    )
    command = [sys.executable, "-m", "epg", "check", "--tcf", "host_jiwy.tcf", "--model", "examples/jiwy/model"]
    done = subprocess.run(
        [*command, "--bindings", str(bindings)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    after = (
        "CMake Error at /opt/epg/cmake/EPGTarget.cmake:52 (message):\n"
        "  EPG: target 'jiwy' was not generated; the messages above say why\nCall Stack (most recent call first):\n"
        "  CMakeLists.txt:15 (epg_add_target)\n\n\n-- Configuring incomplete, errors occurred!\n"
    )
    found = read(done.stderr + after, tmp_path)
    assert [(each.id, each.severity) for each in found] == [("unknown-component", "error"), ("bound-twice", "error")]
    assert found[0].message == "there is no component 'enc'" and found[0].file == str(bindings)
    assert found[1].hint == "remove one of the two", "the hint after a note"
    assert read(after, tmp_path)[0].message.startswith("EPG: target 'jiwy' was not generated"), (
        "alone, it is all there is"
    )


# Zephyr, recorded output of its scripts -------------------------------------------------------------------------------

STACK = """\
Call Stack (most recent call first):
  /zephyr/cmake/modules/zephyr_default.cmake:131 (include)
  CMakeLists.txt:17 (find_package)


-- Configuring incomplete, errors occurred!
"""
DEVICETREE = f"""\
-- Found devicetree overlay: /project/app.overlay
devicetree error: /project/app.overlay:1 (column 11): parse error: expected node name, property name, or '}}'
CMake Error at /zephyr/cmake/modules/dts.cmake:306 (execute_process):
  execute_process failed command indexes:

    1: "Child return code: 1"

{STACK}"""
KCONFIG = f"""\
Merged configuration '/project/prj.conf'

warning: SPI_ASYNC (defined at drivers/spi/Kconfig:25) was assigned the value 'y' but got the value
'n'. Check these unsatisfied dependencies: SPI (=n).


/project/prj.conf:3: warning: attempt to assign the value 'y' to the undefined symbol NONSENSE

error: Aborting due to Kconfig warnings

CMake Error at /zephyr/cmake/modules/kconfig.cmake:373 (message):
  command failed with return code: 1
{STACK}"""
TRACEBACK = f"""\
Traceback (most recent call last):
  File "/zephyr/scripts/dts/gen_edt.py", line 48, in main
    edt = edtlib.EDT(args.dts)
          ^^^^^^^^^^^^^^^^^^^^
devicetree.dtlib.DTError: expected property 'clock-frequency' to be assigned with a number
CMake Error at /zephyr/cmake/modules/dts.cmake:306 (execute_process):
  execute_process failed command indexes:

    1: "Child return code: 1"

{STACK}"""


def test_devicetree() -> None:
    (found,) = read(DEVICETREE)
    assert (found.file, found.line, found.column) == ("/project/app.overlay", 1, 11)
    assert found.message.startswith("parse error: expected node name")


def test_kconfig_gives_up_because_of_a_warning() -> None:
    first, second = read(KCONFIG)
    assert first.severity == "warning" and first.message.endswith("unsatisfied dependencies: SPI (=n).")
    assert (second.severity, second.file, second.line) == ("error", "/project/prj.conf", 3)


def test_a_script_that_fails_says_why_in_its_last_line() -> None:
    (found,) = read(TRACEBACK)
    assert found.message.startswith("devicetree.dtlib.DTError: expected property")


# anything -------------------------------------------------------------------------------------------------------------


def test_unknown_failures_are_the_last_lines_without_noise() -> None:
    lines = [f"[{number}/40] Building C object {number}.o" for number in range(30)]
    (found,) = read("\n".join([*lines, "FAILED: own", "the moon is wrong", "ninja: build stopped: subcommand failed."]))
    assert (found.id, found.message) == ("build-failed", "the moon is wrong")
    assert read("", failed=True)[0].message == "the build failed without a message"
    assert read("the moon is wrong", failed=False) == []


def test_a_header_that_is_wrong_gives_so_many_messages_and_no_more() -> None:
    found = read("\n".join(f"/project/a.h:{number}:1: error: wrong" for number in range(1, 1000)))
    assert len(found) == LIMIT and found[0].line == 1


def test_plain_lines() -> None:
    assert plain("\x1b[01;31m\x1b[Kerror: \x1b[m\x1b[Kno\x07") == "error: no"
    assert plain("10 %\r20 %\rdone") == "done"
    assert plain("\x1b]8;;https://example.org\x1b\\a link\x1b]8;;\x1b\\") == "a link"
