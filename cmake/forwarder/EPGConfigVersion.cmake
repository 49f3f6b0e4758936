# SPDX-License-Identifier: Apache-2.0
# Written when the wheel is built.
set(PACKAGE_VERSION "@VERSION@")
include("${CMAKE_CURRENT_LIST_DIR}/EPGCompatible.cmake")
