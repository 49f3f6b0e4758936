# SPDX-License-Identifier: Apache-2.0
"""A model with another step gives the numbers of an export with this step, or is refused."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from tests.cmake.project import ROOT
from tests.doubles.twenty_sim.exports import Export
from tests.models.harness import build, loaded, run_wrapper

STEPS = 500
HALF = Fraction(1, 2000)


@pytest.mark.parametrize(
    ("version", "tokens"),
    [("4.5.1.5561", False), ("5.1.4.13773", False), ("5.1.4.13773", True)],
    ids=["4.5", "5.1", "tokens"],
)
def test_an_integration_method_takes_any_step(version: str, tokens: bool, tmp_path: Path) -> None:
    found = {}
    for step in ("0.001", "0.0005"):
        export = Export(method="RungeKutta4", version=version, step=step)
        write = export.write_tokens if tokens else export.write
        found[step] = loaded(write(tmp_path / step / "model"))
    changed = found["0.001"].with_step(HALF)
    assert changed is not None and changed.step == found["0.0005"].step
    results = [run_wrapper(build(model, "pan", tmp_path), STEPS) for model in (changed, *found.values())]
    assert results[0] == results[2] != results[1]


def test_an_fmu_takes_multiples_of_its_step(tmp_path: Path) -> None:
    (tmp_path / "slow").mkdir()
    folder = Export(method="RungeKutta2").write_whole_fmu(tmp_path / "fmu", "output time")
    (tmp_path / "slow/model.yaml").write_text("version: 1\nfmu: ../fmu\nstep: 3 ms\n")
    changed = loaded(folder).with_step(Fraction(3, 1000))
    assert changed is not None
    results = [run_wrapper(build(model, "pan", tmp_path), STEPS) for model in (changed, loaded(tmp_path / "slow"))]
    assert results[0] == results[1]
    assert loaded(folder).with_step(HALF) is None


def test_other_models_have_a_fixed_step(tmp_path: Path) -> None:
    discrete = loaded(Export(method="Discrete").write(tmp_path / "c"))
    of_class = loaded(Export(method="Euler").write_cpp(tmp_path / "cpp"))
    by_hand = loaded(ROOT / "tests/models/pid_c")
    for model in (discrete, of_class, by_hand):
        assert model.with_step(model.step / 2) is None
        assert model.with_step(model.step) is model
