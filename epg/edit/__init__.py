# SPDX-License-Identifier: Apache-2.0
"""Edits of files that people write: one value changes, everything else stays as it was written."""
