# SPDX-License-Identifier: Apache-2.0
"""Real time.  A shared machine has no reliable times: the tests only assert that the reports are consistent."""

from __future__ import annotations

import json
import os
import pty
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

import pytest

from tests.waiting import until

from .program import (
    ADDRESS_SANITIZER,
    PROGRAMS,
    THREAD_SANITIZER,
    Program,
    Run,
    compile_program,
    platform_sources,
    rows,
)

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="real time on the host needs Linux")


def assert_consistent(run: Run, ticks: int) -> None:
    """Every tick has a cycle or counts as missed, and all cycles belong to ticks of the same phase."""
    statistics, trace = run.statistics, run.trace
    assert statistics["cycles"] + statistics["missed"] == ticks
    assert len(trace["time"]) == statistics["cycles"]
    indices = [round(value * 1000) for value in trace["time"]]
    assert trace["time"] == [index / 1000 for index in indices]
    assert all(later > earlier for earlier, later in pairwise(indices))
    assert max(trace["lateness"]) == statistics["lateness_max"]
    assert min(trace["lateness"]) == statistics["lateness_min"] >= 0.0
    assert min(trace["computation"]) == statistics["computation_min"] > 0.0
    assert max(trace["computation"]) == statistics["computation_max"]
    assert sum(trace["lateness"]) / len(trace["lateness"]) == pytest.approx(statistics["lateness_mean"])
    ordered = sorted(trace["lateness"])
    for key, share in (("lateness_p99", 0.99), ("lateness_p999", 0.999)):
        exact = ordered[max(0, -int(-share * len(ordered) // 1) - 1)]
        assert exact <= statistics[key] * (1 + 1e-9) and statistics[key] <= exact * 1.04 + 1e-9
    deviations = [later - earlier for earlier, later in pairwise(trace["lateness"])]
    assert min(deviations) == pytest.approx(statistics["interval_deviation_min"], abs=1e-12)
    assert max(deviations) == pytest.approx(statistics["interval_deviation_max"], abs=1e-12)
    assert sum(bin_["count"] for bin_ in statistics["lateness_histogram"]) == statistics["cycles"]


def traced(folder: Path) -> float:
    """The time of the last row that a running program has written into its trace; 0 without one."""
    file = folder / "trace.csv"
    whole = file.read_text().split("\n")[1:-1] if file.is_file() else []
    return float(whole[-1].split(",")[0]) if whole else 0.0


def test_two_seconds_at_one_millisecond(patient_motor: Program, tmp_path: Path) -> None:
    run = patient_motor.run_good(tmp_path, 2, rows("0.1,motor_setpoint,1"), "--realtime")
    assert_consistent(run, 2000)
    statistics, trace = run.statistics, run.trace
    assert statistics["mode"] == "realtime"
    assert statistics["scheduler"] in ("SCHED_FIFO", "SCHED_OTHER")
    assert statistics["duration"] == 2.0
    assert statistics["wall_time"] >= 1.999
    assert statistics["cycles"] > 1000
    assert f"scheduler    {statistics['scheduler']}" in run.stdout
    if statistics["scheduler"] == "SCHED_OTHER":
        assert "SCHED_FIFO refused: " in run.stdout
    # The setpoint arrives at its time or later, and the plant follows as in simulated time.
    arrival = trace["inputs.setpoint"].index(1.0)
    assert trace["time"][arrival] >= 0.1
    assert abs(trace["inputs.position"][-1] - 1.0) < 0.05
    assert all(steps == 7 * round(now * 1000) for steps, now in zip(trace["plant.steps"], trace["time"]))


def test_publications_in_real_time(patient_motor: Program, tmp_path: Path) -> None:
    times = [
        when
        for when, topic, _ in patient_motor.run_good(tmp_path, 1, None, "--realtime").topics
        if topic == "motor_echo"
    ]
    slots = [int(when / 0.033) for when in times]
    assert all(later > earlier for earlier, later in pairwise(slots))
    assert len(times) >= 15
    assert times[0] >= 0.0 and times[-1] < 1.1


def test_slow_cycles_miss_ticks_but_keep_the_phase(motor: Program, tmp_path: Path) -> None:
    # 5.3 ms of computation in each cycle: only every sixth tick has a cycle, and three overruns cause the fault.
    run = motor.run_good(tmp_path, 0.5, rows("0.1,motor_setpoint,1005.3", "0.3,motor_setpoint,0"), "--realtime")
    assert_consistent(run, 500)
    statistics = run.statistics
    assert statistics["missed"] >= 100
    assert statistics["computation_max"] >= 0.0053
    assert statistics["overruns"] >= 20
    assert statistics["fault"] == "overrun"


def test_events_act_in_real_time(patient_motor: Program, tmp_path: Path) -> None:
    events = rows(
        "0,motor_setpoint,5",
        "0.2,$component:emergency_stop,0",
        "0.3,$component:emergency_stop,1",
        "0.4,motor_enable,1",
        "0.5,motor_setpoint,nan",
    )
    run = patient_motor.run_good(tmp_path, 0.6, events, "--realtime")
    enabled = dict(zip((round(now * 1000) for now in run.trace["time"]), run.trace["enabled"]))
    changes = [(ms, state) for (_, before), (ms, state) in pairwise(sorted(enabled.items())) if state != before]
    assert [state for _, state in changes] == [0.0, 1.0]
    assert changes[0][0] >= 200
    assert changes[1][0] >= 400
    assert run.statistics["setpoints_dropped"] == 1


def test_age_of_setpoints_in_real_time(tmp_path: Path) -> None:
    sources = [PROGRAMS / "motor.c", *platform_sources()]
    defines = ["OVERRUN_LIMIT=0", "SETPOINT_TIMEOUT_NS=250000000"]
    program = Program(compile_program(tmp_path / "motor", sources, defines=defines))
    events = rows(*(f"{0.05 * k:.2f},motor_setpoint,1" for k in range(1, 9)))  # the last one at 0.4 s
    run = program.run_good(tmp_path / "run", 1, events, "--realtime")
    assert run.statistics["setpoint_timeouts"] == 1
    seen = [time for time, setpoint in zip(run.trace["time"], run.trace["inputs.setpoint"]) if setpoint == 1.0]
    assert 0.6 < seen[-1] < 1


@pytest.mark.skipif(os.geteuid() != 0, reason="needs root, to run as a user without privileges")
def test_user_without_privileges(patient_motor: Program) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o777)  # the other user has no access to pytest's own folders
        program = shutil.copy(patient_motor.path, folder / "motor")
        done = subprocess.run(
            [program, "--realtime", "--duration", "0.2", "--statistics", str(folder / "statistics.json")],
            capture_output=True, text=True, check=False, timeout=60, user=65534, group=65534, extra_groups=[],
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0)),
        )  # fmt: skip
        statistics = json.loads((folder / "statistics.json").read_text())
    assert done.returncode == 0
    assert statistics["scheduler"] == "SCHED_OTHER"
    assert statistics["cycles"] + statistics["missed"] == 200
    assert "scheduler    SCHED_OTHER (SCHED_FIFO refused: Operation not permitted), memory " in done.stdout


