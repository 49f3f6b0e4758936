# SPDX-License-Identifier: Apache-2.0
"""Makes the Python packages that EPG needs importable in any Python.

The Python that CMake selects may lack jinja2, PyYAML or jsonschema, and it may refuse ``pip install``.  (Debian's
externally managed Python has no ensurepip either.)  Therefore EPG installs the packages once, with
``pip install --target``, into a folder of its cache.  The name of this folder contains the version of Python and a hash
of the lock file.  ``epg/generator/lock/*.in`` name the packages and their oldest versions.  The lock files
(``epg/generator/lock/*.txt``) pin every file by its hash.  The folder is prepared under a temporary name and renamed
when it is complete.  Thus an interrupted or concurrent installation never leaves an incomplete folder.

This module uses only the standard library.  To renew a lock file::

    uv pip compile --universal --generate-hashes --python-version 3.10 --no-header --no-annotate X.in -o X.txt
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
from importlib.machinery import ModuleSpec
from pathlib import Path

# Every run of EPG imports the modules above.  Modules that only an installation needs are imported in its functions.

LOCKS = Path(__file__).resolve().parent / "lock"

Requirements = dict[str, tuple[str, tuple[int, ...]]]
"""For each module that EPG needs: its distribution, and the oldest version that EPG accepts."""


def requirements(group: str) -> Requirements:
    """The packages of ``epg/generator/lock/<group>.in``."""
    result: Requirements = {}
    for line in requirement_lines(group):
        distribution, _, oldest = line.partition(">=")
        module = "yaml" if distribution == "PyYAML" else distribution.lower().replace("-", "_")
        result[module] = distribution, version_numbers(oldest)
    return result


def requirement_lines(group: str) -> list[str]:
    """The lines ``<distribution>>=<version>`` of ``epg/generator/lock/<group>.in``, with those of the files that it
    includes.

    A line ``-r <other>.in`` includes a file.  The lock file and the extras of EPG's wheel are made of the same lines.
    """
    lines: list[str] = []
    for line in (LOCKS / f"{group}.in").read_text(encoding="utf-8").splitlines():
        lines += requirement_lines(line[3:].removesuffix(".in")) if line.startswith("-r ") else [line]
    return lines


class MissingPackages(Exception):
    """Packages are missing and were not installed.  The message says how the user can get them."""


def cache_folder() -> Path:
    """The folder of EPG's cache: ``$EPG_CACHE``, else ``~/.cache/epg`` (``%LOCALAPPDATA%\\epg`` on Windows)."""
    if os.environ.get("EPG_CACHE"):
        return Path(os.environ["EPG_CACHE"])
    from epg.generator.system import here

    return here.caches() / "epg"


def cache_problem(folder: Path) -> str:
    """The reason why EPG must not use the cache in ``folder``; empty if only the user can change its files.

    EPG runs programs of its cache, so other users must not be able to change them.  A folder that does not exist yet
    is not a problem: EPG makes it with access for its owner only.
    """
    from epg.generator.system import here

    return here.access_problem(folder)


def check_cache() -> None:
    """Raises :class:`MissingPackages` if other users can change what is in EPG's cache."""
    folder = cache_folder()
    problem = cache_problem(folder)
    if problem:
        raise MissingPackages(
            f"EPG does not use its cache, {folder}: {problem}, and EPG runs programs that are in it\n"
            "hint: delete it, or set EPG_CACHE to another folder, or, if you trust all files in it, "
            f"remove the permissions of other users (chmod -R go-w {folder})"
        )


def ensure(group: str = "generator", *, install: bool | None = None) -> None:
    """Makes the packages of ``group`` importable.  Installs them into EPG's cache if they are missing.

    ``install`` allows this installation.  With None it is allowed unless the environment variable ``EPG_NO_INSTALL``
    is set.  Raises :class:`MissingPackages`.
    """
    check_cache()
    missing = _missing(group)
    if not missing:
        return
    folder = package_folder(group)
    if not folder.is_dir():
        allowed = not os.environ.get("EPG_NO_INSTALL") if install is None else install
        if not allowed:
            raise MissingPackages(_remedy(missing, "their installation is turned off"))
        _install(group, folder, missing)
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    still = _missing(group)
    if still:
        raise MissingPackages(_remedy(still, f"{folder} does not contain them; delete it, and EPG makes it again"))


