# SPDX-License-Identifier: Apache-2.0
"""CMake fetches small libraries that the build needs: a fixed version, completely or not at all."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.skipif(
    not (shutil.which("cmake") and shutil.which("git")),
    reason="CMake or git is not installed: sudo apt install cmake git",
)


def git(folder: Path, *arguments: str) -> str:
    identity = ["-c", "user.name=test", "-c", "user.email=test@example.org"]
    done = subprocess.run(["git", *identity, "-C", str(folder), *arguments], capture_output=True, text=True, check=True)
    return done.stdout.strip()


class World:
    """A repository with a library, EPG's data with a tool for that library, and an empty cache."""

    def __init__(self, folder: Path) -> None:
        self.repository = folder / "repository"
        (self.repository / "include").mkdir(parents=True)
        (self.repository / "include" / "thing.h").write_text("#define THING_VERSION 1.2.3\n")
        git(self.repository, "init", "--quiet")
        git(self.repository, "config", "uploadpack.allowAnySHA1InWant", "true")
        git(self.repository, "add", ".")
        git(self.repository, "commit", "--quiet", "-m", "thing")
        self.cache = folder / "cache"
        self.data = folder / "data"
        (self.data / "targets" / "tools").mkdir(parents=True)
        self.script = folder / "find.cmake"
        self.tool(git(self.repository, "rev-parse", "HEAD"))

    def tool(self, commit: str) -> None:
        text = {
            "api": 1,
            "tool": "thing",
            "title": "Thing",
            "needed_for": "tests",
            "holds": "include/thing.h",
            "variables": ["THING_PATH"],
            "cached": "Thing-*",
            "version": {"file": "include/thing.h", "patterns": [r"THING_VERSION\s+(\d+(?:\.\d+)+)"]},
            "fetch": {"git": self.repository.as_uri(), "commit": commit, "folder": "Thing-1.2.3"},
            "get": {"any": "get the thing"},
        }
        (self.data / "targets" / "tools" / "thing.json").write_text(json.dumps(text))
        self.script.write_text(
            f"""include("{ROOT.as_posix()}/cmake/EPGPython.cmake")
include("{ROOT.as_posix()}/cmake/EPGVersions.cmake")
include("{ROOT.as_posix()}/cmake/EPGSdk.cmake")
include("{ROOT.as_posix()}/cmake/EPGFetch.cmake")
include("{ROOT.as_posix()}/cmake/EPGMissing.cmake")
set(EPG_TARGETS_PATH "{self.data.as_posix()}/targets")
_epg_find_sdk(thing thing)
message(STATUS "found '${{thing}}' '${{thing_VERSION}}' '${{thing_PROBLEM}}'")
"""
        )

    def find(self, *settings: str) -> str:
        done = subprocess.run(
            ["cmake", *settings, "-P", str(self.script)],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "EPG_CACHE": str(self.cache)},
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    @property
    def fetched(self) -> Path:
        return self.cache / "Thing-1.2.3"


@pytest.fixture
def world(tmp_path: Path) -> World:
    return World(tmp_path)


def test_it_is_fetched_once(world: World) -> None:
    first = world.find()
    assert "EPG: fetching Thing" in first and f"found '{world.fetched}' '1.2.3' ''" in first
    assert sorted(path.name for path in world.fetched.iterdir()) == ["include"]
    shutil.rmtree(world.repository)
    second = world.find()
    assert "fetching" not in second and f"found '{world.fetched}' '1.2.3' ''" in second


def test_builds_at_the_same_time_fetch_it_once(world: World) -> None:
    with ThreadPoolExecutor(4) as pool:
        outputs = list(pool.map(lambda _: world.find(), range(4)))
    wrong = [output for output in outputs if f"found '{world.fetched}'" not in output]
    assert wrong == []
    assert sum("fetching" in output for output in outputs) == 1


def test_what_has_another_hash_is_not_taken(world: World) -> None:
    world.tool("0123456789012345678901234567890123456789")
    output = world.find()
    assert "the download has failed" in output
    assert "found '' '' 'Thing was not found. Get it:\n  get the thing'" in output
    assert [path.name for path in world.cache.iterdir()] == ["Thing-1.2.3.lock"]


def test_a_folder_that_is_named_goes_first(world: World, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    shutil.copytree(world.repository, mine)
    assert f"found '{mine}' '1.2.3' ''" in world.find(f"-DTHING_PATH={mine}")
    assert not world.cache.exists()


def test_it_can_be_forbidden(world: World) -> None:
    output = world.find("-DFETCHCONTENT_FULLY_DISCONNECTED=ON")
    assert "fetching" not in output and "Thing was not found" in output
    assert not world.cache.exists()


@pytest.mark.skipif(os.name == "nt", reason="EPG: the user's folders are private on Windows")
def test_a_cache_that_others_may_write_is_not_used(world: World) -> None:
    """The configure step includes files of the cache."""
    world.find()
    world.cache.chmod(0o757)
    done = subprocess.run(
        ["cmake", "-P", str(world.script)],
        capture_output=True,
        text=True,
        env={**os.environ, "EPG_CACHE": str(world.cache)},
    )
    assert done.returncode != 0 and "EPG does not use its cache" in " ".join(done.stderr.split())
    assert f"(chmod -R go-w {world.cache})" in done.stderr and "found '" not in done.stdout
    world.cache.chmod(0o755)
    assert f"found '{world.fetched}'" in world.find()


@pytest.mark.parametrize("name", ["micro_cdr", "micro_xrce_dds_client"])
def test_pins_name_the_version_that_is_tested(name: str) -> None:
    tool = json.loads((ROOT / "targets" / "tools" / f"{name}.json").read_text())
    assert tool["fetch"]["folder"].endswith(f"-{tool['tested']}")
    assert f"v{tool['tested']} " in tool["get"]["any"] and tool["fetch"]["git"] in tool["get"]["any"]
    assert len(tool["fetch"]["commit"]) == 40
