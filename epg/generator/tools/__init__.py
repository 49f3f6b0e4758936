# SPDX-License-Identifier: Apache-2.0
"""Finds the SDKs and programs on this computer, as ``targets/tools`` describes them.

``cmake/EPGSdk.cmake`` reads the same descriptions for CMake.
"""