def main(arguments: list[str]) -> int:
    """``python epg/generator/bootstrap.py GROUP``: prints the folder that must be added to the module path.

    Prints an empty line if this Python has all packages already.  Returns 4 if packages are missing.
    """
    try:
        missing = bool(_missing(arguments[0]))
        ensure(arguments[0])
    except MissingPackages as problem:
        sys.stderr.write(f"{problem}\n")
        return 4
    print(package_folder(arguments[0]).as_posix() if missing else "")
    return 0


def _missing(group: str) -> list[str]:
    """Distributions of ``group`` that cannot be imported or are too old."""
    result = []
    for module, (distribution, oldest) in requirements(group).items():
        if module in sys.modules:
            continue
        spec = importlib.util.find_spec(module)
        version = _version(distribution, spec) if spec else "0"
        if version is not None and version_numbers(version) < oldest:
            result.append(distribution)
    return sorted(result)


def _version(distribution: str, spec: ModuleSpec) -> str | None:
    """The version of an installed module, read from the name of its ``dist-info`` or ``egg-info``; None without one.

    ``importlib.metadata`` would handle more cases, but its import alone takes twice as long as ``python -c pass``.
    """
    if spec.origin is None:
        return None
    beside = Path(spec.origin).parent.parent if spec.submodule_search_locations else Path(spec.origin).parent
    wanted = distribution.lower().replace("-", "_")
    for name in os.listdir(beside):
        stem, _, suffix = name.rpartition(".")
        if suffix in ("dist-info", "egg-info"):
            found, _, version = stem.partition("-")
            if found.lower().replace("-", "_").replace(".", "_") == wanted:
                return version.partition("-")[0]
    return None


def version_numbers(version: str) -> tuple[int, ...]:
    """The first three numbers of a version, to compare it with others: ``6.0.1`` gives (6, 0, 1)."""
    numbers = []
    for part in version.split(".")[:3]:
        digits = "".join(char for char in part if char.isdigit())
        numbers.append(int(digits or 0))
    return tuple(numbers)


def package_folder(group: str) -> Path:
    """The folder of EPG's cache for the packages of ``group`` and this interpreter.  It may not exist yet."""
    import hashlib

    lock = hashlib.sha256((LOCKS / f"{group}.txt").read_bytes()).hexdigest()[:12]
    abi = f"{sys.implementation.cache_tag}-{sys.platform}-{'64' if sys.maxsize > 2**32 else '32'}"
    return cache_folder() / f"python-{group}-{abi}-{lock}"


