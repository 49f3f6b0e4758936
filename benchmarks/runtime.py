# SPDX-License-Identifier: Apache-2.0
"""Measures the cost of generated code at run time: JIWY generated, and JIWY written by hand (runtime/handwritten.c).

Both programs are compiled for this computer with the same options, and linked with the same model and the same driver.
They must give the same trace: every signal, every published value and every counter of every cycle, also with faults,
overruns and values that are not finite.  callgrind counts the instructions of a control cycle; its counts are exact,
and the same in every run.  Both programs have motion guards, and no middleware.
"""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from measure import EPG, JIWY, ROOT, jiwy_files, run
from report import Table, arguments, command_line, show

SOURCES = Path(__file__).resolve().parent / "runtime"
RUNTIME = ROOT / "targets" / "runtime"
OPTIONS = ["-std=c11", "-O2", "-ffp-contract=off"]
WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror"]
BORDER = 1.1
# The program written by hand has no dead time. With the default dead time, the generated program would write other
# levels than that program.  The program written by hand does not limit setpoints either.
ROBOT = """version: 1
extends: host_jiwy.tcf
control: {enable_at_start: true}
communication: {middleware: none}
components:
  pwm_pan: {dead_time: 0 s}
  pwm_tilt: {dead_time: 0 s}
  pan_subscriber: {limits: null}
  tilt_subscriber: {limits: null}
"""


@dataclass(frozen=True)
class Program:
    """A linked driver.  ``cycle`` is the function of a control cycle.

    ``glue`` are the object files between the model and the port layer; ``model`` are those of the model.
    """

    path: Path
    cycle: str
    glue: tuple[Path, ...]
    model: tuple[Path, ...]


def main() -> None:
    options = arguments(__doc__, cycles=2000, trace=60000)
    if shutil.which("valgrind") is None:
        raise SystemExit("valgrind is not installed: apt install valgrind")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        generated, written = build_generated(folder / "generated"), build_handwritten(folder)
        compared = compare_traces(generated, written, options.trace)
        costs = {p: cycle_costs(p, folder, options.cycles) for p in (generated, written)}
        tables = [cost_table(costs[generated], costs[written], [compared]), memory_table(generated, written, folder)]
    show("runtime", tables, options.write, command_line("runtime"))


GLUE = ("jiwy_app.c", "jiwy_model.c", "jiwy_version.c")


def build_generated(folder: Path) -> Program:
    """Builds JIWY as ``epg generate`` writes it, with the driver's port layer instead of the host's."""
    folder.mkdir()
    output = folder / "generated"
    (folder / "robot.tcf").write_text(ROBOT, encoding="utf-8")
    files = jiwy_files(folder / "robot.tcf")
    run([sys.executable, EPG, "generate", "jiwy", *files, "--output", output, "--source-dir", JIWY])
    kinds = sorted(path for path in (ROOT / "targets" / "components").iterdir() if path.is_dir())
    includes = [RUNTIME / "include", SOURCES, output, *kinds]
    names = ["-include", str(output / "jiwy_model_names.h")]
    own = [compile_c(output / "jiwy_model_export.c", folder / "g", includes, ["-w", *names])]
    own += [compile_c(s, folder / "gm", [JIWY / "model"], ["-w", *names]) for s in model_sources()]
    restart = folder / "restart"
    run([sys.executable, EPG, "model-variables", "jiwy_model", *own, "--output", restart])
    export, *model = [restart / f"jiwy_model_{index}.o" for index in range(len(own))]
    export = export.rename(restart / "jiwy_model_export.o")
    glue = [compile_c(output / name, folder / "g", includes, WARNINGS) for name in GLUE]
    glue += [compile_c(restart / "jiwy_model_export_variables.c", folder / "g", includes, WARNINGS), export]
    others = [compile_c(SOURCES / name, folder / "g", includes, WARNINGS) for name in ("generated.c", "driver.c")]
    shared = sorted([*(RUNTIME / "src").glob("*/*.c"), *(source for kind in kinds for source in kind.glob("*.c"))])
    library = [compile_c(source, folder / "r", includes, WARNINGS) for source in shared]
    glue += linked_from(library, [*glue, *others])
    return Program(link([*glue, *model, *others], folder / "g/driver"), "epg_control_cycle", tuple(glue), tuple(model))


def linked_from(library: Sequence[Path], objects: Sequence[Path]) -> list[Path]:
    """The objects of a library that a linker would take for ``objects``: those that define missing symbols."""
    taken: list[Path] = []
    while True:
        present = [*objects, *taken]
        missing = set().union(*(symbols(path, "U") for path in present))
        more = [path for path in library if path not in taken and symbols(path, "TDBRVW") & missing]
        if not more:
            return taken
        taken += more


def symbols(path: Path, letters: str) -> set[str]:
    """The symbols of an object file whose type is one of the ``letters`` of ``nm``."""
    return {line.split()[-1] for line in run(["nm", path]).splitlines() if line.split()[-2] in letters}


def build_handwritten(folder: Path) -> Program:
    includes = [RUNTIME / "include", SOURCES]
    glue = [compile_c(SOURCES / "handwritten.c", folder / "h", includes, WARNINGS)]
    model = [compile_c(source, folder / "hm", [JIWY / "model"], ["-w"]) for source in model_sources()]
    driver = compile_c(SOURCES / "driver.c", folder / "h", includes, WARNINGS)
    return Program(link([*glue, *model, driver], folder / "h/driver"), "glue_cycle", tuple(glue), tuple(model))


