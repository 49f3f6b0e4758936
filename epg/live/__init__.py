# SPDX-License-Identifier: Apache-2.0
"""The connection of a program to a running target, over the port of its console.

``frames`` has the form of the messages, ``port`` opens serial ports and the terminals of host programs, ``client`` asks
and commands a target.  ``docs/live.md`` defines the protocol.
"""