def _install(group: str, folder: Path, missing: list[str]) -> None:
    """Installs the packages of ``group`` with pip into ``folder``.

    pip installs wheels with the hashes of the lock file only, into a temporary folder, which is renamed at the end.
    Variables of the environment that change Python are not passed on.  Raises :class:`MissingPackages`.
    """
    if importlib.util.find_spec("pip") is None:
        raise MissingPackages(_remedy(missing, "this Python has no pip, which must install them"))
    import shutil
    import subprocess
    import tempfile

    sys.stderr.write(f"EPG: installing {', '.join(missing)} for {sys.executable} into {folder} (once)\n")
    sys.stderr.flush()
    try:
        folder.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(dir=folder.parent, prefix=f".{folder.name}."))
    except OSError as error:
        raise MissingPackages(_remedy(missing, f"EPG's cache cannot be written: {error}")) from error
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--no-input"]
    command += ["--progress-bar", "off", "--require-hashes", "--only-binary", ":all:", "--target", str(temporary)]
    command += ["--requirement", str(LOCKS / f"{group}.txt")]
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    environment["PIP_ROOT_USER_ACTION"] = "ignore"
    environment["PYTHONUNBUFFERED"] = "1"
    try:
        with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as errors:
            pip = subprocess.Popen(
                command, stdout=subprocess.PIPE, stderr=errors, text=True, errors="replace", env=environment
            )
            assert pip.stdout is not None
            for line in pip.stdout:
                _show_progress(line)
            if pip.wait() != 0:
                errors.seek(0)
                tail = "\n".join(errors.read().strip().splitlines()[-6:])
                raise MissingPackages(_remedy(missing, f"pip could not install them:\n{tail}"))
        try:
            os.rename(temporary, folder)
        except OSError:
            if not folder.is_dir():  # Else another process has installed the same packages in the meantime: use those.
                raise
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _show_progress(line: str) -> None:
    """Prints a short form of a line of pip's output.  A download can take a minute, and the user must see progress."""
    words = line.split()
    if line.startswith(("Collecting ", "Processing ")) and len(words) > 1:
        # "Collecting jinja2==3.1.6", or "Processing /a/folder/jinja2-3.1.6-py3-none-any.whl"
        name, _, version = Path(words[1]).name.replace("==", "-").partition("-")
        sys.stderr.write(f"EPG:   {name} {version.partition('-')[0]}\n")
    elif line.startswith("Installing collected packages:"):
        sys.stderr.write("EPG:   unpacking\n")
    sys.stderr.flush()


def _remedy(missing: list[str], reason: str) -> str:
    from epg.generator.install import package_commands

    commands = [*package_commands(missing), "cmake -DPython3_EXECUTABLE=<a Python with these packages> ..."]
    lines = "".join(f"\n    {command}" for command in commands)
    return f"EPG needs {', '.join(missing)} for {sys.executable}: {reason}\nhint: one of{lines}"


if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[2])
    sys.exit(main(sys.argv[1:]))


def blame(problem: BaseException) -> str:
    """The Python package that is the cause of ``problem``, and what to do; empty if the cause is in EPG."""
    package, file = _culprit(problem)
    if package in ("", "epg"):
        return ""
    place = Path(file).resolve() if file else None
    folders = [Path(entry).resolve() for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    if place is not None and any(folder in place.parents for folder in folders):
        hint = f"the variable PYTHONPATH has put it in the place of another one: unset PYTHONPATH ({place})"
    elif place is not None and cache_folder().resolve() in place.parents:
        folder = cache_folder().resolve() / place.relative_to(cache_folder().resolve()).parts[0]
        hint = f"delete {folder}: EPG installs it again"
    elif package in sys.stdlib_module_names:
        hint = f"it is a part of Python: install {sys.executable} again, or use another Python"
    else:
        hint = f"install it again: {sys.executable} -m pip install --force-reinstall {package}"
    if "DLL load failed" in str(problem):
        hint += "; its DLLs may need the Microsoft Visual C++ Redistributable"
    return f"the Python package '{package}' cannot be used: {problem}\nhint: {hint}\n"


def _culprit(problem: BaseException) -> tuple[str, str]:
    """The package that raised ``problem`` while it was loaded, or that lacks what EPG expects in it, and its file."""
    from types import ModuleType

    if isinstance(problem, AttributeError):
        if not isinstance(problem.obj, ModuleType):
            return "", ""
        return problem.obj.__name__.partition(".")[0], problem.obj.__file__ or ""
    if isinstance(problem, ImportError) and problem.name:
        return problem.name.partition(".")[0], problem.path or ""
    frames = _frames(problem)
    if not isinstance(problem, ImportError) and not any(name.startswith("ctypes") for name, _ in frames):
        return "", ""
    for name, file in reversed(frames):
        package = name.partition(".")[0]
        if package not in sys.stdlib_module_names and package != "__main__":
            return package, file
    return "", ""


def _frames(problem: BaseException) -> list[tuple[str, str]]:
    """The module and the file of each function through which ``problem`` went, the outermost first."""
    frames = []
    step = problem.__traceback__
    while step is not None:
        frames.append((str(step.tb_frame.f_globals.get("__name__", "")), step.tb_frame.f_code.co_filename))
        step = step.tb_next
    return frames
