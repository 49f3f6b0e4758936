# SPDX-License-Identifier: Apache-2.0
"""Wheels and editable installations have the same files as the checkout, and CMake finds them."""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

from epg.connect.server import TYPES
from epg.generator.check.editor_schemas import USER_FILES
from tests.cmake.project import ROOT, Project
from tests.connect.started import started

TREES = (
    "cmake",
    "targets",
    "schemas",
    "integration/20-sim",
    *(folder.relative_to(ROOT).as_posix() for folder in ROOT.glob("integration/*/targets")),
    "zephyr",
    "zephyr_module",
    "examples/jiwy",
    "examples/relbot/plant",
)

NAMES = """
import sys
sys.path.insert(0, sys.argv[1])
from epg.generator.catalog.catalog import FOLDERS, load_catalog
from epg.generator.data import own_roots
from epg.generator.diagnostics import Diagnostics
catalog = load_catalog(own_roots(), Diagnostics())
print(*(name for category in FOLDERS for name in catalog.names(category)))
"""


def test_the_wheel_holds_the_same_files_as_the_checkout(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        for tree in TREES:
            tracked = subprocess.run(["git", "ls-files", tree], cwd=ROOT, capture_output=True, text=True).stdout.split(
                "\n"
            )
            files = [name for name in tracked if name and (ROOT / name).is_file()]
            assert files or not (ROOT / ".git").exists()
            for name in files:
                assert archive.read(f"epg/_data/{name}") == (ROOT / name).read_bytes()
        assert archive.read("epg/_data/docs/errors.md") == (ROOT / "docs/errors.md").read_bytes()
    assert {name.split("/")[2] for name in names if "epg/_data/" in name} == {*(t.split("/")[0] for t in TREES), "docs"}
    assert [name for name in names if not name.startswith(("epg/", "epg-")) or "__pycache__" in name] == []
    assert [name for name in names if name.startswith(("epg/generator/lock/test", "epg/generator/lock/dev"))] == []
    editor = "epg/_data/schemas/editor/"
    assert {name for name in names if name.startswith(editor)} == {f"{editor}{name}.schema.json" for name in USER_FILES}
    assert {"epg/__main__.py", "epg/generator/emit/templates/app.c.j2", "epg/generator/lock/generator.txt"} <= names
    assert any(name.endswith(".data/data/share/EPG/cmake/EPGConfig.cmake") for name in names)


def test_a_wheel_has_the_same_catalog_as_the_checkout(prefix: Path, tmp_path: Path) -> None:
    """Also the items in the folders of targets in ``integration``."""
    (site,) = prefix.glob("lib/*/site-packages")
    found = [
        subprocess.run(
            [sys.executable, "-c", NAMES, str(folder)], cwd=tmp_path, capture_output=True, text=True, check=True
        )
        for folder in (site, ROOT)
    ]
    assert found[0].stdout == found[1].stdout
    assert {path.parent.name for path in ROOT.glob("integration/*/targets/*/*/*.yaml")} <= set(found[0].stdout.split())


def test_a_wheel_and_a_source_archive_have_the_licence(wheel: Path, tmp_path: Path) -> None:
    texts = [(ROOT / name).read_bytes() for name in ("LICENSE", "NOTICE")]
    with zipfile.ZipFile(wheel) as archive:
        names = {Path(name).name: name for name in archive.namelist() if ".dist-info/" in name}
        assert [archive.read(names[name]) for name in ("LICENSE", "NOTICE")] == texts
        metadata = archive.read(names["METADATA"]).decode()
    assert "\nLicense-Expression: Apache-2.0\n" in metadata
    assert "\nLicense-File: LICENSE\nLicense-File: NOTICE\n" in metadata
    script = "import sys; from hatchling.builders.sdist import SdistBuilder;"
    script += " print(next(SdistBuilder(sys.argv[1]).build(directory=sys.argv[2], versions=['standard'])))"
    command = [sys.executable, "-c", script, str(ROOT), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    with tarfile.open(done.stdout.strip()) as sources:
        held = {Path(name).name: name for name in sources.getnames() if name.count("/") == 1}
        assert [sources.extractfile(held[name]).read() for name in ("LICENSE", "NOTICE")] == texts  # type: ignore[union-attr]


def test_a_wheel_has_the_page_of_connect(prefix: Path) -> None:
    (site,) = prefix.glob("lib/*/site-packages")
    jiwy = ROOT / "examples/jiwy"
    files = ["--tcf", "host_jiwy.tcf", "--model", jiwy / "model", "--bindings", jiwy / "jiwy.bindings.yaml"]
    command = [sys.executable, site / "epg", "connect", "--no-browser", *files]
    with started(command) as (page, _):
        for path in (ROOT / "epg/connect/page").iterdir():
            if path.suffix not in TYPES:  # the types of the scripts, which only developers need
                continue
            assert page.get(path.name)[0] == path.read_bytes()
        assert page.state()["diagnostics"] == []


def test_cmake_finds_a_wheel_by_its_prefix(prefix: Path, tmp_path: Path) -> None:
    project = Project(tmp_path, "robot")
    project.configure(f"-DCMAKE_PREFIX_PATH={prefix}", epg_dir=False)
    project.build()


def test_cmake_finds_a_wheel_by_the_command_line(prefix: Path, tmp_path: Path) -> None:
    (site,) = prefix.glob("lib/*/site-packages")
    done = subprocess.run(
        [sys.executable, str(site / "epg"), "--cmake-dir"], capture_output=True, text=True, check=True
    )
    folder = done.stdout.strip()
    assert folder == (site / "epg/_data/cmake").as_posix()
    Project(tmp_path, "robot").configure(f"-DEPG_DIR={folder}", epg_dir=False)


def test_the_readme_without_the_checkout(prefix: Path, tmp_path: Path) -> None:
    """With the wheel alone: the example up to its plot, and new projects."""
    (site,) = prefix.glob("lib/*/site-packages")
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("EPG_", "PYTHON"))}

    def run(*command: str) -> str:
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    epg = (sys.executable, str(site / "epg"))
    examples = run(*epg, "--examples-dir").strip()
    assert Path(examples).is_relative_to(site)
    python = f"-DPython3_EXECUTABLE={sys.executable}"
    run("cmake", "-S", f"{examples}/jiwy", "-B", "build/jiwy", python)
    assert "limits of the scenario hold" in run("cmake", "--build", "build/jiwy", "--target", "tracking")
    assert {"tracking.csv", "tracking.png"} <= {path.name for path in (tmp_path / "build/jiwy").iterdir()}
    for target in ("rpi_pico2_freertos_jiwy", "host_jiwy"):
        run(*epg, "new", "--target", target, "--model", f"{examples}/jiwy/model", target)
    folder = run(*epg, "--cmake-dir").strip()
    run("cmake", "-S", "host_jiwy", "-B", "build/host", python, f"-DEPG_DIR={folder}")
    run("cmake", "--build", "build/host")
    assert (Path(run(*epg, "--20-sim-dir").strip()) / "Targets.ini").is_file()


def test_an_editable_install_leads_to_the_checkout(tmp_path: Path) -> None:
    code = (
        "import sys; from hatchling.builders.wheel import WheelBuilder;"
        "print(next(WheelBuilder(sys.argv[1]).build(directory=sys.argv[2], versions=['editable'])))"
    )
    subprocess.run([sys.executable, "-c", code, str(ROOT), str(tmp_path)], check=True, capture_output=True)
    (found,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(found) as archive:
        names = archive.namelist()
        assert not [name for name in names if "_data/" in name.replace(".data/data", "")]
        (config,) = [name for name in names if name.endswith("EPGConfig.cmake")]
        assert f"[==[{ROOT.as_posix()}/cmake/EPGConfig.cmake]==]" in archive.read(config).decode()
