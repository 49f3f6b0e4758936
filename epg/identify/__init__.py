# SPDX-License-Identifier: Apache-2.0
"""Finds a motor's gain, time constant and friction in a recording, and the plant's parameters that follow from them.

``samples`` takes the usable part of a recording, ``motor`` simulates a motor of first order, ``fit`` finds its values,
``judge`` refuses recordings that do not determine them, ``plant`` translates them into parameters of a plant by the
formulas of its bindings, ``picture`` draws both curves.
"""