def test_stall_is_refused(motor: Program, tmp_path: Path) -> None:
    run = motor.run(tmp_path, 1, rows("0.1,$stall,0.1"), "--realtime")
    assert run.status == 2
    assert run.stderr == f"{tmp_path / 'setpoints.csv'}:2: error: '$stall' works in simulated time only\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupt_ends_the_run_and_writes_the_files(motor: Program, tmp_path: Path, number: signal.Signals) -> None:
    command = motor.arguments(tmp_path, 60, None, "--realtime")
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        until(lambda: traced(tmp_path) > 0.1)
        process.send_signal(number)
        stdout, stderr = process.communicate(timeout=10)
    assert (process.returncode, stderr) == (130, "")
    assert "interrupted" in stdout
    run = Run(process.returncode, stdout, stderr, tmp_path)
    assert run.statistics["interrupted"] is True
    assert 0.1 < run.statistics["duration"] < 20
    assert len(run.trace["time"]) == run.statistics["cycles"] > 10
    assert run.topics


def test_hangup_of_the_terminal_ends_the_run_and_writes_the_files(motor: Program, tmp_path: Path) -> None:
    command = motor.arguments(tmp_path, 60, None, "--realtime")
    pid, terminal = pty.fork()
    if pid == 0:
        os.execv(command[0], command)
    until(lambda: traced(tmp_path) > 0.1)
    os.kill(pid, signal.SIGHUP)  # the shell's; the system's comes when the terminal closes
    os.close(terminal)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 130
    run = Run(130, "", "", tmp_path)
    assert len(run.trace["time"]) == run.statistics["cycles"] > 10
    assert run.topics


