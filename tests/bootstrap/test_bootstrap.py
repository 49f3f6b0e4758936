# SPDX-License-Identifier: Apache-2.0
"""EPG in a Python without its packages installs them once, completely, into its cache, or explains how to do so."""

from __future__ import annotations

import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import jinja2
import jsonschema
import pytest
import yaml

from epg.generator import bootstrap
from tests.cmake.project import ROOT, Project

EPG = [str(ROOT / "epg" / "__main__.py"), "targets"]


@pytest.fixture(scope="module")
def bare_python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A virtual environment that contains only pip."""
    folder = tmp_path_factory.mktemp("venv")
    venv.EnvBuilder(with_pip=True, symlinks=os.name != "nt").create(folder)
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def run(python: Path | str, cache: Path, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = (
        {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")} | {"EPG_CACHE": str(cache)} | variables
    )
    return subprocess.run([str(python), *arguments], capture_output=True, text=True, env=environment)


def test_packages_are_installed_once_and_found_again(bare_python: Path, tmp_path: Path) -> None:
    first = run(bare_python, tmp_path, *EPG)
    assert first.returncode == 0, first.stderr
    assert f"EPG: installing Jinja2, PyYAML, jsonschema for {bare_python} into {tmp_path}" in first.stderr
    # Every package is printed when its download begins: pip alone would print nothing for up to a minute.
    progress = [line for line in first.stderr.splitlines() if line.startswith("EPG:   ")]
    assert {line.split()[1].lower() for line in progress} >= {"jinja2", "pyyaml", "jsonschema", "unpacking"}
    assert "host" in first.stdout
    folders = [path.name for path in tmp_path.iterdir()]
    assert len(folders) == 1
    assert folders[0].startswith("python-generator-")
    second = run(bare_python, tmp_path, *EPG)
    assert (second.returncode, second.stderr) == (0, "")
    assert second.stdout == first.stdout


def test_a_python_whose_path_is_in_a_file_keeps_its_library() -> None:
    """With a file `._pth`, Python does not put the folder of the started file before the library."""
    packages = {str(Path(module.__file__).parents[1]) for module in (jinja2, jsonschema, yaml)}
    started = (
        "import runpy, sys; sys.path[:] = [p for p in sys.path if p and 'site-packages' not in p];"
        f"sys.path += {sorted(packages)!r};"
        f"sys.path.sort(key=lambda p: not p.endswith('python%d.%d' % sys.version_info[:2]));"
        f"sys.argv = ['epg', '--version']; runpy.run_path({EPG[0]!r}, run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-I", "-S", "-c", started], capture_output=True, text=True, check=False)
    assert done.stdout.startswith("epg "), done.stderr


def test_two_at_once_leave_one_complete_folder(bare_python: Path, tmp_path: Path) -> None:
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")} | {"EPG_CACHE": str(tmp_path)}
    both = [
        subprocess.Popen([str(bare_python), *EPG], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment)
        for _ in range(2)
    ]
    outputs = [process.communicate()[0].decode() for process in both]
    assert [process.returncode for process in both] == [0, 0], outputs
    assert len(list(tmp_path.iterdir())) == 1


def test_turned_off_it_names_what_is_missing(bare_python: Path, tmp_path: Path) -> None:
    done = run(bare_python, tmp_path, *EPG, EPG_NO_INSTALL="1")
    assert done.returncode == 4
    assert f"EPG needs Jinja2, PyYAML, jsonschema for {bare_python}: their installation is turned off" in done.stderr
    assert f"{bare_python} -m pip install Jinja2 PyYAML jsonschema" in done.stderr
    assert "apt install python3-jinja2 python3-pyyaml python3-jsonschema".replace("pyyaml", "yaml") in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_without_pip_it_names_what_is_missing(tmp_path: Path) -> None:
    folder = tmp_path / "venv"
    venv.EnvBuilder(with_pip=False, symlinks=os.name != "nt").create(folder)
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    done = run(python, tmp_path / "cache", *EPG)
    assert done.returncode == 4
    assert "this Python has no pip, which must install them" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_failed_installation_leaves_nothing_behind(bare_python: Path, tmp_path: Path) -> None:
    done = run(
        bare_python,
        tmp_path,
        *EPG,
        PIP_INDEX_URL="http://127.0.0.1:9/",
        PIP_EXTRA_INDEX_URL="",
        PIP_RETRIES="0",
        PIP_NO_CACHE_DIR="1",
    )
    if done.returncode == 0:
        pytest.skip("pip finds packages without an index here")
    assert done.returncode == 4
    assert "pip could not install them" in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_cache_that_cannot_be_written(bare_python: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = run(bare_python, tmp_path / "file" / "cache", *EPG)
    assert done.returncode == 4
    assert "EPG's cache cannot be written" in done.stderr


def test_cmake_with_a_bare_python(bare_python: Path, tmp_path: Path) -> None:
    cache = {"EPG_CACHE": str(tmp_path / "cache"), "PYTHONPATH": ""}
    project = Project(tmp_path / "on", "robot", cache)
    output = project.configure(f"-DPython3_EXECUTABLE={bare_python}")
    assert "EPG: installing" in output
    off = Project(tmp_path / "off", "robot", {"EPG_CACHE": str(tmp_path / "other"), "PYTHONPATH": ""})
    output = off.fails_to_configure(f"-DPython3_EXECUTABLE={bare_python}", "-DEPG_INSTALL_PYTHON_PACKAGES=OFF")
    assert "their installation is turned off" in output
    assert not (tmp_path / "other").exists()


@pytest.mark.parametrize("group", sorted(path.stem for path in bootstrap.LOCKS.glob("*.txt")))
def test_every_lock_file_pins_all_its_packages_by_hash(group: str) -> None:
    text = (bootstrap.LOCKS / f"{group}.txt").read_text()
    entries = [entry for entry in text.replace("\\\n", " ").splitlines() if entry and not entry.startswith("#")]
    assert entries
    for entry in entries:
        assert "==" in entry
        assert "--hash=sha256:" in entry
    names = {entry.split("==")[0].casefold() for entry in entries}
    assert {name.casefold() for name, _ in bootstrap.requirements(group).values()} <= names


def test_pip_and_the_bootstrap_want_the_same_packages(tmp_path: Path) -> None:
    """One file names the packages that a wheel requires and that the generator looks for."""
    command = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--no-deps",
        "--no-build-isolation",
        "-w",
        str(tmp_path),
        str(ROOT),
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    if "No module named 'hatchling'" in done.stderr + done.stdout or "Cannot import 'hatchling" in done.stdout:
        pytest.skip("hatchling is not installed: pip install hatchling")
    assert done.returncode == 0, done.stdout + done.stderr
    [wheel] = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        [name] = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        metadata = archive.read(name).decode()
    required = {line for line in metadata.splitlines() if line.startswith("Requires-Dist:")}
    for group, extra in {
        "generator": "",
        "zephyr": "zephyr",
        "plot": "plot",
        "ros": "ros",
        "mcap": "mcap",
        "test_all": "test",
    }.items():
        for distribution, oldest in bootstrap.requirements(group).values():
            condition = f"; extra == '{extra}'" if extra else ""
            assert f"Requires-Dist: {distribution.lower()}>={'.'.join(map(str, oldest))}{condition}" in required, (
                required
            )


@pytest.mark.skipif(os.name == "nt", reason="EPG: the user's folders are private on Windows")
@pytest.mark.parametrize("mode", [0o777, 0o1777, 0o775, 0o702], ids=oct)
def test_a_cache_that_others_may_write_is_not_used(mode: int, tmp_path: Path) -> None:
    """EPG would run its contents: packages, compiled templates, SDKs."""
    cache = tmp_path / "cache"
    planted = cache / bootstrap.package_folder("generator").name / "yaml"
    planted.mkdir(parents=True)
    (planted / "__init__.py").write_text("raise SystemExit('planted')\n")
    if mode == 0o775:
        if os.geteuid() != 0:
            pytest.skip("EPG: a group of others needs root")
        os.chown(cache, 0, 4321)
    cache.chmod(mode)
    done = run(sys.executable, cache, *EPG)
    assert done.returncode == 4 and "planted" not in done.stderr
    assert f"EPG does not use its cache, {cache}: other users can write into it (mode {mode:o})" in done.stderr
    assert "EPG_CACHE" in done.stderr and "Traceback" not in done.stderr
    said = run(sys.executable, cache, EPG[0], "doctor").stdout.splitlines()[0]
    assert "EPG does not use it: other users can write into it" in said
    cache.chmod(0o755)
    assert "does not use its cache" not in run(sys.executable, cache, *EPG).stderr


@pytest.mark.skipif(os.name == "nt" or os.geteuid() != 0, reason="EPG: files of another user need root")
def test_a_cache_of_another_user_is_not_used(tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    cache.mkdir(mode=0o755)
    os.chown(cache, 4321, 4321)
    done = run(sys.executable, cache, *EPG)
    assert done.returncode == 4 and "it belongs to another user (number 4321)" in done.stderr
    assert run(sys.executable, cache, *EPG, SUDO_UID="4321").returncode == 0


def test_a_new_cache_is_the_users_own(tmp_path: Path) -> None:
    """Even if new files are writable for all users by default."""
    script = f"import os, sys; os.umask(0); os.execv(sys.executable, [sys.executable, {EPG[0]!r}, *sys.argv[1:]])"
    jiwy = ROOT / "examples/jiwy"
    target = ["--tcf", "host_jiwy.tcf", "--model", str(jiwy / "model"), "--bindings", str(jiwy / "jiwy.bindings.yaml")]
    for _ in range(2):
        done = run(
            sys.executable,
            tmp_path / "cache",
            "-c",
            script,
            "generate",
            "jiwy",
            *target,
            "--output",
            str(tmp_path / "o"),
        )
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "cache").stat().st_mode & 0o022 == 0 and list((tmp_path / "cache").iterdir())


@pytest.mark.skipif(os.name == "nt", reason="EPG: POSIX has groups of a user's own")
def test_the_users_own_group_may_write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Debian and Fedora make a group for each user, and files are writable for this group by default."""
    import grp
    import pwd

    tmp_path.chmod(0o775)
    user, group = pwd.getpwuid(os.geteuid()), tmp_path.stat().st_gid
    members: list[str] = []
    monkeypatch.setattr(pwd, "getpwuid", lambda _: pwd.struct_passwd((*user[:3], group, *user[4:])))
    monkeypatch.setattr(grp, "getgrgid", lambda _: grp.struct_group((user.pw_name, "x", group, members)))
    assert bootstrap.cache_problem(tmp_path) == ""
    members.append("somebody")
    assert "other users can write into it (mode 775)" in bootstrap.cache_problem(tmp_path)
    members.clear()
    monkeypatch.setattr(grp, "getgrgid", lambda _: grp.struct_group(("users", "x", group, members)))
    assert bootstrap.cache_problem(tmp_path)
