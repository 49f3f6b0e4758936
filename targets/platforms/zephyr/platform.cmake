# SPDX-License-Identifier: Apache-2.0 Zephyr: epg_add_target() must come before find_package(Zephyr), which chooses the
# compiler and creates the CMake targets.

include("${CMAKE_CURRENT_LIST_DIR}/zephyr.cmake")

# A macro, not a function: the variables it sets must reach the scope that calls epg_add_target(), where Zephyr reads
# them.
macro(_epg_zephyr_before_build)
  _epg_zephyr_prepare(${ARGV})
  _epg_zephyr_hand_on()
endmacro()

# Called when Zephyr has loaded EPG's module: adds the generated source and the port layer of a target.
macro(_epg_zephyr_target)
  _epg_zephyr_port_layer(${ARGV})
endmacro()

# Called by epg_add_executable(): adds EPG's main() to Zephyr's application.
macro(_epg_zephyr_executable)
  _epg_zephyr_application(${ARGV})
endmacro()
