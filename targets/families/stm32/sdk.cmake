# SPDX-License-Identifier: Apache-2.0
# Finds the compiler and the headers for STM32.  EPG's CMake package loads this file.
#
# epg_import_stm32()
#
# Chooses the Arm toolchain with the options for the Cortex-M7, unless the project has a toolchain file, such as the one
# that STM32CubeMX writes.  It must be called before project().  After it: project(... C).
#
# If a part is missing, it stops with an error that names all missing parts of the project.

set(_epg_stm32_folder "${CMAKE_CURRENT_LIST_DIR}")

macro(epg_import_stm32)
  if(NOT CMAKE_TOOLCHAIN_FILE)
    _epg_find_sdk(_epg_toolchain arm_gcc)
    if(_epg_toolchain_PROBLEM)
      _epg_stop_without_parts(arm_gcc)
    endif()
    if(_epg_toolchain)
      set(EPG_STM32_TOOLCHAIN "${_epg_toolchain}" CACHE PATH "Folder of the Arm toolchain")
    endif()
    set(CMAKE_TOOLCHAIN_FILE "${_epg_stm32_folder}/toolchain.cmake" CACHE FILEPATH "Toolchain file")
  endif()
endmacro()
