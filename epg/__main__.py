# SPDX-License-Identifier: Apache-2.0
"""Starts EPG: ``python -m epg``, or ``python <folder>/epg/__main__.py`` where Python ignores PYTHONPATH."""

import sys

if sys.version_info < (3, 10):
    sys.exit("EPG needs Python 3.10 or newer; this is %d.%d: %s" % (*sys.version_info[:2], sys.executable))

if not __package__:  # Started by its path: Python has put the package's folder into sys.path, not the folder above it.
    from os.path import abspath, dirname

    package = dirname(abspath(__file__))
    if sys.path and abspath(sys.path[0]) == package:  # Not with -P, and not if a file `._pth` states the path.
        del sys.path[0]
    sys.path.insert(0, dirname(package))

from epg.cli.main import main_and_exit

if __name__ == "__main__":
    main_and_exit()
