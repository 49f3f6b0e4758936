# SPDX-License-Identifier: Apache-2.0
"""A Zephyr workspace on this computer, and builds in it, in folders of EPG's cache that are kept for later builds.

>>> # skip_if_missing(partial(workspace, "rpi_pico"), arm_gcc)
>>> # build("tests/zephyr/firmware", "rpi_pico") / "zephyr" / "zephyr.elf"
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from tests.doubles.toolchain import ROOT, Missing, arm_gcc, locked, tool

NATIVE = "native_sim/native/64"
"""native_sim with 64 bits, which does not need 32-bit libraries on the host."""

HALS = {"rpi_pico": "rpi_pico", "rpi_pico2/rp2350a/m33": "rpi_pico", "nucleo_h743zi": "stm32"}
"""The vendor's module that a board needs, besides CMSIS."""

PYTHON_NEEDS = "elftools, packaging, pykwalify, west, yaml"
"""Modules that Zephyr's build imports (its scripts/requirements-base.txt)."""


TWISTER_NEEDS = "anytree, colorama, jsonschema, junitparser, natsort, ply, psutil, pytest, tabulate"
"""More modules, which Zephyr's test runner imports (its scripts/requirements-build-test.txt and -run-test.txt)."""


class BuildError(Exception):
    """CMake or a compiler failed; the message is their output."""


@dataclass(frozen=True)
class Workspace:
    """Zephyr, the Python for its scripts, and the modules; EPG is the last module."""

    base: Path
    python: Path
    modules: tuple[Path, ...]

    def environment(self) -> dict[str, str]:
        """The environment for CMake and twister: Zephyr's Python is first, variables of the tests are removed."""
        environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
        environment["ZEPHYR_BASE"] = str(self.base)
        environment["PATH"] = os.pathsep.join([str(self.python.parent), environment.get("PATH", "")])
        if "ZEPHYR_TOOLCHAIN_VARIANT" not in environment:
            environment["ZEPHYR_TOOLCHAIN_VARIANT"] = "gnuarmemb"
            environment["GNUARMEMB_TOOLCHAIN_PATH"] = str(arm_gcc().parent.parent)
            # Debian's picolibc has one errno per thread
            environment["ZEPHYR_TOOLCHAIN_SUPPORTS_THREAD_LOCAL_STORAGE"] = "y"
        return environment


def c_library() -> dict[str, str]:
    """CMake settings for a complete C library, which targets need.  Raises :class:`Missing`.

    Toolchains that Zephyr knows have one: its own SDK has picolibc, Arm's toolchain newlib.  Debian's newlib lacks the
    locks that Zephyr needs; Debian's picolibc, a separate package, works.
    """
    if os.environ.get("ZEPHYR_TOOLCHAIN_VARIANT", "gnuarmemb") != "gnuarmemb":
        return {}
    compiler = str(arm_gcc())
    source = "#include <newlib.h>\n#ifndef _RETARGETABLE_LOCKING\n#error\n#endif\n"
    command = [compiler, "-x", "c", "-fsyntax-only", "-"]
    if subprocess.run(command, input=source, text=True, capture_output=True, check=False).returncode == 0:
        return {}
    command = [compiler, "-print-file-name=picolibc.specs"]
    if not Path(subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()).is_absolute():
        raise Missing("a C library that Zephyr can use is not installed: sudo apt install picolibc-arm-none-eabi")
    return {"TOOLCHAIN_HAS_PICOLIBC": "ON"}


def need_twister(here: Workspace) -> None:
    """Raises :class:`Missing` if Zephyr's test runner cannot run."""
    command = [str(here.python), "-c", f"import {TWISTER_NEEDS}"]
    if subprocess.run(command, capture_output=True, check=False, env=here.environment()).returncode != 0:
        raise Missing(
            "Python packages of Zephyr's twister are not installed: "
            f"{here.python} -m pip install {TWISTER_NEEDS.replace(',', '')}"
        )


def workspace(*boards: str) -> Workspace:
    """The workspace, if it has the modules for ``boards``.  Raises :class:`Missing`."""
    base = tool("zephyr")
    modules = []
    for name in ("cmsis", "cmsis_6", *dict.fromkeys(HALS[board] for board in boards if board in HALS)):
        module = base.parent / "modules" / "hal" / name
        if (module / "zephyr" / "module.yml").is_file():
            modules.append(module)
        elif not name.startswith("cmsis"):
            raise Missing(f"Zephyr's module hal_{name} is not in the workspace: cd {base.parent} && west update")
    if shutil.which("dtc") is None:
        raise Missing("Zephyr's build needs dtc: sudo apt install device-tree-compiler")
    return Workspace(base, _python(base), (*modules, ROOT))


def _python(base: Path) -> Path:
    """A Python with the packages that Zephyr's scripts import: this one, west's, or the workspace's own."""
    candidates = [Path(sys.executable)]
    west = shutil.which("west")
    if west is not None:
        candidates.append(Path(west).resolve().parent / "python")  # pipx installs west as a link
    candidates.append(base.parent / ".venv" / "bin" / "python")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    for python in candidates:
        if python.exists():
            command = [str(python), "-c", f"import {PYTHON_NEEDS}"]
            if subprocess.run(command, capture_output=True, check=False, env=environment).returncode == 0:
                return python
    requirements = base / "scripts" / "requirements-base.txt"
    raise Missing(f"Zephyr's Python packages are not installed: python -m pip install west -r {requirements}")


def build(
    application: str | Path,
    board: str,
    *,
    settings: Mapping[str, str] | None = None,
    modules: Sequence[Path] | None = None,
    only: str = "",
) -> Path:
    """Configures and builds an application (a path in the repository, or anywhere); returns the build folder.

    ``modules`` replaces the workspace's modules; ``only`` builds just the object file of one source, by name.  Raises
    :class:`BuildError` and :class:`Missing`.
    """
    here = workspace(board)
    source = (ROOT / application).resolve()
    given = dict(settings or {})
    given["ZEPHYR_MODULES"] = ";".join(str(path) for path in (here.modules if modules is None else modules))
    key = repr((str(source), board, str(here), sorted(given.items())))
    digest = hashlib.sha256(key.encode()).hexdigest()[:16]
    folder = cache_folder() / "test-build" / f"zephyr-{source.name}-{board.replace('/', '-')}-{digest}"
    with locked(folder):
        if not (folder / "build.ninja").is_file():
            shutil.rmtree(folder, ignore_errors=True)
            command = ["cmake", "-G", "Ninja", "-S", str(source), "-B", str(folder), f"-DBOARD={board}"]
            run([*command, *(f"-D{name}={value}" for name, value in given.items())], here)
        targets = _objects(folder, only, here) if only else []
        run(["ninja", "-C", str(folder), "-j2", *targets], here)
    return folder


def _objects(folder: Path, source: str, here: Workspace) -> list[str]:
    """The Ninja targets of a source's object files."""
    targets = run(["ninja", "-C", str(folder), "-t", "targets", "all"], here).splitlines()
    return [name for name in (line.split(": ")[0] for line in targets) if name.endswith(f"/{source}.obj")]


def run(command: Sequence[str], here: Workspace) -> str:
    """Runs a command in the workspace's environment; returns its output.  Raises :class:`BuildError`."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=here.environment())
    if done.returncode != 0:
        raise BuildError(f"{' '.join(command)}\n{done.stdout}\n{done.stderr}")
    return done.stdout + done.stderr
