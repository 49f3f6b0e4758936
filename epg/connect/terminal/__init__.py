# SPDX-License-Identifier: Apache-2.0
"""``epg connect --terminal``: the functions of the page as questions and answers in lines of text."""
