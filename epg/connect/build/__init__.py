# SPDX-License-Identifier: Apache-2.0
"""Builds that somebody watches: what is run, what it says and what it makes."""
