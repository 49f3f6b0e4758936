# SPDX-License-Identifier: Apache-2.0
"""Faults in words: each fault has a cause and a remedy, and the pages show the same texts."""

from __future__ import annotations

import re
from pathlib import Path

from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.live.faults import Faults, runtime_faults

ROOT = Path(__file__).resolve().parents[2]
KIND = """
api: 1
kind: motor_driver
group: input
summary: a driver of a motor with a switch that opens when it is hot
ports:
  value: {direction: source, type: boolean, description: 1 or 0}
faults:
  too hot: {description: the switch in the motor is open, remedy: let the motor cool down}
"""


def test_each_fault_of_the_runtime_has_words() -> None:
    source = (ROOT / "targets/runtime/src/communication/fault.c").read_text(encoding="utf-8")
    names = re.findall(r'\[EPG_FAULT_\w+\] = "([^"]+)"', source)
    assert ["none", *runtime_faults()] == names


def test_each_fault_of_a_kind_of_epg_has_a_remedy() -> None:
    catalog = load_catalog(targets_roots(), Diagnostics())
    faults = [fault for name in catalog.kind_names() if (kind := catalog.find_kind(name)) for fault in kind.faults]
    assert len(faults) >= 6
    assert all(fault.description and fault.remedy for fault in faults)


def test_the_page_of_the_runtime_has_the_same_texts() -> None:
    page = (ROOT / "docs/runtime.md").read_text(encoding="utf-8")
    for name, (description, remedy) in runtime_faults().items():
        assert f"| `{name}` | {description} | {remedy} |\n" in page


def test_a_fault_is_a_sentence() -> None:
    explain = Faults().explain
    assert explain({"enabled": "1", "fault": "none"}) is None
    assert explain({"enabled": "0"}) is None
    assert explain({"enabled": "0", "fault": "setpoint_timeout", "component": "pan_subscriber"}) == (
        "Fault 'setpoint timeout' of pan_subscriber: no new setpoint has arrived within its 'timeout'.",
        "Start the sender, and enable the target again; it then starts with the initial setpoint.",
    )
    assert explain({"fault": "of_a_later_version"}) == (
        "Fault 'of a later version'.",
        "Look at the component, and enable the target again.",
    )


def test_kinds_of_the_user_have_words_too(tmp_path: Path) -> None:
    (tmp_path / "components/motor_driver").mkdir(parents=True)
    (tmp_path / "components/motor_driver/component.yaml").write_text(KIND, encoding="utf-8")
    (tmp_path / "components/motor_driver/code.c.j2").touch()
    explain = Faults(targets_roots([tmp_path])).explain
    assert explain({"fault": "too_hot", "component": "motor_a"}) == (
        "Fault 'too hot' of motor_a: the switch in the motor is open.",
        "Let the motor cool down.",
    )
