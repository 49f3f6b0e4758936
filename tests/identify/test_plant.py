# SPDX-License-Identifier: Apache-2.0
"""The parameters of the examples' plants follow from identified values, and are written without any other change."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from epg.generator import bootstrap
from epg.generator.check.formulas import FormulaError, parse_formula
from epg.generator.diagnostics import Diagnostics

bootstrap.ensure("plot")
from epg.identify.bound_plant import (  # noqa: E402
    BoundPlant,
    NoSolution,
    changed_text,
    load_plant,
    motor_for,
    solved,
    wanted_values,
)
from epg.identify.fit import Fit, FittedValue  # noqa: E402  # only after the check that its packages can be imported

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def load(robot: str, bindings: Path | None = None) -> BoundPlant:
    diagnostics = Diagnostics()
    folder = EXAMPLES / robot
    found = load_plant(folder / "plant", bindings or folder / "plant.bindings.yaml", diagnostics)
    return diagnostics.checked(found)


@pytest.mark.parametrize(
    ("robot", "duty"),
    [("jiwy", "duty_pan"), ("jiwy", "duty_tilt"), ("relbot", "duty_left"), ("relbot", "duty_right")],
)
def test_the_values_of_other_parameters_lead_to_these_parameters(robot: str, duty: str) -> None:
    plant = load(robot)
    motor = plant.bindings.motors[duty]
    true = {name: plant.values[name] * factor for (name, _), factor in zip(motor.change, (1.3, 0.6, 2.0))}
    known = plant.known() | true
    found = solved(plant, motor, motor.values(known))
    assert found == pytest.approx(true, rel=1e-4)  # five digits


def test_a_friction_of_0_is_a_parameter_of_0() -> None:
    plant = load("jiwy")
    motor = plant.bindings.motors["duty_pan"]
    gain, time_constant, _ = motor.values(plant.known())
    assert solved(plant, motor, [gain, time_constant, 0.0])[r"Pan\Motor\coulomb"] == 0.0


def test_values_that_no_plant_can_have_are_refused() -> None:
    plant = load("jiwy")
    motor = plant.bindings.motors["duty_pan"]
    gain, time_constant, friction = motor.values(plant.known())
    with pytest.raises(NoSolution, match="would become"):  # less inertia than the rotor alone has
        solved(plant, motor, [gain, 0.01 * time_constant, friction])
    with pytest.raises(NoSolution, match=r"no values of .* give the identified gain"):
        solved(plant, motor, [-1e6 * gain, time_constant, friction])


def test_the_motor_is_that_of_the_actuator() -> None:
    bindings = load("relbot").bindings
    for signal in ("actuators.pwm_right", "plant.inputs.duty_right", "duty_right"):
        motor = motor_for(bindings, signal)
        assert motor is not None
        assert motor.duty == "duty_right"
    assert motor_for(bindings, "outputs.steer") is None


def test_conversions_of_the_plants_wires_are_considered(tmp_path: Path) -> None:
    path = tmp_path / "plant.bindings.yaml"
    text = (EXAMPLES / "jiwy" / "plant.bindings.yaml").read_text(encoding="utf-8")
    text = text.replace("duty_pan: pwm_pan", "duty_pan: {from: pwm_pan, scale: -1}")
    path.write_text(text.replace("angle_pan: encoder_pan", "angle_pan: {to: encoder_pan, scale: -1/2}"), "utf-8")
    plant = load("jiwy", path)
    motor = plant.bindings.motors["duty_pan"]
    one = FittedValue(0.0, 0.0)
    fit = Fit(FittedValue(16.0, 0.1), FittedValue(0.03, 0.001), FittedValue(0.01, 0.001), one, None, 0.0)
    own = wanted_values(motor, plant.bindings, fit, "actuators.pwm_pan", "encoders.encoder_pan")
    assert own == [32.0, 0.03, 0.01]
    assert wanted_values(motor, plant.bindings, fit, "plant.inputs.duty_pan", "plant.outputs.angle_pan")[0] == 16.0


def test_only_the_parameters_change_in_the_file(tmp_path: Path) -> None:
    path = tmp_path / "plant.bindings.yaml"
    shutil.copy(EXAMPLES / "jiwy" / "plant.bindings.yaml", path)
    before = path.read_text(encoding="utf-8").replace(
        "motors:\n",
        "parameters:   # measured by hand\n"
        "  Pan.Motor.k: 0.0181     # data sheet\n"
        "  'Pan\\Camera\\J': {value: 3.1e-4, minimum: 0, description: with lens}\n"
        "motors:\n",
    )
    path.write_text(before, encoding="utf-8")
    changes = {r"Pan\Motor\k": 0.02, r"Pan\Camera\J": 4e-4, r"Pan\Motor\coulomb": 2e-4}
    after = changed_text(before, load("jiwy", path), changes)
    assert after == before.replace("0.0181", "0.02").replace("3.1e-4", "0.0004").replace(
        "with lens}\n", "with lens}\n  'Pan\\Motor\\coulomb': 0.0002\n"
    )
    path.write_text(after, encoding="utf-8")
    values = load("jiwy", path).values
    assert {name: values[name] for name in changes} == changes


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 + 3 * 4 ^ 2 / (1 - 3)", -22.0),
        ("-a^2", -9.0),
        ("sqrt(a * 12) * pi", 6 * 3.141592653589793),
        ("1e-3*e3 + b\\c.d", 5.004),
        ("a[1,2] + a::b", 3.0),
    ],
)
def test_formulas(text: str, value: float) -> None:
    values = {"a": 3.0, "e3": 4.0, "b\\c.d": 5.0, "a[1,2]": 1.0, "a::b": 2.0}
    assert parse_formula(text).value(values) == pytest.approx(value)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a b",
        "a +",
        "f(a)",
        "sqrt(a, a)",
        "__import__('os')",
        "'a'",
        "[a]",
        "a if a else a",
        "a = 1",
        "lambda: a",
        "a.__class__()",
        "a; a",
        "a\nb",
        "a // 2",
        "1j",
        "True + 1 == a",
        "(" * 300 + "a" + ")" * 300,
        "-" * 990 + "a",
        "a" * 2000,
    ],
)
def test_other_texts_are_not_formulas(text: str) -> None:
    with pytest.raises(FormulaError):
        formula = parse_formula(text)
        assert formula.value(dict.fromkeys(formula.names, 1.0)) is None


@pytest.mark.parametrize("text", ["1 / (a - a)", "a ^ 1e9", "sqrt(-a)", "(-a) ^ 0.5", "1e308 * 10"])
def test_formulas_without_a_value(text: str) -> None:
    with pytest.raises(FormulaError, match="value"):
        parse_formula(text).value({"a": 7.0})
