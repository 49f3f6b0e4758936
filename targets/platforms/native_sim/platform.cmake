# SPDX-License-Identifier: Apache-2.0
# Zephyr as a program on this computer: built like the platform zephyr, with the simulated plant.

include("${CMAKE_CURRENT_LIST_DIR}/../zephyr/zephyr.cmake")

# A macro, not a function: the variables it sets must reach the scope that calls epg_add_target(), where Zephyr reads
# them.
macro(_epg_native_sim_before_build)
  _epg_zephyr_prepare(${ARGV})
  _epg_zephyr_hand_on()
endmacro()

# Called when Zephyr has loaded EPG's module: adds the generated sources, the port layer and the plant of target <name>.
function(_epg_native_sim_target name)
  _epg_zephyr_port_layer("${name}")
  target_include_directories("epg_zephyr_${name}" PRIVATE
    "${EPG_TARGETS_DIR}/platforms/host/include" "${EPG_TARGETS_DIR}/platforms/native_sim/include"
    ${EPG_COMPONENT_INCLUDES}) # the generated functions that connect components and plant include the components' headers
endfunction()

# Called by epg_add_executable(): adds EPG's main() to Zephyr's application.
macro(_epg_native_sim_executable)
  _epg_zephyr_application(${ARGV})
endmacro()
