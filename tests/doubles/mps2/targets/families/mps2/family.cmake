# SPDX-License-Identifier: Apache-2.0
# Arm's MPS2 boards, with Arm's headers of the core.

function(_epg_mps2_check name result)
  _epg_find_sdk(core cmsis_core)
  if(core)
    set(${result} TRUE PARENT_SCOPE)
  else()
    message(SEND_ERROR "epg_add_target(${name}): ${core_PROBLEM}")
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

function(_epg_mps2_library library)
  include("${EPG_TARGETS_DIR}/mcu/one_core/one_core.cmake")
  _epg_one_core_library(${library})
  _epg_find_sdk(core cmsis_core)
  target_include_directories(${library} SYSTEM INTERFACE "${core}/CMSIS/Core/Include")
endfunction()

function(_epg_mps2_target name)
  _epg_one_core_target(${name})
  set(folder "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/start")
  target_sources(${name}_port INTERFACE "${folder}/start.c")
  target_link_options(${name}_port INTERFACE -nostartfiles "-T${folder}/mps2.ld")
endfunction()

function(_epg_mps2_executable executable name)
endfunction()

function(_epg_mps2_freertos_port port submodule)
  set(${submodule} "" PARENT_SCOPE)
  if(CMAKE_C_FLAGS MATCHES "cortex-m7")
    set(${port} "portable/GCC/ARM_CM7/r0p1" PARENT_SCOPE)
  else()
    set(${port} "portable/GCC/ARM_CM4F" PARENT_SCOPE)
  endif()
endfunction()
