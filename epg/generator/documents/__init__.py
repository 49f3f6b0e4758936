# SPDX-License-Identifier: Apache-2.0
"""Reads the files of users and of EPG: as trees and text with positions, checked against their schemas.

``text_file.py`` reads every text.  ``yaml_file.py`` makes trees of :class:`~epg.generator.source.YamlNode`,
``schema.py`` checks them against a JSON Schema, and ``tcf.py`` follows ``extends``.  This package does not know what
the keys mean.
"""