def model_sources() -> list[Path]:
    return sorted((JIWY / "model").glob("*.c"))


def compile_c(source: Path, folder: Path, includes: Sequence[Path], more: Sequence[str]) -> Path:
    folder.mkdir(exist_ok=True)
    output = folder / f"{source.stem}.o"
    run([compiler(), *OPTIONS, *more, *(f"-I{path}" for path in includes), "-c", source, "-o", output])
    return output


def link(objects: Sequence[Path], output: Path) -> Path:
    run([compiler(), *objects, "-lm", "-o", output])
    return output


def compiler() -> str:
    found = shutil.which("gcc") or shutil.which("cc")
    if found is None:
        raise SystemExit("a C compiler is needed: apt install gcc")
    return found


def compare_traces(generated: Program, written: Program, cycles: int) -> str:
    """Compares the traces of both programs, and returns a sentence about it.  Ends the benchmark if they differ."""
    one, other = (run([program.path, str(cycles), "trace"]).splitlines() for program in (generated, written))
    for number, (a, b) in enumerate(zip(one, other, strict=True)):
        if a != b:
            raise SystemExit(f"the two programs differ in cycle {number}:\n generated: {a}\n by hand:   {b}")
    disabled = sum(line.split()[9] == "0" for line in one)
    faults = {line.split()[10] for line in one} - {"0"}
    return (
        f"The traces of both programs are equal. They have {len(one):,} cycles; in {disabled:,} of these, the target "
        f"was disabled. {len(faults)} kinds of fault occurred."
    )


def cycle_costs(program: Program, folder: Path, cycles: int) -> dict[str, float]:
    """Instructions per control cycle of model, port layer and glue.

    They are the difference between a long and a short run, so the first cycles, which initialise the model, do not
    count.
    """
    few, many = (collected(program, folder, count) for count in (cycles // 2, cycles + cycles // 2))
    model = defined_in(program.model)
    result = {"model": 0.0, "port layer": 0.0, "glue": 0.0}
    for function, cost in many.items():
        share = (cost - few.get(function, 0)) / cycles
        result["model" if function in model else "port layer" if function.startswith("epg_port_") else "glue"] += share
    return result


def collected(program: Program, folder: Path, cycles: int) -> dict[str, int]:
    """Instructions of each function within control cycles."""
    output = folder / "callgrind.out"
    command = ["valgrind", "--tool=callgrind", f"--toggle-collect={program.cycle}", "--compress-strings=no"]
    run([*command, "--compress-pos=no", f"--callgrind-out-file={output}", program.path, str(cycles)])
    costs: dict[str, int] = {}
    function, called = "", False
    for line in output.read_text(encoding="utf-8").splitlines():
        if line.startswith("fn="):
            function = line[3:].partition("'")[0]
        elif line.startswith("calls="):
            called = True  # the next line is the cost of the called function, which is counted in that function
        elif re.match(r"\d+ \d+$", line):
            costs[function] = costs.get(function, 0) + (0 if called else int(line.split()[1]))
            called = False
    return costs


def defined_in(objects: Sequence[Path]) -> set[str]:
    return set().union(*(symbols(path, "tT") for path in objects))


def cost_table(generated: dict[str, float], written: dict[str, float], notes: Sequence[str]) -> Table:
    rows = [[name, f"{generated[name]:.1f}", f"{written[name]:.1f}", ""] for name in ("model", "port layer")]
    ratio = generated["glue"] / written["glue"]
    rows.append(["everything else", f"{generated['glue']:.1f}", f"{written['glue']:.1f}", f"{ratio:.2f} x"])
    whole = sum(generated.values()) / sum(written.values())
    rows.append(["whole cycle", f"{sum(generated.values()):.1f}", f"{sum(written.values()):.1f}", f"{whole:.2f} x"])
    judged = "holds" if ratio <= BORDER else "does not hold"
    notes = [f"Aim: everything else at most {BORDER} x of what is written by hand: {judged}.", *notes]
    return Table("Instructions per control cycle", ["part", "generated", "by hand", "ratio"], rows, notes)


def memory_table(generated: Program, written: Program, folder: Path) -> Table:
    rows = []
    for program, title in ((generated, "generated"), (written, "by hand")):
        sums = [0, 0, 0, 0]
        for path in program.glue:
            sums = [a + b for a, b in zip(sums, section_sizes(path))]
        rows.append([title, *map(str, sums)])
    includes = [RUNTIME / "include"]
    sizes_program = link([compile_c(SOURCES / "sizes.c", folder / "s", includes, WARNINGS)], folder / "s/sizes")
    notes = [f"Bytes of the runtime's objects: {', '.join(run([sizes_program]).splitlines())}."]
    return Table("Memory of the glue, bytes", ["program", "code", "constants", ".data", ".bss"], rows, notes)


def section_sizes(path: Path) -> tuple[int, int, int, int]:
    """Sizes of code, constants, initialised data and cleared data of an object file, in bytes."""
    sums = {"text": 0, "rodata": 0, "data": 0, "bss": 0}
    for line in run(["size", "-A", path]).splitlines():
        found = re.match(r"\.(text|rodata|data\.rel\.ro|data|bss)\S*\s+(\d+)", line)
        if found:
            sums["rodata" if found[1] == "data.rel.ro" else found[1]] += int(found[2])
    return sums["text"], sums["rodata"], sums["data"], sums["bss"]


if __name__ == "__main__":
    main()
