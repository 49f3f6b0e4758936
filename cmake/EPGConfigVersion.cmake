# SPDX-License-Identifier: Apache-2.0
# The version is read from the Python package, so that it is written in one place only.
get_filename_component(_epg_above "${CMAKE_CURRENT_LIST_DIR}/.." ABSOLUTE)
set(_epg_init "${_epg_above}/epg/__init__.py")
if(NOT EXISTS "${_epg_init}")
  set(_epg_init "${_epg_above}/../__init__.py")
endif()
file(STRINGS "${_epg_init}" PACKAGE_VERSION REGEX "^__version__")
string(REGEX REPLACE ".*\"(.*)\".*" "\\1" PACKAGE_VERSION "${PACKAGE_VERSION}")
include("${CMAKE_CURRENT_LIST_DIR}/EPGCompatible.cmake")
