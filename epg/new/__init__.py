# SPDX-License-Identifier: Apache-2.0
"""The work of ``epg new``: the files of a new project."""
