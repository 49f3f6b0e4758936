# SPDX-License-Identifier: Apache-2.0
"""Reads the files of users and of EPG: as trees and text with positions, checked against their schemas."""
