# SPDX-License-Identifier: Apache-2.0
"""The folders below ``targets/`` as data, checked when they are read."""
