# SPDX-License-Identifier: Apache-2.0
# Finds the Raspberry Pi Pico SDK.  EPG's CMake package loads this file.
#
# epg_import_pico_sdk()
#
# Finds the Pico SDK, the Arm toolchain and picotool, and includes the SDK.  It must be called before project(), in
# place of the SDK's pico_sdk_import.cmake, and does not need PICO_SDK_PATH.  After it, as always with the Pico SDK:
# project(... C CXX ASM) and pico_sdk_init().  It is a macro, because the SDK's file sets variables in the caller.
#
# If a part is missing, it stops with an error that names all missing parts of the project.

macro(epg_import_pico_sdk)
  set(_epg_toolchain "")
  set(_epg_toolchain_PROBLEM "")
  if(NOT PICO_TOOLCHAIN_PATH AND "$ENV{PICO_TOOLCHAIN_PATH}" STREQUAL "") # the SDK itself checks what this names
    _epg_find_sdk(_epg_toolchain arm_gcc)
  endif()
  _epg_find_sdk(_epg_sdk pico_sdk)
  if(_epg_toolchain_PROBLEM OR _epg_sdk_PROBLEM)
    set(_epg_parts arm_gcc pico_sdk)
    if(NOT picotool_DIR AND NOT PICO_NO_PICOTOOL)
      list(APPEND _epg_parts picotool)
    endif()
    _epg_stop_without_parts(${_epg_parts})
  endif()
  _epg_find_picotool()
  if(_epg_toolchain)
    set(PICO_TOOLCHAIN_PATH "${_epg_toolchain}" CACHE PATH "Folder of the Arm toolchain")
  endif()
  set(PICO_SDK_PATH "${_epg_sdk}" CACHE PATH "Folder of the Pico SDK")
  include("${_epg_sdk}/pico_sdk_init.cmake")
endmacro()

# _epg_find_picotool()
#
# Sets picotool_DIR to the folder of an installed picotool.  Without one, the SDK downloads and builds picotool, which
# needs the network.  Stops with an error if FETCHCONTENT_FULLY_DISCONNECTED forbids that.
macro(_epg_find_picotool)
  if(NOT picotool_DIR AND NOT PICO_NO_PICOTOOL AND NOT TARGET picotool)
    _epg_find_sdk(_epg_picotool picotool)
    if(_epg_picotool)
      set(picotool_DIR "${_epg_picotool}" CACHE PATH "Folder of picotoolConfig.cmake")
    elseif(FETCHCONTENT_FULLY_DISCONNECTED)
      message(FATAL_ERROR "${_epg_picotool_PROBLEM}\nOr configure with -DPICO_NO_PICOTOOL=1: then the build makes no .uf2, only .elf, .hex and .bin.")
    endif()
  endif()
endmacro()
