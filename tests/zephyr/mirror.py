# SPDX-License-Identifier: Apache-2.0
"""Zephyr and its modules as Git repositories on this computer, for workspaces of west without a network.

A repository has the files of this computer's workspace in one commit.  Zephyr's manifest names the commits of the
others, and no module that is missing.  Git's configuration redirects the addresses in manifests to these
repositories, so that the manifests are used unchanged.

>>> # there = mirror(workspace("rpi_pico", "nucleo_h743zi"))
>>> # there.add("https://example.org/robot", ROOT / "examples/zephyr_jiwy")
>>> # run(["west", "init", "-m", "https://example.org/robot", "ws"], env={**environment, **there.variables})
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from tests.doubles.toolchain import ROOT, locked

from .workspace import Workspace

UPSTREAM = "https://github.com/zephyrproject-rtos"
TAG = "v4.1.0"
"""The tag by which manifests find this computer's Zephyr, whatever its own version is."""

ZEPHYR = ("boards", "cmake", "drivers", "dts", "include", "kernel", "lib", "misc", "modules", "scripts", "share")
ZEPHYR += ("snippets", "soc", "submanifests", "subsys", "arch", "CMakeLists.txt", "Kconfig", "Kconfig.constants")
ZEPHYR += ("Kconfig.zephyr", "SDK_VERSION", "VERSION", "version.h.in", "west.yml")
STM32 = ("CMakeLists.txt", "zephyr", "lib", "dts/st/h7", "stm32cube/CMakeLists.txt")
STM32 += ("stm32cube/common_ll", "stm32cube/stm32h7xx")
PARTS: dict[str, Sequence[str]] = {"zephyr": ZEPHYR, "stm32": STM32}
"""The parts of the large repositories that the builds of these tests read."""

NAMES = {"rpi_pico": "hal_rpi_pico", "stm32": "hal_stm32", "cmsis": "cmsis", "cmsis_6": "cmsis_6"}
REPOSITORIES = {"cmsis_6": "CMSIS_6"}
"""Names of repositories that differ from the project's name."""


@dataclass(frozen=True)
class Mirror:
    """Bare repositories in a folder of EPG's cache, by the host and path of the address that they replace."""

    folder: Path

    @property
    def variables(self) -> dict[str, str]:
        """Environment with which Git, and therefore west, uses these repositories instead of those on the network."""
        return {
            "GIT_CONFIG_COUNT": "1",
            "GIT_CONFIG_KEY_0": f"url.file://{self.folder}/.insteadOf",
            "GIT_CONFIG_VALUE_0": "https://",
            "GIT_CONFIG_NOSYSTEM": "1",
            "GIT_TERMINAL_PROMPT": "0",
        }

    def add(self, address: str, source: Path, parts: Sequence[str] = (".",), tag: str = "", **contents: str) -> str:
        """Makes or renews the repository of an address from a folder's files; returns the commit.

        With ``tag``, ignored files belong to it, too, as some of Zephyr's do.  ``contents`` replaces files of these
        names (``west.yml`` is ``west``).
        """
        repository = self.folder / address.removeprefix("https://")
        if not (repository / "HEAD").is_file():
            subprocess.run(["git", "init", "-q", "--bare", "-b", "main", str(repository)], check=True)
        for name, value in (("core.compression", "0"), ("gc.auto", "0"), ("core.bare", "false")):
            _git(repository, source, "config", name, value)
        present = [part for part in parts if (source / part).exists()]
        ignored = ["--force"] if tag else []
        _git(repository, source, "add", "--all", *ignored, "--", *present)
        for name, text in contents.items():
            blob = _git(repository, source, "hash-object", "-w", "--stdin", given=text)
            _git(repository, source, "update-index", "--add", "--cacheinfo", f"100644,{blob},{name}.yml")
        tree = _git(repository, source, "write-tree")
        commit = _git(repository, source, "commit-tree", tree, "-m", "The files of this computer")
        _git(repository, source, "update-ref", "refs/heads/main", commit)
        if tag:
            _git(repository, source, "update-ref", f"refs/tags/{tag}", commit)
        return commit


def mirror(here: Workspace) -> Mirror:
    """The mirror of Zephyr, the modules of the workspace, and this EPG."""
    there = Mirror(cache_folder() / "test-build" / "zephyr-mirror")
    with locked(there.folder):
        manifest = (here.base / "west.yml").read_text(encoding="utf-8")
        for project in sorted(set(NAMES.values()) - {NAMES.get(module.name) for module in here.modules}):
            manifest = re.sub(rf"    - name: {project}\n(?:      .*\n)*", "", manifest)
        for module in here.modules:
            if module == ROOT:
                there.add("https://example.org/epg", module)
                continue
            project = NAMES[module.name]
            address = f"{UPSTREAM}/{REPOSITORIES.get(project, project)}"
            commit = there.add(address, module, PARTS.get(module.name, (".",)))
            pinned = rf"(- name: {project}\n(?:      .*\n)*?      revision: )\w+"
            manifest, count = re.subn(pinned, rf"\g<1>{commit}", manifest)
            assert count == 1, f"Zephyr's manifest pins {project}"
        there.add(f"{UPSTREAM}/zephyr", here.base, ZEPHYR, TAG, west=manifest)
    return there


def _git(repository: Path, source: Path, *words: str, given: str = "") -> str:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    for role in ("AUTHOR", "COMMITTER"):
        environment[f"GIT_{role}_NAME"] = environment[f"GIT_{role}_EMAIL"] = "nobody"
        environment[f"GIT_{role}_DATE"] = "2025-01-01T00:00:00Z"
    command = ["git", f"--git-dir={repository}", f"--work-tree={source}", *words]
    done = subprocess.run(command, input=given, capture_output=True, text=True, env=environment, cwd=source, check=True)
    return done.stdout.strip()
