# SPDX-License-Identifier: Apache-2.0
# Zephyr: epg_add_target() comes before find_package(Zephyr), which chooses the compiler and makes everything.

include("${CMAKE_CURRENT_LIST_DIR}/zephyr.cmake")

# A macro, so that what it sets gets where epg_add_target() was called, and Zephyr will look.
macro(_epg_zephyr_before_build)
  _epg_zephyr_prepare(${ARGV})
  _epg_zephyr_hand_on()
endmacro()

macro(_epg_zephyr_target)
  _epg_zephyr_port_layer(${ARGV})
endmacro()

macro(_epg_zephyr_executable)
  _epg_zephyr_application(${ARGV})
endmacro()
