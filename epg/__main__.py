# SPDX-License-Identifier: Apache-2.0
"""Starts EPG: ``python -m epg``, or ``python <folder>/epg/__main__.py`` where Python ignores PYTHONPATH."""

import sys

if sys.version_info < (3, 10):
    sys.exit("EPG needs Python 3.10 or newer; this is %d.%d: %s" % (*sys.version_info[:2], sys.executable))

if not __package__:  # Started by its path: Python has put the package's folder into sys.path, not the folder above it.
    from os.path import abspath, dirname

    sys.path[0] = dirname(dirname(abspath(__file__)))

from epg.cli.main import main_and_exit

if __name__ == "__main__":
    main_and_exit()
