# SPDX-License-Identifier: Apache-2.0 FreeRTOS: the control side runs in the interrupt of a timer, which the kernel
# never masks; the communication side in a task.

include("${CMAKE_CURRENT_LIST_DIR}/../mcu/mcu.cmake")

# Called by epg_add_target(): adds the kernel and the port layer to target <name>.
function(_epg_freertos_target name)
  _epg_mcu_check("${name}" good)
  if(good)
    _epg_freertos_kernel("${name}" good)
  endif()
  if(good)
    _epg_mcu_target("${name}"
      SERVICE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/service.c" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/hooks.c"
      LIBRARIES FreeRTOS-Kernel-Static)
  endif()
endfunction()

# Called by epg_add_executable(): adds an executable that contains target <name> and nothing else.
function(_epg_freertos_executable executable name)
  _epg_mcu_executable("${executable}" "${name}" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/main.c")
endfunction()

# Adds the CMake targets of the FreeRTOS kernel with EPG's FreeRTOSConfig.h, unless the project has its own.  Reports an
# error and sets <result> to FALSE if the kernel is not found.
function(_epg_freertos_kernel name result)
  set(${result} TRUE PARENT_SCOPE)
  if(TARGET FreeRTOS-Kernel-Static)
    return()
  endif()
  _epg_find_sdk(FREERTOS_KERNEL_PATH freertos_kernel)
  set(problem "${FREERTOS_KERNEL_PATH_PROBLEM}")
  cmake_language(CALL _epg_${EPG_FAMILY}_freertos_port port submodule)
  if(FREERTOS_KERNEL_PATH AND NOT EXISTS "${FREERTOS_KERNEL_PATH}/${port}/library.cmake")
    set(problem "The FreeRTOS kernel in ${FREERTOS_KERNEL_PATH} has no port for this chip: there is no ${port}. Get it:\n  git -C \"${FREERTOS_KERNEL_PATH}\" submodule update --init ${submodule}")
  endif()
  if(problem)
    message(SEND_ERROR "epg_add_target(${name}): ${problem}")
    set_property(TARGET ${name} PROPERTY EPG_FAILED TRUE)
    set(${result} FALSE PARENT_SCOPE)
    return()
  endif()
  cmake_path(GET EPG_FAMILY_CMAKE PARENT_PATH family)
  set(FREERTOS_CONFIG_FILE_DIRECTORY "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/include" "${family}/freertos/include")
  include("${FREERTOS_KERNEL_PATH}/${port}/library.cmake")
endfunction()
