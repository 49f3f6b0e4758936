# SPDX-License-Identifier: Apache-2.0
"""Proposals for the ports of a model: the ones to bind at once, the ones for the user to accept, and none."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from epg.generator.catalog.catalog import load_catalog
from epg.generator.check.configuration import Configuration
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request, load_configuration
from epg.generator.resolve.matching import match_ports
from tests.edit.servo import model_of


@cache
def robot(name: str) -> Configuration:
    request = Request("robot", f"host_{name}.tcf", Path(), Path(), beside=Path())
    configuration = load_configuration(request, load_catalog(request.roots, Diagnostics()), Diagnostics())
    assert configuration is not None
    return configuration


def proposals(name: str, inputs: str, outputs: str) -> tuple[dict[str, str], dict[str, str]]:
    """What is bound at once, and what the user must accept."""
    matches = match_ports(model_of(inputs.split(), outputs.split()), robot(name).components)
    bound = {port: match.reference for port, match in matches.items() if match.reference}
    guessed = {port: match.guess for port, match in matches.items() if match.guess}
    assert not bound.keys() & guessed.keys()
    return bound, guessed


def test_equal_words_are_bound() -> None:
    assert proposals("jiwy", "position_pan", "pwm_pan encoder_reset_pan") == (
        {"position_pan": "encoder_pan", "pwm_pan": "pwm_pan", "encoder_reset_pan": "encoder_pan.reset"},
        {},
    )


def test_a_topic_is_bound_by_its_role_and_hardware_is_a_guess() -> None:
    assert proposals("relbot", "SetPosLeft PosLeft", "SteerLeft LogLeft") == (
        {"SetPosLeft": "left_subscriber", "LogLeft": "left_publisher"},
        {"PosLeft": "encoder_left", "SteerLeft": "pwm_left"},
    )


def test_a_motor_comes_before_a_publisher_of_the_same_side() -> None:
    """A model without an output for logging: its steering output must not become a topic."""
    assert proposals("relbot", "", "SteerLeft SteerRight") == ({}, {"SteerLeft": "pwm_left", "SteerRight": "pwm_right"})


def test_a_shared_word_alone_is_a_guess_if_nothing_else_is_left() -> None:
    assert proposals("relbot", "PosLeft left", "") == ({}, {"PosLeft": "encoder_left", "left": "left_subscriber"})
    assert proposals("relbot", "left", "") == ({}, {})


def test_an_export_of_20_sim_is_matched_by_roles() -> None:
    """The names of a real export: the commands of the motors must not become topics, which share a word with them."""
    bound, guessed = proposals(
        "jiwy",
        "MeasuredPan MeasuredTilt SetPointPan SetPointTilt",
        "SteeringPan SteeringTilt",
    )
    assert bound == {"SetPointPan": "pan_subscriber", "SetPointTilt": "tilt_subscriber"}
    assert guessed == {
        "MeasuredPan": "encoder_pan",
        "MeasuredTilt": "encoder_tilt",
        "SteeringPan": "pwm_pan",
        "SteeringTilt": "pwm_tilt",
    }


@pytest.mark.parametrize(
    ("inputs", "outputs", "found"),
    [
        ("EncPan RefPan", "PWMPan", {"EncPan": "encoder_pan", "RefPan": "pan_subscriber", "PWMPan": "pwm_pan"}),
        ("pan_pos pan_cmd", "OutPan", {"pan_pos": "encoder_pan", "pan_cmd": "pan_subscriber", "OutPan": "pwm_pan"}),
        ("PanPosRef", "LogMotorPan", {"PanPosRef": "pan_subscriber", "LogMotorPan": "pan_publisher"}),
        ("ref_measured_pan", "", {}),
        ("pan", "ThrustPan", {}),
    ],
)
def test_words_say_what_a_port_is_for(inputs: str, outputs: str, found: dict[str, str]) -> None:
    bound, guessed = proposals("jiwy", inputs, outputs)
    assert {**bound, **guessed} == found


def matched(inputs: dict[str, str], outputs: dict[str, str], bound: dict[str, tuple[str, ...]]) -> dict[str, str]:
    """The proposals for ports with these units."""
    model = model_of(list(inputs), list(outputs))
    model = replace(
        model,
        inputs=tuple(replace(port, unit=inputs[port.name]) for port in model.inputs),
        outputs=tuple(replace(port, unit=outputs[port.name]) for port in model.outputs),
    )
    matches = match_ports(model, robot("jiwy").components, bound)
    return {name: match.proposal for name, match in matches.items() if match.proposal}


def test_units_decide() -> None:
    assert matched({"MeasuredPan": "m"}, {"ThrustPan": "rad", "SteeringTilt": "V"}, {}) == {
        "ThrustPan": "pan_publisher"
    }


def test_a_component_port_of_another_port_is_not_proposed() -> None:
    bound = {"other": ("encoder_pan.position",), "drive": ("pwm_pan", "pan_publisher")}
    assert matched({"MeasuredPan": "", "pan": ""}, {"SteeringPan": "", "log_pan": ""}, {}) == {
        "MeasuredPan": "encoder_pan",
        "pan": "pan_subscriber",
        "SteeringPan": "pwm_pan",
        "log_pan": "pan_publisher",
    }
    assert matched({"MeasuredPan": "", "other": ""}, {"SteeringPan": "", "drive": "", "log_pan": ""}, bound) == {}


def test_what_fits_best_is_first() -> None:
    model = model_of(["foo", "pos_x"], ["log_x"])
    matches = match_ports(model, robot("jiwy").components, {"foo": ("encoder_pan",)})
    assert matches["pos_x"].fitting == ("encoder_tilt", "pan_subscriber", "tilt_subscriber")
    assert matches["pos_x"].meant == ("encoder_tilt",)
    assert matches["log_x"].fitting[:2] == ("pan_publisher", "tilt_publisher")


@pytest.mark.parametrize("outputs", ["SteerLeft MotorLeft", "Steer", "SteerMiddle"])
def test_what_is_not_the_only_one_is_not_proposed(outputs: str) -> None:
    bound, guessed = proposals("relbot", "", outputs)
    assert "pwm_left" not in {*bound.values(), *guessed.values()}


@pytest.mark.parametrize("name", ["pan", "left"])
def test_a_place_alone_never_moves_hardware(name: str) -> None:
    bound, guessed = proposals("jiwy" if name == "pan" else "relbot", "", name)
    assert not bound
    assert not guessed
