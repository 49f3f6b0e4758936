# SPDX-License-Identifier: Apache-2.0
"""Edits of files that users write: one value changes, and all other text stays as it was written."""
