# SPDX-License-Identifier: Apache-2.0
"""Simulated time: the contents of the files that a run writes for the user."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import pytest

from .program import PROGRAMS, Program, compile_program, platform_sources, rows


def test_two_runs_give_the_same_bytes(motor: Program, tmp_path: Path) -> None:
    events = rows("0.1,motor_setpoint,1", "0.5,$stall,0.0025", "0.7,motor_setpoint,-1.5", "0.9,motor_setpoint,nan")
    first = motor.run_good(tmp_path / "first", 2, events)
    second = motor.run_good(tmp_path / "second", 2, events)
    for name in ("trace.csv", "topics.csv"):
        assert (first.folder / name).read_bytes() == (second.folder / name).read_bytes()
    assert len((first.folder / "trace.csv").read_bytes()) > 50_000


def test_trace_has_a_row_per_cycle_and_the_plant_follows(motor: Program, tmp_path: Path) -> None:
    run = motor.run_good(tmp_path, 2, rows("0.1,motor_setpoint,1"))
    trace = run.trace
    assert list(trace) == [
        "time", "inputs.position", "inputs.setpoint", "outputs.duty", "plant.inputs.duty", "plant.outputs.angle",
        "plant.steps", "model.steps", "enabled", "fault", "lateness", "computation",
    ]  # fmt: skip
    assert trace["time"] == [k / 1000 for k in range(2000)]
    assert set(trace["lateness"]) == set(trace["computation"]) == set(trace["fault"]) == {0.0}
    assert set(trace["enabled"]) == {1.0}
    # The encoder counts from 0 although the shaft starts at 12.5 rad; from then on both agree within one count.
    count = 2 * math.pi / 4096
    shift = [angle - 12.5 - position for angle, position in zip(trace["plant.outputs.angle"], trace["inputs.position"])]
    assert all(-count < difference < 2 * count for difference in shift)
    assert trace["inputs.position"][0] == 0.0
    assert abs(trace["inputs.position"][-1] - 1.0) < 0.01
    assert run.statistics["cycles"] == 2000


def test_order_within_a_cycle(motor: Program, tmp_path: Path) -> None:
    trace = motor.run_good(tmp_path, 0.1).trace
    # Cycle k reads the plant after k periods, and its output reaches the plant before the next step.
    assert trace["plant.steps"] == [7.0 * k for k in range(100)]
    assert trace["model.steps"] == [float(k + 1) for k in range(100)]
    for duty, driven in zip(trace["outputs.duty"], trace["plant.inputs.duty"]):
        assert driven == round(duty * 6250) / 6250


def test_pwm_is_quantised_in_steps_of_its_timer(motor: Program, tmp_path: Path) -> None:
    trace = motor.run_good(tmp_path, 0.5, rows("0,motor_setpoint,0.3")).trace
    steps = [duty * 6250 for duty in trace["plant.inputs.duty"]]
    assert all(abs(step - round(step)) < 1e-9 for step in steps)
    assert trace["plant.inputs.duty"] != trace["outputs.duty"]


@pytest.mark.parametrize(("time", "cycle"), [("0", 0), ("0.010", 10), ("0.0100001", 11), ("0.0109", 11)])
def test_setpoint_is_seen_by_the_first_cycle_at_or_after_its_time(
    motor: Program, tmp_path: Path, time: str, cycle: int
) -> None:
    seen = motor.run_good(tmp_path, 0.05, rows(f"{time},motor_setpoint,0.75")).trace["inputs.setpoint"]
    assert seen == [0.25] * cycle + [0.75] * (50 - cycle)


def test_setpoint_at_the_end_or_later_does_nothing(motor: Program, tmp_path: Path) -> None:
    events = rows("0.05,motor_setpoint,nan", "7,$enable,0")
    run = motor.run_good(tmp_path, 0.05, events)
    assert run.statistics["setpoints_dropped"] == 0
    assert set(run.trace["inputs.setpoint"]) == {0.25}
    assert run.statistics["enabled"] is True


def test_publications_on_their_own_schedule(motor: Program, tmp_path: Path) -> None:
    run = motor.run_good(tmp_path, 1, rows("0.1,motor_setpoint,1"))
    times = [time for time, topic, _ in run.topics if topic == "motor_position"]
    assert times == [33 * k / 1000 for k in range(31)]
    trace = run.trace
    for time, topic, value in run.topics:
        column = {"motor_position": "inputs.position", "motor_echo": "inputs.setpoint"}[topic]
        assert value == trace[column][round(time * 1000)]  # value of the cycle at the same time
    assert len(run.topics) == 2 * 31


def test_enabling_and_disabling(motor: Program, tmp_path: Path) -> None:
    events = rows("0,motor_setpoint,5", "0.2,$enable,0", "0.4,motor_enable,1", "0.6,motor_enable,0")
    run = motor.run_good(tmp_path, 1, events)
    enabled = run.trace["enabled"]
    assert enabled == [1.0] * 200 + [0.0] * 200 + [1.0] * 200 + [0.0] * 400
    driven = run.trace["plant.inputs.duty"]
    assert set(driven[200:400]) == set(driven[600:]) == {0.0}
    assert min(driven[:200]) > 0.5
    assert run.statistics["enabled"] is False
    assert run.statistics["fault"] == "none"
    # The motor coasts until it stops; meanwhile position and topics are still updated.
    position = run.trace["inputs.position"]
    assert position[399] > position[199] + 0.1
    assert position[399] - position[380] < 0.02
    assert run.topics[-2][2] > 0.0


def test_digital_input_from_the_file(motor: Program, tmp_path: Path) -> None:
    stop = "$component:emergency_stop"
    events = rows("0,motor_setpoint,5", f"0.1,{stop},0", f"0.2,{stop},1", "0.25,$enable,1")
    run = motor.run_good(tmp_path, 0.3, events)
    assert run.trace["enabled"] == [1.0] * 100 + [0.0] * 150 + [1.0] * 50
    assert set(run.trace["plant.inputs.duty"][100:250]) == {0.0}
    assert run.statistics["faults"] == 1
    assert run.statistics["fault"] == "none"


@pytest.fixture(scope="module")
def held_motor(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """A motor whose plant reports in every cycle that the emergency stop is not pressed."""
    sources = [PROGRAMS / "motor.c", *platform_sources()]
    output = tmp_path_factory.mktemp("held_motor") / "motor"
    return Program(compile_program(output, sources, defines=["PLANT_HOLDS_INPUT"]))


def test_a_forced_input_wins_over_the_plant(held_motor: Program, tmp_path: Path) -> None:
    stop = "$component:emergency_stop"
    events = rows("0,motor_setpoint,5", f"0.1,{stop},0", f"0.2,{stop},plant", "0.25,$enable,1")
    run = held_motor.run_good(tmp_path, 0.3, events)
    assert run.trace["enabled"] == [1.0] * 100 + [0.0] * 150 + [1.0] * 50
    assert run.statistics["faults"] == 1


def test_an_open_wire_has_the_level_of_the_pull_resistor(held_motor: Program, tmp_path: Path) -> None:
    # The motor's input has a pull-up: with a broken wire it would read 1, and the motor would not stop.
    run = held_motor.run_good(tmp_path, 0.3, rows("0.1,$component:emergency_stop,open"))
    assert run.trace["enabled"] == [1.0] * 300


@pytest.mark.parametrize(("value", "shown"), [("(double)NAN", "nan"), ("1e300", "1e+300"), ("-2e12", "-2000000000000")])
def test_a_plant_that_diverges_ends_the_run(tmp_path: Path, value: str, shown: str) -> None:
    sources = [PROGRAMS / "motor.c", *platform_sources()]
    program = Program(compile_program(tmp_path / "motor", sources, defines=[f"PLANT_DIVERGES={value}"]))
    for more in ((), ("--realtime",)):
        run = program.run(tmp_path, 0.5, rows("0,motor_setpoint,5"), *more)
        assert run.status == 1
        # the thousandth step, at 7 plant steps per control period of 1 ms
        assert f"error: the plant has diverged: plant.outputs.angle is {shown} at 0.143 s\nhint: " in run.stderr
        assert run.trace["time"][-1] < 0.143
        assert more or len(run.trace["time"]) == 143, "in real time, this computer may miss a tick"
        assert set(run.trace["inputs.position"]) > {0.0}


def test_non_finite_setpoints_are_dropped_and_counted(motor: Program, tmp_path: Path) -> None:
    events = rows(*(f"0.0{k},motor_setpoint,{value}" for k, value in enumerate(["0.5", "nan", "inf", "-inf"], 1)))
    run = motor.run_good(tmp_path, 0.1, events)
    assert run.trace["inputs.setpoint"] == [0.25] * 10 + [0.5] * 90
    assert run.statistics["setpoints_dropped"] == 3
    assert run.statistics["enabled"] is True


def test_values_of_one_moment_count_as_one_delivery(motor: Program, tmp_path: Path) -> None:
    # The last event is dropped, but the event before it must still be delivered.
    run = motor.run_good(
        tmp_path, 0.05, rows("0.01,motor_setpoint,1", "0.01,motor_setpoint,2", "0.01,motor_setpoint,nan")
    )
    assert run.trace["inputs.setpoint"] == [0.25] * 10 + [2.0] * 40
    assert run.statistics["setpoints_dropped"] == 1


def test_stall_takes_simulated_time_and_misses_ticks(motor: Program, tmp_path: Path) -> None:
    run = motor.run_good(tmp_path, 0.1, rows("0.0095,$stall,0.0025"))
    trace = run.trace
    ticks = [round(time * 1000) for time in trace["time"]]
    # Cycle 10 lasts until 12.5 ms: tick 11 is missed, cycle 12 starts half a millisecond late, 13 is on time again.
    assert ticks == [*range(11), *range(12, 100)]
    assert trace["computation"][10] == 0.0025
    assert trace["lateness"][11] == 0.0005
    assert [lateness for k, lateness in enumerate(trace["lateness"]) if k != 11] == [0.0] * 98
    # Meanwhile the plant continues, driven by the outputs of cycle 9.
    assert trace["plant.steps"][11] == math.floor(12.5 * 7)
    assert trace["plant.steps"][12] == 13 * 7
    statistics = run.statistics
    assert (statistics["cycles"], statistics["missed"]) == (99, 1)
    assert statistics["overruns"] == 2
    assert (statistics["lateness_max"], statistics["lateness_min"]) == (0.0005, 0.0)
    assert statistics["computation_max"] < 0.0025  # this is real time, in which there was no stall
    assert statistics["enabled"] is True


def test_outputs_of_a_stalled_cycle_come_at_its_end(motor: Program, tmp_path: Path) -> None:
    events = rows("0.010,motor_setpoint,-5", "0.010,$stall,0.0205")
    trace = motor.run_good(tmp_path, 0.1, events).trace
    angle = trace["plant.outputs.angle"]
    assert trace["outputs.duty"][9] > 0 > trace["outputs.duty"][10]
    assert trace["time"][10:12] == [0.01, 0.03]
    # The duty of cycle 9 acts for the whole 20.5 ms, although cycle 10 has read the new setpoint at its start.
    # The row of cycle 10, recorded at its end, is the first that shows the resulting angle.
    assert angle[10] - angle[9] > 5 * (angle[9] - angle[8]) > 0
    assert angle[11] == angle[10]
    assert trace["plant.inputs.duty"][9] > 0 > trace["plant.inputs.duty"][10]


def test_publications_go_on_during_a_stall_with_the_old_values(motor: Program, tmp_path: Path) -> None:
    run = motor.run_good(tmp_path, 0.3, rows("0.06,motor_setpoint,1", "0.06,$stall,0.1"))
    echo = [(round(time * 1000), value) for time, topic, value in run.topics if topic == "motor_echo"]
    assert echo == [(0, 0.25), (33, 0.25), (66, 0.25), (99, 0.25), (132, 0.25), (165, 1.0), (198, 1.0), (231, 1.0),
                    (264, 1.0), (297, 1.0)]  # fmt: skip


def test_stalls_in_a_row_disable(motor: Program, tmp_path: Path) -> None:
    stalls = [f"{k / 1000},$stall,0.0015" for k in range(20, 40)]
    run = motor.run_good(tmp_path, 0.2, rows("0,motor_setpoint,5", *stalls))
    assert run.statistics["fault"] == "overrun"
    assert run.trace["fault"][-1] == 3.0
    assert set(run.trace["plant.inputs.duty"][-100:]) == {0.0}


def test_ticks_missed_at_the_very_end_are_counted(motor: Program, tmp_path: Path) -> None:
    run = motor.run_good(tmp_path, 0.1, rows("0.09,$stall,1"))
    assert (run.statistics["cycles"], run.statistics["missed"]) == (91, 9)
    assert run.statistics["duration"] == 0.1
    assert max(time for time, _, _ in run.topics) == 0.099


def test_computation_time_leaves_out_the_plant(motor: Program, tmp_path: Path) -> None:
    # Seven million steps of the plant within one control cycle.
    statistics = motor.run_good(tmp_path, 0.1, rows("0.05,$stall,1000")).statistics
    assert statistics["computation_max"] < 0.5 * statistics["wall_time"]


def test_age_of_setpoints(tmp_path: Path) -> None:
    sources = [PROGRAMS / "motor.c", *platform_sources()]
    program = Program(compile_program(tmp_path / "motor", sources, defines=["SETPOINT_TIMEOUT_NS=20000000"]))
    run = program.run_good(tmp_path / "run", 0.2, rows("0.0405,motor_setpoint,1", "0.055,motor_setpoint,2"))
    # The setpoint times out 20 ms after its own time, not 20 ms after the cycle that first used it.
    assert run.trace["inputs.setpoint"] == [0.25] * 41 + [1.0] * 14 + [2.0] * 21 + [0.0] * 124
    assert run.statistics["setpoint_timeouts"] == 1


def test_statistics(motor: Program, tmp_path: Path) -> None:
    statistics = motor.run_good(tmp_path, 0.5).statistics
    assert list(statistics) == [
        "name", "mode", "scheduler", "memory_locked", "period", "duration", "wall_time", "interrupted", "cycles",
        "overruns", "missed", "outputs_late", "lateness_min", "lateness_mean", "lateness_p99", "lateness_p999",
        "lateness_max", "interval_deviation_min", "interval_deviation_rms", "interval_deviation_max", "computation_min",
        "computation_mean", "computation_max", "trace_dropped", "clamped", "setpoints_dropped", "setpoint_timeouts",
        "faults", "enabled", "fault", "fault_component", "lateness_histogram",
    ]  # fmt: skip
    assert (statistics["name"], statistics["mode"], statistics["scheduler"]) == ("motor", "simulated", "simulated")
    assert (statistics["period"], statistics["duration"]) == (0.001, 0.5)
    assert 0.0 < statistics["computation_min"] <= statistics["computation_mean"] <= statistics["computation_max"]
    assert statistics["computation_max"] < statistics["wall_time"]
    assert statistics["lateness_histogram"] == [{"below": 1e-06, "count": 500}]


def test_times_are_rounded_to_nanoseconds(motor: Program, tmp_path: Path) -> None:
    # 1.001 * 1e9 is a little less than 1001000000 in doubles.
    assert motor.run_good(tmp_path, 1.001).statistics["duration"] == 1.001


def test_long_traces_are_written_piece_by_piece(motor: Program, tmp_path: Path) -> None:
    trace = motor.run_good(tmp_path, 5.0005).trace
    assert [round(time * 1000) for time in trace["time"]] == list(range(5001))
    assert all(later - earlier == 7.0 for earlier, later in pairwise(trace["plant.steps"]))


def test_without_plant_sensors_stand_still(tmp_path: Path) -> None:
    program = Program(
        compile_program(
            tmp_path / "motor", [PROGRAMS / "motor.c", *platform_sources()], defines=["WITHOUT_PLANT"], sanitize=[]
        )
    )
    run = program.run_good(tmp_path / "run", 0.1, rows("0.05,motor_setpoint,1"))
    assert set(run.trace["inputs.position"]) == set(run.trace["plant.steps"]) == {0.0}
    assert run.trace["outputs.duty"] == [0.2] * 50 + [0.8] * 50
    assert [value for _, topic, value in run.topics if topic == "motor_position"] == [0.0] * 4


def test_disabled_at_start(tmp_path: Path) -> None:
    program = Program(
        compile_program(
            tmp_path / "motor",
            [PROGRAMS / "motor.c", *platform_sources()],
            defines=["ENABLE_AT_START=false", "PERIOD_NS=3000000", "STEPS_PER_PERIOD=1"],
            sanitize=[],
        )
    )
    run = program.run_good(tmp_path / "run", 0.3, rows("0.15,$enable,1"))
    assert run.trace["enabled"] == [0.0] * 50 + [1.0] * 50
    assert [round(time * 1000) for time in run.trace["time"]] == list(range(0, 300, 3))
    assert run.trace["plant.steps"] == [float(k) for k in range(100)]
