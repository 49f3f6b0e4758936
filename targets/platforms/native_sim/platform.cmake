# SPDX-License-Identifier: Apache-2.0
# Zephyr as a program of this computer: as on boards.

include("${CMAKE_CURRENT_LIST_DIR}/../zephyr/zephyr.cmake")

# A macro, so that what it sets gets where epg_add_target() was called, and Zephyr will look.
macro(_epg_native_sim_before_build)
  _epg_zephyr_prepare(${ARGV})
  _epg_zephyr_hand_on()
endmacro()

function(_epg_native_sim_target name)
  _epg_zephyr_port_layer("${name}")
  target_include_directories("epg_zephyr_${name}" PRIVATE
    "${EPG_TARGETS_DIR}/platforms/host/include" "${EPG_TARGETS_DIR}/platforms/native_sim/include"
    ${EPG_COMPONENT_INCLUDES}) # what connects the components to the plant
endfunction()

macro(_epg_native_sim_executable)
  _epg_zephyr_application(${ARGV})
endmacro()