def test_hangup_is_ignored_under_nohup(motor: Program, tmp_path: Path) -> None:
    command = motor.arguments(tmp_path, 1, None, "--realtime")
    process = subprocess.Popen(["nohup", *command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    until(lambda: traced(tmp_path) > 0)
    process.send_signal(signal.SIGHUP)
    assert process.wait(10) == 0


@pytest.mark.parametrize("mode", ["--realtime", "--pace=1"])
def test_a_killed_run_keeps_its_rows_up_to_the_last_second(
    motor: Program, connected_motor: Program, tmp_path: Path, mode: str
) -> None:
    program = motor if mode == "--realtime" else connected_motor
    command = program.arguments(tmp_path, 60, None, mode)
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        reached = until(lambda: traced(tmp_path)) - time.monotonic()  # the run goes on while nobody looks
        until(lambda: traced(tmp_path) > 3.0)
        reached += time.monotonic()  # the run goes on while nobody looks
        process.kill()
        process.communicate(timeout=10)
    for name in ("trace.csv", "topics.csv"):
        rows = (tmp_path / name).read_text().split("\n")[1:-1]
        assert reached - 1.0 < float(rows[-1].split(",")[0]) <= 60, name


def resident(pid: int, key: str) -> int:
    """A value of the process's status, in kB."""
    words = next(line for line in Path(f"/proc/{pid}/status").read_text().splitlines() if line.startswith(key)).split()
    return int(words[1])


def test_the_memory_of_a_trace_does_not_depend_on_the_duration(tmp_path: Path) -> None:
    plain = compile_program(tmp_path / "plain", [PROGRAMS / "motor.c", *platform_sources()], sanitize=[])
    command = Program(plain).arguments(tmp_path, 1e9, None, "--realtime")
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        until(lambda: traced(tmp_path) > 0.3)
        used = [resident(process.pid, key) for key in ("VmRSS:", "VmLck:")]
        process.terminate()
        _, stderr = process.communicate(timeout=10)
    assert (process.returncode, stderr) == (130, b"")
    assert max(used) < 40_000, used


def test_rows_that_a_slow_file_does_not_take_are_counted(tmp_path: Path) -> None:
    """The trace goes to a pipe that nobody reads for a while.  The control loop goes on."""
    defines = ["PERIOD_NS=50000", "STEPS_PER_PERIOD=1", "OVERRUN_LIMIT=0"]
    sources = [PROGRAMS / "motor.c", *platform_sources()]
    program = Program(compile_program(tmp_path / "fast", sources, defines=defines, sanitize=[]))
    os.mkfifo(tmp_path / "trace.csv")
    command = program.arguments(tmp_path, 6, None, "--realtime")
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        with (tmp_path / "trace.csv").open() as pipe:
            time.sleep(6.0)  # the pipe is full, and nobody reads it
            times = [float(line.split(",")[0]) for line in pipe.readlines()[1:]]
        stdout, stderr = process.communicate(timeout=30)
    statistics = Run(0, stdout, stderr, tmp_path).statistics
    assert process.returncode == 0
    assert statistics["trace_dropped"] == statistics["cycles"] - len(times) > 0
    assert stderr == (
        f"warning: {statistics['trace_dropped']} rows of the trace are missing: the file was written too slowly\n"
    )
    assert all(later > earlier for earlier, later in pairwise(times))


def test_a_full_disk_is_reported(motor: Program, tmp_path: Path) -> None:
    command = [str(motor.path), "--realtime", "--duration", "0.5", "--trace", "/dev/full"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert done.stderr == "/dev/full: error: cannot write this file: No space left on device\n"


def run_checked(program: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs under ``setarch -R``: ThreadSanitizer of gcc 12 fails on kernels with more address randomisation."""
    setarch = shutil.which("setarch")
    prefix = [setarch, "-R"] if setarch is not None else []
    return subprocess.run([*prefix, str(program), *arguments], capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize("sanitize", [ADDRESS_SANITIZER, THREAD_SANITIZER], ids=["address", "thread"])
def test_own_main(tmp_path: Path, sanitize: list[str]) -> None:
    sources = [PROGRAMS / "motor.c", PROGRAMS / "own_main.c", *platform_sources(main=False)]
    done = run_checked(compile_program(tmp_path / "own", sources, defines=["OVERRUN_LIMIT=0"], sanitize=sanitize))
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert done.stdout.count("position") >= 20


def test_no_data_race(tmp_path: Path) -> None:
    sources = [PROGRAMS / "motor.c", *platform_sources()]
    program = compile_program(tmp_path / "motor", sources, sanitize=THREAD_SANITIZER)
    (tmp_path / "in.csv").write_text(
        rows(
            *(f"{k / 100},motor_setpoint,{k % 7}" for k in range(90)),
            "0.95,$enable,0",
            "0.96,$component:emergency_stop,0",
        )
    )
    done = run_checked(
        program, "--realtime", "--duration", "1", "--setpoints", str(tmp_path / "in.csv"),
        "--topics", str(tmp_path / "topics.csv"), "--trace", str(tmp_path / "trace.csv"),
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
