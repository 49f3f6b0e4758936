# SPDX-License-Identifier: Apache-2.0
"""Finds a motor's gain, time constant and friction in a recording, and the plant's parameters that follow from them.

``samples`` takes the usable part of a recording, ``motor`` simulates a motor of first order, ``fit`` finds its values,
``formulas`` and ``plant`` translate them into parameters of a plant, ``picture`` draws both curves.
"""
