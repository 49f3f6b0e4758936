# SPDX-License-Identifier: Apache-2.0
"""Makes CycloneDDS for Python importable: EPG installs it into its cache, as for ``epg record``.

A test module asks for it by ``pytest.importorskip("tests.ros2.packages", exc_type=ImportError)`` before its imports.
"""

from epg.generator import bootstrap

try:
    bootstrap.ensure("ros")
except bootstrap.MissingPackages:
    raise ImportError("CycloneDDS for Python is not installed: pip install cyclonedds") from None
