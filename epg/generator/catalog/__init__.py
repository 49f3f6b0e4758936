# SPDX-License-Identifier: Apache-2.0
"""The folders below ``targets/`` as data.  Each file is checked when it is read.

``catalog.py`` finds the items.  ``hardware.py`` (chips and boards), ``platform.py``, ``middleware.py`` and ``kind.py``
define their data; the ``check_*.py`` report mistakes in their files.
"""
