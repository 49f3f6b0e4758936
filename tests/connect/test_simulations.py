# SPDX-License-Identifier: Apache-2.0
"""The simulations that `epg connect` finds for a target, and the question before one runs."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from epg.connect.run.find_simulation import simulations_of
from tests.connect.builds import job_of
from tests.connect.page import Denied, serving, session_of
from tests.connect.robots import ROOT, new_project


def found(folder: Path) -> list[tuple[str, str, str]]:
    simulations = simulations_of(job_of(folder)).found
    return [(each.name, each.executable, each.scenario.relative_to(folder).as_posix()) for each in simulations]


def test_a_board_is_simulated_by_the_project_beside_it(project: Path) -> None:
    assert found(project) == [("robot_simulation", "robot_host", "simulation/scenario.yaml")]
    (simulation,) = simulations_of(job_of(project)).found
    assert simulation.job.source_dir == project / "simulation"


def test_a_host_project_has_its_scenarios_but_none_in_real_time(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples/jiwy", tmp_path / "jiwy", ignore=shutil.ignore_patterns("build"))
    assert found(tmp_path / "jiwy") == [("tracking", "jiwy_host", "tracking.yaml")]
    new_project(tmp_path / "robot", "host_jiwy")
    assert found(tmp_path / "robot") == [("robot_simulation", "robot_host", "scenario.yaml")]
    lists = tmp_path / "robot/CMakeLists.txt"
    lists.write_text(lists.read_text().replace("epg_add_simulation(", "# epg_add_simulation("))
    assert found(tmp_path / "robot") == [("scenario", "robot_host", "scenario.yaml")], "a file with the usual name"


def test_without_a_simulation_the_reason_is_given(project: Path) -> None:
    (project / "simulation/scenario.yaml").rename(project / "elsewhere.yaml")
    lists = project / "simulation/CMakeLists.txt"
    lists.write_text(lists.read_text().replace("epg_add_simulation(", "# epg_add_simulation("))
    assert "has no scenario, such as" in simulations_of(job_of(project)).problem
    shutil.rmtree(project / "simulation")
    with serving(session_of(project)) as page:
        state = page.until(lambda state: state["simulations"] is not None)
        assert state["simulations"]["found"] == []
        assert "has no folder 'simulation'" in state["simulations"]["problem"]
        with pytest.raises(Denied, match="has no folder 'simulation'") as refusal:
            page.post("simulate")
        assert refusal.value.status == 409 and "epg new" in refusal.value.hint


def test_the_commands_of_a_simulation_are_shown_before_the_first(
    project: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    with serving(session_of(project)) as page:
        state = page.post("simulate")
        ask = state["simulation"]["ask"]
        assert state["simulation"]["state"] == "idle" and state["build"]["ask"] is None
        assert ask["folder"] == str(project / "simulation") and ask["wires"] == {}
        assert [command.split(" ")[1] for command in ask["commands"][:2]] == ["-S", "--build"]
        assert ask["commands"][2].split(" ")[0] in ask["programs"] and " simulate '" in ask["commands"][2]
        assert not (project / "simulation/build").exists()
        page.connect("position_pan", "pwm_pan")
        with pytest.raises(Denied, match="there is an error"):
            page.post("simulate", run=ask["key"])
        with pytest.raises(Denied, match="no simulation 'tracking'"):
            page.post("undo")
            page.post("simulate", simulation="tracking", run=ask["key"])
        assert not (project / "simulation/build").exists()


def test_proposed_wires_are_connected_only_after_consent(tmp_path: Path) -> None:
    model = Path(shutil.copytree(ROOT / "examples/relbot/model", tmp_path / "model"))
    new_project(tmp_path / "robot", "host_relbot", model)
    with serving(session_of(tmp_path / "robot")) as page:
        before = (tmp_path / "robot/robot.bindings.yaml").read_text()
        state = page.post("simulate")
        ask = state["simulation"]["ask"]
        assert ask["wires"] == state["proposals"] and set(ask["wires"]) >= {"PosLeft", "PosRight"}
        page.post("simulate", run=ask["key"])  # the commands alone
        state = page.state()
        assert state["simulation"]["state"] == "idle" and state["simulation"]["ask"]["commands"] == []
        assert "PosLeft" not in state["wires"] and not state["draft"]["changed"]
        assert (tmp_path / "robot/robot.bindings.yaml").read_text() == before
        page.connect("PosLeft", "pwm_left")  # another error, which no proposal corrects
        with pytest.raises(Denied, match="errors"):
            page.post("simulate", accept=True)
