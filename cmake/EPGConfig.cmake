# SPDX-License-Identifier: Apache-2.0
# The CMake package EPG: makes a controller modelled in 20-sim a library and an executable of an ordinary CMake project.
#
#   epg_add_target(<name> TCF <file> MODEL <folder> BINDINGS <file> ...)   library EPG::<name>: model, tables, runtime
#   epg_add_executable(<executable> EPG::<name>)                           firmware with EPG's own main()
#   epg_add_model(<name> MODEL <folder> [INSTANCES <n>])                   library EPG::<name>: a model alone
#   epg_add_system(<name> SYSTEM <file> [TARGETS <target>...])             simulation and images of several targets
#   epg_use_versions(<SDK> <version> ...)                                  chooses the versions of the project's SDKs
#   epg_add_simulation(<name> EXECUTABLE <host executable> SCENARIO <file>) target that runs and judges a simulation
#
# The files targets/families/<family>/sdk.cmake define the functions that find the SDKs of families of chips.
#
# A project may find this package again in each of its directories.  The package therefore only defines functions and
# macros.  They make common libraries on first use, guarded by if(NOT TARGET).  docs/cmake.md describes the functions.

if(CMAKE_VERSION VERSION_LESS 3.22)
  set(EPG_FOUND FALSE)
  set(EPG_NOT_FOUND_MESSAGE "EPG needs CMake 3.22 or newer; this is ${CMAKE_VERSION}")
  return()
endif()

# The functions of a second EPG would replace some of the first one's, because CMake has one set for the whole build.
if(COMMAND _epg_data_folder)
  _epg_data_folder(_epg_first)
  get_filename_component(_epg_first "${_epg_first}/cmake" REALPATH)
  get_filename_component(_epg_second "${CMAKE_CURRENT_LIST_DIR}" REALPATH)
  if(NOT _epg_first STREQUAL _epg_second)
    set(_epg_text "EPG: two EPGs are used in one build.\n")
    foreach(_epg_folder "${_epg_first}" "${_epg_second}")
      include("${_epg_folder}/EPGConfigVersion.cmake")
      string(APPEND _epg_text "  ${PACKAGE_VERSION} in ${_epg_folder}\n")
    endforeach()
    message(FATAL_ERROR "${_epg_text}Let all projects of this build use the same one: remove one of them, or include(epg_import.cmake) in each project, which takes the EPG that is there already.")
  endif()
endif()

cmake_policy(PUSH)
cmake_policy(VERSION 3.22...3.31)
include("${CMAKE_CURRENT_LIST_DIR}/EPGPython.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGCompiler.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGSdk.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGMissing.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGFetch.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGVersions.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGGenerate.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGModel.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGConnect.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGTarget.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGSimulation.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/EPGSystem.cmake")
# Libraries, and what families of chips define for projects: functions that find an SDK before project().  The user's
# folders are loaded last, so a user's family may define a function of EPG's anew.
_epg_own_roots(_epg_own)
_epg_user_folders(_epg_roots)
foreach(_epg_root ${_epg_own} ${_epg_roots})
  file(GLOB _epg_files "${_epg_root}/libraries/*/library.cmake" "${_epg_root}/families/*/sdk.cmake")
  foreach(_epg_file IN LISTS _epg_files)
    include("${_epg_file}")
  endforeach()
endforeach()
_epg_check_compiler()
cmake_policy(POP)
