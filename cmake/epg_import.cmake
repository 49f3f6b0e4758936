# Copy this file into your repository and include it before the first epg_ function:
#
#   include(epg_import.cmake)
#
# It finds EPG, in this order: EPG_DIR (variable or environment: the folder of EPGConfig.cmake), EPG_PATH (variable or
# environment: a checkout), an installed Python package (the one of Python3_EXECUTABLE, else of python3 or python on
# the PATH), CMake's own search.  It works before and after project(), and under toolchain files that confine
# find_package() to a sysroot, as the Pico SDK's does.

if(NOT EPG_DIR AND DEFINED ENV{EPG_DIR})
  set(EPG_DIR "$ENV{EPG_DIR}")
endif()
if(NOT EPG_DIR)
  foreach(_epg_path "${EPG_PATH}" "$ENV{EPG_PATH}")
    if(_epg_path AND EXISTS "${_epg_path}/cmake/EPGConfig.cmake")
      get_filename_component(EPG_DIR "${_epg_path}/cmake" ABSOLUTE BASE_DIR "${CMAKE_SOURCE_DIR}")
      break()
    endif()
  endforeach()
endif()
if(NOT EPG_DIR)
  foreach(_epg_python "${Python3_EXECUTABLE}" "${Python_EXECUTABLE}" python3 python)
    if(_epg_python)
      execute_process(COMMAND "${_epg_python}" -m epg --cmake-dir
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
  message(FATAL_ERROR "EPG was not found.\n"
    "Install it (pip install epg), or name a checkout: cmake -DEPG_PATH=<folder> ... ${EPG_NOT_FOUND_MESSAGE}")
endif()
