# SPDX-License-Identifier: Apache-2.0
"""Runs of a target: its description, its program on this computer, scenarios, traces, and their judgement."""
