# SPDX-License-Identifier: Apache-2.0
"""``python -m epg``, and ``python <folder>/epg/__main__.py``, which works where PYTHONPATH is ignored."""

import sys

if sys.version_info < (3, 10):
    sys.exit("EPG needs Python 3.10 or newer; this is %d.%d: %s" % (*sys.version_info[:2], sys.executable))

if not __package__:  # started by its path: the package's parent takes the place of the package's own folder
    from os.path import abspath, dirname

    sys.path[0] = dirname(dirname(abspath(__file__)))

from epg.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
