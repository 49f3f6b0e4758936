# SPDX-License-Identifier: Apache-2.0
"""Systems: several targets, and the connections between their ports.

The targets stay independent: the files of one target do not change the generated sources of another one.
"""

SYSTEM_FILES = ".system.yaml"
"""The end of the names of files that describe a system."""
