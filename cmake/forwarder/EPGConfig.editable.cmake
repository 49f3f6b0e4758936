# SPDX-License-Identifier: Apache-2.0
# Includes the package from the checkout of an editable installation.  The installation writes the path below.
set(_epg_config [==[@CHECKOUT@/cmake/EPGConfig.cmake]==])
if(EXISTS "${_epg_config}")
  include("${_epg_config}")
else()
  set(EPG_FOUND FALSE)
  set(EPG_NOT_FOUND_MESSAGE "the checkout of an editable installation was moved or deleted: there is no ${_epg_config}")
endif()
