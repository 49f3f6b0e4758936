# SPDX-License-Identifier: Apache-2.0
"""Builds of ``epg connect``: the commands, their messages and their products."""
