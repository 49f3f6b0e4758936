# SPDX-License-Identifier: Apache-2.0
"""The folders below ``targets/`` as data.  Each file is checked when it is read."""
