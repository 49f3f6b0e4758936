# SPDX-License-Identifier: Apache-2.0
"""``examples/plugin``: a Python package that brings a command, an importer of models and a kind to EPG."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cmake.project import CMAKE_DIR, ROOT

EXAMPLE = ROOT / "examples" / "plugin"
MODEL = EXAMPLE / "controller"
Run = Callable[..., subprocess.CompletedProcess[str]]


def install(folder: Path) -> Path:
    """The package as ``pip install --target`` leaves it: its files, and its entry points."""
    shutil.copytree(EXAMPLE / "epg_two_rates", folder / "epg_two_rates", ignore=shutil.ignore_patterns("__pycache__"))
    project = (EXAMPLE / "pyproject.toml").read_text(encoding="utf-8")
    points = re.findall(r'^\[project\.entry-points\."([\w.]+)"\]\n((?:\w+ = ".+"\n)+)', project, re.MULTILINE)
    assert [group for group, _ in points] == ["epg.commands", "epg.importers", "epg.targets"]
    information = folder / "epg_two_rates-1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: epg-two-rates\nVersion: 1.0\n")
    (information / "entry_points.txt").write_text(
        "".join(f"[{group}]\n{lines}" for group, lines in points).replace(chr(34), "")
    )
    return folder


@pytest.fixture
def site(tmp_path: Path) -> Path:
    return install(tmp_path / "site")


@pytest.fixture
def epg(site: Path, tmp_path: Path) -> Run:
    """Runs ``epg`` where the plug-in is installed."""

    def run(*arguments: object, **variables: str) -> subprocess.CompletedProcess[str]:
        environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(site), str(ROOT)])} | variables
        command = [sys.executable, "-m", "epg", *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path)

    return run


def test_a_command_of_a_plugin(epg: Run) -> None:
    assert epg("rates", MODEL).stdout == "position_loop: 1000 Hz, trajectory: 100 Hz\n"
    assert "  rates  " in epg("--help").stdout
    without = epg("rates", MODEL, PYTHONPATH=str(ROOT))
    assert without.returncode == 2 and "there is no command 'rates'" in without.stderr


def test_a_model_of_a_plugin(epg: Run) -> None:
    assert re.findall(r"^(input|output) +(\w+)", epg("ports", MODEL).stdout, re.MULTILINE) == [
        ("input", "angle"),
        ("output", "duty"),
    ]
    assert epg("ports", MODEL / "position.rates").returncode == 0
    assert "[model-not-recognised]" in epg("ports", MODEL, PYTHONPATH=str(ROOT)).stderr


def test_epgs_own_importers_come_first(epg: Run, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / "model"))
    shutil.copytree(MODEL, folder, dirs_exist_ok=True)
    assert "20-sim C function" in epg("ports", folder).stdout
    (folder / "model.yaml").write_text("version: 1\nimporter: two_rates\n")
    assert "position: two rates" in epg("ports", folder).stdout
    (folder / "model.yaml").write_text("version: 1\nimporter: two_rates\nfile: position.rates\n")
    assert "position: two rates" in epg("ports", folder).stdout


def test_the_kind_of_a_plugin_is_known_everywhere(epg: Run) -> None:
    files = ("--tcf", EXAMPLE / "robot.tcf", "--model", MODEL, "--bindings", EXAMPLE / "position.bindings.yaml")
    assert epg("check", *files).returncode == 0
    assert "middle" in epg("targets").stdout
    assert "[unknown-kind]" in epg("check", *files, PYTHONPATH=str(ROOT)).stderr


def test_a_broken_plugin_is_named(epg: Run, site: Path) -> None:
    (site / "epg_two_rates" / "__init__.py").write_text("import no_such_module\n")
    for arguments in (("ports", MODEL), ("rates", MODEL), ("targets",)):
        done = epg(*arguments)
        assert done.returncode in (1, 4) and "[plugin-broken]" in done.stderr, done.stderr
        assert "no_such_module" in done.stderr and "pip uninstall epg-two-rates" in done.stderr
    assert epg("ports", ROOT / "examples/jiwy/model").returncode == 0
    assert epg("--cmake-dir").returncode == epg("--version").returncode == 0


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "IMPORTER = TwoRatesImporter()",
            "IMPORTER = TwoRatesImporter",
            "must be an object of a class that derives from Importer, and is the class",
        ),
        (
            "IMPORTER = TwoRatesImporter()",
            "IMPORTER = 1",
            "must be an object of a class that derives from Importer, and is of type 'int'",
        ),
        (
            "Port(name, name,",
            'Port(name, "the " + name,',
            "gives 'angle' the identifier 'the angle', which C does not allow",
        ),
    ],
)
def test_an_importer_that_epg_cannot_use_is_named(epg: Run, site: Path, old: str, new: str, said: str) -> None:
    file = site / "epg_two_rates" / "__init__.py"
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")
    done = epg("ports", MODEL)
    assert done.returncode == 1 and "[plugin-broken]" in done.stderr, done.stderr
    assert "the plug-in 'two_rates' of epg-two-rates " + said in done.stderr


def test_a_run_without_plugins_does_not_look_for_them(tmp_path: Path) -> None:
    program = (
        "import sys; from epg.cli.main import main\n"
        "assert main(sys.argv[1:]) == 0\n"
        "assert 'importlib.metadata' not in sys.modules and 'epg.generator.plugins' not in sys.modules"
    )
    jiwy = ROOT / "examples/jiwy"
    command = [sys.executable, "-c", program, "generate", "jiwy", "--output", str(tmp_path / "out")]
    command += ["--tcf", "host_jiwy.tcf", "--model", str(jiwy / "model")]
    subprocess.run([*command, "--bindings", str(jiwy / "jiwy.bindings.yaml")], check=True, cwd=ROOT)


@pytest.fixture(params=["checkout", "wheel"])
def cmake_folder(request: pytest.FixtureRequest) -> Path:
    """The folder ``cmake`` of an EPG: an editable install and a submodule are checkouts."""
    if request.param == "checkout":
        return CMAKE_DIR
    (folder,) = request.getfixturevalue("prefix").glob("lib/*/site-packages/epg/_data/cmake")
    return Path(folder)


def test_a_project_with_a_plugin(cmake_folder: Path, site: Path, tmp_path: Path) -> None:
    """The whole example, and edits of its parts: the next build has each of them."""
    project = Path(shutil.copytree(EXAMPLE, tmp_path / "project"))
    build = tmp_path / "build"

    def run(*command: object) -> str:
        environment = os.environ | {"PYTHONPATH": str(site)}
        done = subprocess.run(
            list(map(str, command)), env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        assert done.returncode == 0, done.stdout
        return done.stdout

    def duty() -> list[str]:
        run("cmake", "--build", build)
        return run(build / "print_duty").splitlines()

    run("cmake", "-S", project, "-B", build, f"-DEPG_DIR={cmake_folder}", f"-DPython3_EXECUTABLE={sys.executable}")
    first = duty()
    assert first[:2] + first[9:12] == ["0 ms: 0.01", "1 ms: 0.01", "9 ms: 0.01", "10 ms: 0.02", "11 ms: 0.02"]
    assert first[20:] == ["20 ms: 0.03", "limited: -327.64, 1", "again: -327.66"]
    edits = [
        (project / "controller/controller.c", "duty = 0.01", "duty = 0.02", "0 ms: 0.02"),
        (project / "controller/position.rates", "every: 10", "every: 5", "5 ms: 0.04"),
        (site / "epg_two_rates/two_rates.c.j2", "step = 0u;", "step = 1u;", "0 ms: 0"),
    ]
    for file, old, new, line in edits:
        text = file.read_text(encoding="utf-8")
        assert old in text
        file.write_text(text.replace(old, new, 1), encoding="utf-8")
        os.utime(file, (file.stat().st_mtime + 2,) * 2)
        assert line in duty(), (file, line)
    kind = site / "epg_two_rates/targets/components/middle/code.c.j2"
    kind.write_text(kind.read_text(encoding="utf-8").replace("/ 2", "/ 4"), encoding="utf-8")
    os.utime(kind, (kind.stat().st_mtime + 2,) * 2)
    run("cmake", "--build", build)
    assert "7.5" in (build / "epg/robot/robot_app.c").read_text(encoding="utf-8")
