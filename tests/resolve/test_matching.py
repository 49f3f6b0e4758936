# SPDX-License-Identifier: Apache-2.0
"""Proposals for the ports of a model: the ones to bind at once, the ones for the user to accept, and none."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from epg.catalog.catalog import load_catalog
from epg.check.configuration import Configuration
from epg.diagnostics import Diagnostics
from epg.project import Request, load_configuration
from epg.resolve.matching import match_ports
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


def test_a_shared_word_alone_is_a_guess() -> None:
    assert proposals("relbot", "left", "") == ({}, {"left": "left_subscriber"})


@pytest.mark.parametrize("outputs", ["SteerLeft MotorLeft", "Steer", "SteerMiddle"])
def test_what_is_not_the_only_one_is_not_proposed(outputs: str) -> None:
    bound, guessed = proposals("relbot", "", outputs)
    assert "pwm_left" not in {*bound.values(), *guessed.values()}
