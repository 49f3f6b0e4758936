# SPDX-License-Identifier: Apache-2.0
# Functions for families of chips with one Cortex-M3, M4 or M7 core; include/epg/one_core.h is what they implement.
#
#   include("${EPG_TARGETS_DIR}/mcu/one_core/one_core.cmake")

# Called by _epg_<family>_library(): adds the sources and headers to the port layer <library>.
function(_epg_one_core_library library)
  file(GLOB sources "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/*.c")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src")
  target_sources(${library} INTERFACE ${sources})
  target_include_directories(${library} INTERFACE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/include")
endfunction()

# Called by _epg_<family>_target(): adds the sources for the platform of target <name>.
function(_epg_one_core_target name)
  file(GLOB sources "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${EPG_PLATFORM}/*.c")
  target_sources(${name}_port INTERFACE ${sources})
  target_include_directories(${name} PRIVATE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/include")
endfunction()
