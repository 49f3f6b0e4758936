# SPDX-License-Identifier: Apache-2.0
# Bare metal on the Raspberry Pi Pico: core 1 controls, core 0 communicates in an interrupt of lowest priority.

include("${CMAKE_CURRENT_LIST_DIR}/../../families/rp2/family.cmake")

function(_epg_bare_metal_target name)
  _epg_pico_target("${name}" SERVICE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/service.c")
endfunction()

function(_epg_bare_metal_executable executable name)
  _epg_pico_executable("${executable}" "${name}" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/main.c")
endfunction()
