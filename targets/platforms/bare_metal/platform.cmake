# SPDX-License-Identifier: Apache-2.0 Bare metal: the control side runs in the interrupt of a timer, the communication
# side in an interrupt of the lowest priority.

include("${CMAKE_CURRENT_LIST_DIR}/../../mcu/mcu.cmake")

# Called by epg_add_target(): adds the port layer to target <name>.
function(_epg_bare_metal_target name)
  _epg_mcu_check("${name}" good)
  if(good)
    _epg_mcu_target("${name}" SERVICE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/service.c")
  endif()
endfunction()

# Called by epg_add_executable(): adds an executable that contains target <name> and nothing else.
function(_epg_bare_metal_executable executable name)
  _epg_mcu_executable("${executable}" "${name}" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/main.c")
endfunction()
