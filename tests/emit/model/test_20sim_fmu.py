# SPDX-License-Identifier: Apache-2.0
"""FMUs of 20-sim take one of their own steps at each step of the library, with every integration method."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.twenty_sim.exports import Export
from tests.models.direct import run_c_vectors, run_fmu
from tests.models.harness import build, load, loaded, run_program, run_wrapper, values

STEPS = 1500
METHODS = ("Discrete", "Euler", "RungeKutta2", "RungeKutta4")
PORTS = (["in", "position"], ["corr", "out"])


def c_function(export: Export, work: Path) -> str:
    """The results of the C function target for the same controller, called by its own main program."""
    folder = export.write(work / "c")
    sources = [path for path in sorted(folder.glob("*.c")) if path.name != "xxmain.c"]
    return run_c_vectors(sources, [folder], work, (2, 2), STEPS)


@pytest.mark.parametrize(
    ("form", "method"),
    [("globals", "RungeKutta4"), ("instance", "Discrete"), *(("output time", method) for method in METHODS)],
)
def test_one_step_at_a_time(form: str, method: str, tmp_path: Path) -> None:
    """1 ms is not a sum of powers of two: a method that gets the time of the next output must get exactly that sum."""
    export = Export(method=method)
    folder = export.write_whole_fmu(tmp_path / "fmu", form)
    library = build(loaded(folder), "pan", tmp_path)
    assert run_wrapper(library, STEPS, True) == run_fmu(folder / "sources", tmp_path / "own", *PORTS, STEPS)
    found, expected = run_wrapper(library, STEPS), c_function(export, tmp_path)
    if form != "output time":
        assert found == expected
        return
    # the last step has the length of the remaining time, which rounds 1 ms otherwise
    for row, other in zip(values(found), values(expected), strict=True):
        assert row == pytest.approx(other, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("form", ["globals", "instance", "output time"])
def test_a_method_whose_steps_vary_is_a_warning_in_an_fmu_and_an_error_in_its_sources(
    form: str, tmp_path: Path
) -> None:
    folder = Export(method="RungeKutta4").write_whole_fmu(tmp_path / "fmu", form)
    for path in sorted((folder / "sources").iterdir()):
        path.write_text(path.read_text("latin-1").replace("RungeKutta4", "VodeAdams"), "latin-1")
    model, diagnostics = load(folder)
    assert model is not None
    assert [(i.severity, i.id) for i in diagnostics if i.severity != "note"] == [("warning", "model-variable-step")]
    model, diagnostics = load(folder / "sources")
    assert model is None
    assert [(i.severity, i.id) for i in diagnostics if i.severity != "note"] == [("error", "model-variable-step")]


@pytest.mark.parametrize("method", ["Discrete", "RungeKutta4"])
def test_sources_of_an_fmu_that_get_the_time_of_the_next_output(method: str, tmp_path: Path) -> None:
    """These sources are recognised without FMI."""
    folder = Export(method=method).write_whole_fmu(tmp_path / "fmu", "output time")
    library = build(loaded(folder / "sources"), "pan", tmp_path)
    assert run_wrapper(library, STEPS, True) == run_fmu(folder / "sources", tmp_path / "own", *PORTS, STEPS)


SLOWER = """
#include "fast.h"
#include "slow.h"
#include <stdio.h>
int main(void)
{
    static fast_inputs_t in = {0.5, 0.1};
    static slow_inputs_t slow_in = {0.5, 0.1};
    fast_outputs_t out;
    slow_outputs_t slow_out;
    fast_init(fast_instance(0), &in, &out);
    slow_init(slow_instance(0), &slow_in, &slow_out);
    for (int k = 0; k < 600; k++) {
        fast_step(fast_instance(0), &in, &out);
        if (k % 3 == 2) {
            slow_step(slow_instance(0), &slow_in, &slow_out);
            printf("%a %a %a %a\\n", out.corr, slow_out.corr, out.out, slow_out.out);
            in.in = slow_in.in = 0.5 - 0.001 * k;
        }
    }
    return 0;
}
"""


def test_several_steps_of_the_method_in_one_of_the_model(tmp_path: Path) -> None:
    folder = Export(method="RungeKutta2").write_whole_fmu(tmp_path / "fmu", "output time")
    (tmp_path / "slow").mkdir()
    (tmp_path / "slow" / "model.yaml").write_text("version: 1\nfmu: ../fmu\nstep: 3 ms\n")
    libraries = [build(loaded(folder), "fast", tmp_path), build(loaded(tmp_path / "slow"), "slow", tmp_path)]
    rows = [line.split() for line in run_program(tmp_path / "run", SLOWER, libraries).splitlines()]
    assert len(rows) == 200 and len({row[0] for row in rows}) == 200
    assert all(row[0] == row[1] and row[2] == row[3] for row in rows)


AGAIN = """
#include "pan.h"
#include <stdio.h>
int main(void)
{
    static pan_inputs_t in = {0.5, 0.1};
    pan_outputs_t out;
    for (int k = 0; k < 60; k++) {
        if (k % 20 == 0) {
            pan_init(pan_instance(0), &in, &out);
        }
        pan_step(pan_instance(0), &in, &out);
        printf("%a %a\\n", out.corr, out.out);
    }
    return 0;
}
"""


def test_a_start_puts_back_global_variables(tmp_path: Path) -> None:
    """FMUs of 4.5 keep their state in global variables, and set only some of them at a start."""
    kept = {"model": "XXDouble xx_kept = 0.25;\n", "dynamic": "\txx_kept += 0.5;\n\txx_V[6] = xx_V[6] - xx_kept;\n"}
    folder = Export(method="Euler", **kept).write_whole_fmu(tmp_path / "fmu", "globals")
    model = loaded(folder)
    assert not model.instantiable  # independent of its description
    rows = run_program(tmp_path / "run", AGAIN, [build(model, "pan", tmp_path)]).splitlines()
    assert len(set(rows)) == 20
    assert rows[:20] == rows[20:40] == rows[40:]
