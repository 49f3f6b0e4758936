# Bare metal on the Raspberry Pi Pico: core 1 controls, core 0 communicates in an interrupt of lowest priority.

include("${CMAKE_CURRENT_LIST_DIR}/../pico/pico.cmake")
set(_epg_bare_metal_folder "${CMAKE_CURRENT_LIST_DIR}")

function(_epg_bare_metal_target name)
  _epg_pico_target("${name}" SERVICE "${_epg_bare_metal_folder}/src/service.c")
endfunction()

function(_epg_bare_metal_executable executable name)
  _epg_pico_executable("${executable}" "${name}" "${_epg_bare_metal_folder}/src/main.c")
endfunction()
