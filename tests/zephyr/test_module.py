# SPDX-License-Identifier: Apache-2.0
"""EPG as a module of Zephyr has no cost for applications that do not use it."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

from epg.generator.bootstrap import LOCKS
from tests.doubles.toolchain import ROOT, arm_gcc, skip_if_missing

from .workspace import build, workspace

APPLICATION = "tests/zephyr/empty"


def configuration(folder: Path) -> list[str]:
    return (folder / "zephyr" / ".config").read_text(encoding="utf-8").splitlines()


def test_an_application_that_does_not_use_it_builds_as_without_it() -> None:
    """The binary is the same, and so is .config, except for the symbol that Zephyr defines for each module."""
    skip_if_missing(partial(workspace, "rpi_pico"), arm_gcc)
    modules = workspace("rpi_pico").modules
    assert modules[-1] == ROOT
    plain = build(APPLICATION, "rpi_pico", modules=modules[:-1])
    with_epg = build(APPLICATION, "rpi_pico")
    added = [line for line in configuration(with_epg) if line not in configuration(plain)]
    assert [line for line in added if line.startswith("CONFIG_") and line != "CONFIG_ZEPHYR_EPG_MODULE=y"] == []
    assert [line for line in configuration(plain) if line not in configuration(with_epg)] == []
    image = (plain / "zephyr" / "zephyr.bin").read_bytes()
    assert len(image) > 10_000
    assert (with_epg / "zephyr" / "zephyr.bin").read_bytes() == image


def test_python_packages_are_those_of_the_generator() -> None:
    """`west packages pip` installs the packages that the generator needs."""
    requirements = ROOT / "zephyr_module" / "requirements.txt"
    lines = requirements.read_text(encoding="utf-8").splitlines()
    (named,) = [line.removeprefix("-r ") for line in lines if not line.startswith("#")]
    assert (requirements.parent / named).resolve() == LOCKS / "generator.in"


def test_what_module_yml_names_is_there() -> None:
    text = (ROOT / "zephyr" / "module.yml").read_text(encoding="utf-8")
    named = re.findall(r"(?:zephyr_module|tests/zephyr)[\w/.]*", text)
    assert len(named) >= 6
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_every_property_of_a_target_is_generated() -> None:
    binding = (ROOT / "zephyr_module/dts/bindings/epg,target.yaml").read_text(encoding="utf-8")
    properties = re.findall(r"^  ([\w-]+):$", binding.partition("\nproperties:\n")[2], re.MULTILINE)
    assert {"decoders", "gpios"} <= set(properties)
    overlay = (ROOT / "targets/platforms/zephyr/NAME.overlay.j2").read_text(encoding="utf-8")
    assert [name for name in properties if f"\t\t{name} = " not in overlay] == []
