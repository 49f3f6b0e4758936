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

# Adds the CMake target FreeRTOS-Kernel-Static: the FreeRTOS kernel with EPG's FreeRTOSConfig.h, unless the project has
# this target, or that of the kernel's own CMakeLists.txt, freertos_kernel.  Reports an error and sets <result> to FALSE
# if the kernel is not found.
function(_epg_freertos_kernel name result)
  set(${result} TRUE PARENT_SCOPE)
  if(NOT TARGET FreeRTOS-Kernel-Static AND TARGET freertos_kernel)
    add_library(FreeRTOS-Kernel-Static INTERFACE)
    target_link_libraries(FreeRTOS-Kernel-Static INTERFACE freertos_kernel)
  endif()
  if(TARGET FreeRTOS-Kernel-Static)
    return()
  endif()
  _epg_find_sdk(FREERTOS_KERNEL_PATH freertos_kernel)
  set(problem "${FREERTOS_KERNEL_PATH_PROBLEM}")
  cmake_language(CALL _epg_${EPG_FAMILY}_freertos_port port submodule)
  set(folder "${FREERTOS_KERNEL_PATH}/${port}")
  if(FREERTOS_KERNEL_PATH AND NOT EXISTS "${folder}/library.cmake" AND NOT EXISTS "${folder}/port.c")
    set(problem "The FreeRTOS kernel in ${FREERTOS_KERNEL_PATH} has no port for this chip: there is no ${port}.")
    if(submodule)
      string(APPEND problem " Get it:\n  git -C \"${FREERTOS_KERNEL_PATH}\" submodule update --init ${submodule}")
    endif()
  endif()
  if(problem)
    message(SEND_ERROR "epg_add_target(${name}): ${problem}")
    set_property(TARGET ${name} PROPERTY EPG_FAILED TRUE)
    set(${result} FALSE PARENT_SCOPE)
    return()
  endif()
  cmake_path(GET EPG_FAMILY_CMAKE PARENT_PATH family)
  set(FREERTOS_CONFIG_FILE_DIRECTORY "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/include" "${family}/freertos/include")
  if(EXISTS "${folder}/library.cmake")
    include("${folder}/library.cmake")
  else()
    _epg_freertos_library("${FREERTOS_KERNEL_PATH}" "${folder}" "${FREERTOS_CONFIG_FILE_DIRECTORY}")
  endif()
endfunction()

# Adds FreeRTOS-Kernel-Static for a port that has no library.cmake.  <config> lists the folders of FreeRTOSConfig.h and
# of the headers that it includes.
function(_epg_freertos_library kernel port config)
  set(sources croutine event_groups list queue stream_buffer tasks timers)
  list(TRANSFORM sources REPLACE "(.+)" "${kernel}/\\1.c")
  add_library(FreeRTOS-Kernel-Static STATIC EXCLUDE_FROM_ALL ${sources} "${port}/port.c")
  target_include_directories(FreeRTOS-Kernel-Static SYSTEM PUBLIC ${config} "${kernel}/include" "${port}")
  target_compile_options(FreeRTOS-Kernel-Static PRIVATE -w -ffunction-sections -fdata-sections) # the kernel's own style
endfunction()
