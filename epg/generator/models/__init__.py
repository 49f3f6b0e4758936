# SPDX-License-Identifier: Apache-2.0
"""Models in the same form for all formats, and the readers of C sources that several importers use."""
