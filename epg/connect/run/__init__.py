# SPDX-License-Identifier: Apache-2.0
"""What ``epg connect`` does with a target after a build: simulates it, runs it, or flashes it."""
