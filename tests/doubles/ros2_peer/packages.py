# SPDX-License-Identifier: Apache-2.0
"""Makes CycloneDDS for Python importable: EPG installs it into its cache, as for ``epg record``.

A test module asks for it before its imports:
``pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)``.
"""

from epg.generator import bootstrap

try:
    bootstrap.ensure("ros")
except bootstrap.MissingPackages:
    raise ImportError("CycloneDDS for Python is not installed: pip install cyclonedds") from None
