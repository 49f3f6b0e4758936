# SPDX-License-Identifier: Apache-2.0
"""``epg connect --terminal``: the page's questions as lines of text."""
