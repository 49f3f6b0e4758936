# SPDX-License-Identifier: Apache-2.0
"""CMake's files read without running CMake: as far as that can be known."""
