# SPDX-License-Identifier: Apache-2.0
# Is installed as share/EPG/cmake/EPGConfig.cmake, where find_package() searches.  It includes the real file, which is
# part of the Python package; each Python has another folder for that.
get_filename_component(_epg_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
file(GLOB _epg_configs
  "${_epg_prefix}/lib/python*/*-packages/epg/_data/cmake/EPGConfig.cmake"
  "${_epg_prefix}/local/lib/python*/*-packages/epg/_data/cmake/EPGConfig.cmake"
  "${_epg_prefix}/[Ll]ib/*-packages/epg/_data/cmake/EPGConfig.cmake")
if(_epg_configs)
  list(SORT _epg_configs COMPARE NATURAL ORDER DESCENDING) # if several Pythons share this prefix, take the newest
  list(GET _epg_configs 0 _epg_config)
  include("${_epg_config}")
else()
  set(EPG_FOUND FALSE)
  set(EPG_NOT_FOUND_MESSAGE
    "the Python package 'epg' is not below ${_epg_prefix}; set EPG_DIR to the output of 'python -m epg --cmake-dir'")
endif()
