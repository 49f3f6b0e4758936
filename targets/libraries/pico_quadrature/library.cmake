# SPDX-License-Identifier: Apache-2.0
# EPG::pico_quadrature: quadrature encoders on the PIO of RP2040 and RP2350, for any project with the Pico SDK.
#
# Its headers are epg/pico_quadrature.h and epg/pico_quadrature_velocity.h; epg/pico_quadrature_program.h can be used
# without the SDK.  As the libraries of the SDK, it is an INTERFACE library: its sources are compiled with the settings
# of each executable.
if(NOT TARGET EPG::pico_quadrature)
  add_library(epg_pico_quadrature INTERFACE)
  add_library(EPG::pico_quadrature ALIAS epg_pico_quadrature)
  target_sources(epg_pico_quadrature INTERFACE
    "${CMAKE_CURRENT_LIST_DIR}/src/pico_quadrature.c"
    "${CMAKE_CURRENT_LIST_DIR}/src/pico_quadrature_velocity.c")
  target_include_directories(epg_pico_quadrature INTERFACE "${CMAKE_CURRENT_LIST_DIR}/include")
  target_link_libraries(epg_pico_quadrature INTERFACE hardware_clocks hardware_gpio hardware_pio pico_platform)
endif()
