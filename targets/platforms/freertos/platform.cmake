# SPDX-License-Identifier: Apache-2.0
# FreeRTOS on the Raspberry Pi Pico: core 1 controls, bare; the kernel runs on core 0, where communication is a task.

include("${CMAKE_CURRENT_LIST_DIR}/../../families/rp2/family.cmake")

function(_epg_freertos_target name)
  if(TARGET pico_runtime)
    _epg_freertos_kernel("${name}" good)
    if(NOT good)
      set_property(TARGET ${name} PROPERTY EPG_FAILED TRUE)
      return()
    endif()
  endif()
  _epg_pico_target("${name}"
    SERVICE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/service.c" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/hooks.c"
    LIBRARIES FreeRTOS-Kernel-Static)
endfunction()

function(_epg_freertos_executable executable name)
  _epg_pico_executable("${executable}" "${name}" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/main.c")
endfunction()

# The kernel's own CMake targets: the project's, or made here with EPG's FreeRTOSConfig.h.
function(_epg_freertos_kernel name result)
  set(${result} TRUE PARENT_SCOPE)
  if(TARGET FreeRTOS-Kernel-Static)
    return()
  endif()
  _epg_find_sdk(FREERTOS_KERNEL_PATH freertos_kernel)
  set(port "portable/ThirdParty/GCC/RP2040")
  set(problem "${FREERTOS_KERNEL_PATH_PROBLEM}")
  if(NOT PICO_RP2040)
    set(port "portable/ThirdParty/Community-Supported-Ports/GCC/RP2350_ARM_NTZ")
  endif()
  if(FREERTOS_KERNEL_PATH AND NOT EXISTS "${FREERTOS_KERNEL_PATH}/${port}/library.cmake")
    set(problem "The FreeRTOS kernel in ${FREERTOS_KERNEL_PATH} has no port for this chip: there is no ${port}. Get it:\n  git -C \"${FREERTOS_KERNEL_PATH}\" submodule update --init portable/ThirdParty/Community-Supported-Ports")
  endif()
  if(problem)
    message(SEND_ERROR "epg_add_target(${name}): ${problem}")
    set(${result} FALSE PARENT_SCOPE)
    return()
  endif()
  set(FREERTOS_CONFIG_FILE_DIRECTORY "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/include")
  include("${FREERTOS_KERNEL_PATH}/${port}/library.cmake")
endfunction()
