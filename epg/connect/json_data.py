# SPDX-License-Identifier: Apache-2.0
"""The types of what the session gives to the page and to the terminal, as JSON."""

from __future__ import annotations

from typing import Any

Data = dict[str, Any]
"""A part of the session's state: keys in lower case, values that JSON has."""
State = Data
"""The whole state of a session."""
