# SPDX-License-Identifier: Apache-2.0
# Copy this file into your repository and include it before the first epg_ function:
#
#   include(epg_import.cmake)
#
# It searches EPG in this order:
#   1. EPG_PATH, a variable of CMake or of the environment: a checkout of EPG;
#   2. EPG_DIR, a variable of CMake or of the environment: the folder of EPGConfig.cmake;
#   3. the modules of Zephyr that ZEPHYR_MODULES, EXTRA_ZEPHYR_MODULES or ZEPHYR_EXTRA_MODULES name;
#   4. the project epg of the west workspace, if west configures;
#   5. an installed Python package: that of Python3_EXECUTABLE, else of python3 or python on the PATH, else of py of
#      Windows, else of the program epg;
#   6. CMake's own search.
#
# It works before and after project().  It also works with a toolchain file that confines find_package() to a sysroot, as
# those of microcontrollers do.  The place of EPG is kept in CMake's cache.

if(COMMAND epg_add_target) # a project around this one has found EPG already
  return()
endif()

# Zephyr's sysbuild passes the variables of its command line to its images in a file.
if(SYSBUILD AND EXISTS "${SYSBUILD_CACHE}")
  file(STRINGS "${SYSBUILD_CACHE}" _epg_lines ENCODING UTF-8
    REGEX "^(EPG_PATH|EPG_DIR|WEST_PYTHON|Python3_EXECUTABLE|ZEPHYR_MODULES|EXTRA_ZEPHYR_MODULES|ZEPHYR_EXTRA_MODULES):")
  foreach(_epg_line IN LISTS _epg_lines)
    if(_epg_line MATCHES "^([^:]+):[^=]*=(.+)$")
      set(${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
    endif()
  endforeach()
endif()

# An EPG_PATH or EPG_DIR that is set now comes before the result of an earlier run.
if(EPG_DIR AND EPG_DIR STREQUAL EPG_IMPORTED_DIR)
  unset(EPG_DIR CACHE)
endif()
foreach(_epg_path "${EPG_PATH}" "$ENV{EPG_PATH}")
  if(_epg_path)
    get_filename_component(_epg_path "${_epg_path}" ABSOLUTE BASE_DIR "${CMAKE_SOURCE_DIR}")
    if(NOT EXISTS "${_epg_path}/cmake/EPGConfig.cmake")
      message(FATAL_ERROR "EPG_PATH is not a checkout of EPG: there is no ${_epg_path}/cmake/EPGConfig.cmake")
    endif()
    set(EPG_DIR "${_epg_path}/cmake")
    break()
  endif()
endforeach()
if(NOT EPG_DIR AND DEFINED ENV{EPG_DIR})
  file(TO_CMAKE_PATH "$ENV{EPG_DIR}" EPG_DIR)
endif()
if(EPG_DIR)
  get_filename_component(EPG_DIR "${EPG_DIR}" ABSOLUTE BASE_DIR "${CMAKE_SOURCE_DIR}")
  if(NOT EXISTS "${EPG_DIR}/EPGConfig.cmake")
    message(FATAL_ERROR "EPG_DIR is not the folder of EPGConfig.cmake, which 'python -m epg --cmake-dir' prints: ${EPG_DIR}")
  endif()
endif()
if(NOT EPG_DIR AND EPG_IMPORTED_DIR AND EXISTS "${EPG_IMPORTED_DIR}/EPGConfig.cmake")
  set(EPG_DIR "${EPG_IMPORTED_DIR}")
endif()
if(NOT EPG_DIR)
  foreach(_epg_variable ZEPHYR_MODULES EXTRA_ZEPHYR_MODULES ZEPHYR_EXTRA_MODULES)
    foreach(_epg_folder IN LISTS ${_epg_variable} ITEMS $ENV{${_epg_variable}})
      if(NOT EPG_DIR AND EXISTS "${_epg_folder}/cmake/EPGConfig.cmake")
        set(EPG_DIR "${_epg_folder}/cmake")
      endif()
    endforeach()
  endforeach()
endif()
if(NOT EPG_DIR AND WEST_PYTHON)
  execute_process(COMMAND "${WEST_PYTHON}" -m west list -f "{abspath}" epg WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
    OUTPUT_VARIABLE _epg_folder OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE _epg_status)
  if(_epg_status STREQUAL "0" AND EXISTS "${_epg_folder}/cmake/EPGConfig.cmake")
    file(TO_CMAKE_PATH "${_epg_folder}/cmake" EPG_DIR)
  endif()
endif()
if(NOT EPG_DIR)
  foreach(_epg_command "${Python3_EXECUTABLE};-m;epg" "${Python_EXECUTABLE};-m;epg" "python3;-m;epg" "python;-m;epg" "py;-m;epg" epg)
    if(NOT _epg_command MATCHES "^;")
      execute_process(COMMAND ${_epg_command} --cmake-dir
        OUTPUT_VARIABLE _epg_folder OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE _epg_status)
      if(_epg_status STREQUAL "0" AND EXISTS "${_epg_folder}/EPGConfig.cmake")
        set(EPG_DIR "${_epg_folder}")
        break()
      endif()
    endif()
  endforeach()
endif()
find_package(EPG CONFIG QUIET NO_CMAKE_FIND_ROOT_PATH)
if(NOT EPG_FOUND)
  set(_epg_activate ". ~/epg-environment/bin/activate")
  set(_epg_install "python3 -m venv ~/epg-environment && . ~/epg-environment/bin/activate && pip install <folder of EPG>")
  if(CMAKE_HOST_WIN32)
    set(_epg_activate "%USERPROFILE%\\epg-environment\\Scripts\\activate")
    set(_epg_install "py -m pip install <folder of EPG>")
  endif()
  message(FATAL_ERROR "EPG was not found. ${EPG_NOT_FOUND_MESSAGE}\n"
    "If it is installed in a virtual environment, activate that first:\n  ${_epg_activate}\n"
    "Else install it from its folder (a checkout; EPG is not on PyPI):\n"
    "  ${_epg_install}\n"
    "or name the folder:\n  cmake -DEPG_PATH=<folder of EPG> ...")
endif()
set(EPG_IMPORTED_DIR "${EPG_DIR}" CACHE INTERNAL "The EPG that epg_import.cmake has found")
