# SPDX-License-Identifier: Apache-2.0
# The build of a wheel writes the version below.
set(PACKAGE_VERSION "@VERSION@")
include("${CMAKE_CURRENT_LIST_DIR}/EPGCompatible.cmake")
