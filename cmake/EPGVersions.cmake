# SPDX-License-Identifier: Apache-2.0
# epg_use_versions([EPG <version>] [PICO_SDK <version>] [ARM_GCC <version>] [PICOTOOL <version>]
#                  [FREERTOS_KERNEL <version>])
#
# Fixes the versions of a project's tools.  It must be called before the functions that find SDKs.  If several versions
# of a tool are installed, the given one is taken.  If another version would be taken, the configure run stops with an
# error.
#
#   EPG              version of EPG
#   PICO_SDK         version of the Raspberry Pi Pico SDK
#   ARM_GCC          version of the Arm toolchain in the folder where the Raspberry Pi Pico extension of VS Code
#                    installs it.  If that does not exist, a compiler on the PATH is taken, in any version.
#   PICOTOOL         version of picotool.  Another version is not an error: the SDK reports a picotool that it cannot
#                    use.
#   FREERTOS_KERNEL  version of the FreeRTOS kernel
#
# Versions are written as in the installers' names of folders: 14_2_Rel1, 2.2.0-a4.
# It is a macro, because it sets variables in the caller.

macro(epg_use_versions)
  cmake_parse_arguments(_epg_version "" "EPG;PICO_SDK;ARM_GCC;PICOTOOL;FREERTOS_KERNEL" "" ${ARGN})
  if(_epg_version_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "epg_use_versions: unknown argument: ${_epg_version_UNPARSED_ARGUMENTS}")
  endif()
  if(_epg_version_EPG)
    _epg_same_epg("${_epg_version_EPG}")
  endif()
  foreach(_epg_tool pico_sdk picotool freertos_kernel arm_gcc)
    string(TOUPPER "${_epg_tool}" _epg_keyword)
    if(_epg_version_${_epg_keyword})
      _epg_select_version(_epg_variable _epg_folder ${_epg_tool} "${_epg_version_${_epg_keyword}}")
      if(_epg_variable)
        set(${_epg_variable} "${_epg_folder}")
      endif()
    endif()
  endforeach()
endmacro()

# _epg_same_epg(<wanted>)
#
# Stops with an error if this EPG does not have the version <wanted>.
function(_epg_same_epg wanted)
  set(PACKAGE_FIND_VERSION "${wanted}")
  include("${CMAKE_CURRENT_FUNCTION_LIST_DIR}/EPGConfigVersion.cmake")
  if(NOT PACKAGE_VERSION VERSION_EQUAL wanted)
    message(FATAL_ERROR "This project is written for EPG ${wanted}, and the EPG in ${CMAKE_CURRENT_FUNCTION_LIST_DIR} is ${PACKAGE_VERSION}.
Install EPG ${wanted} from its folder (docs/installing.md), or name that folder: -DEPG_PATH=<folder of EPG>.
Or write ${PACKAGE_VERSION} in place of ${wanted} in CMakeLists.txt.")
  endif()
endfunction()

# _epg_select_version(<variable> <folder> <tool> <wanted>)
#
# Finds version <wanted> of a tool among the installed ones.  Stops with an error if a variable names another version,
# or if only other versions are installed.
#   <variable>  variable that is set to the name of the variable that selects the tool, such as PICO_SDK_PATH; to "" if
#               a variable names the tool already, or if nothing is installed
#   <folder>    variable that is set to the folder that this variable must get
#   <tool>      name of the tool
#   <wanted>    version
function(_epg_select_version variable folder tool wanted)
  set(${variable} "" PARENT_SCOPE)
  _epg_data_folder(data)
  file(READ "${data}/targets/tools/${tool}.json" json)
  _epg_json_list(variables "${json}" variables)
  list(GET variables 0 first)
  _epg_stated_folder(stated "${json}")
  if(stated)
    _epg_sdk_version(version "${json}" "${stated}")
    if(version AND NOT tool STREQUAL "picotool")
      _epg_check_version("${json}" "${stated}" "${version}" "${wanted}")
    endif()
    return()
  endif()

  set(others "")
  _epg_candidates(candidates ${tool} "${json}")
  foreach(candidate IN LISTS candidates)
    _epg_sdk_version(version "${json}" "${candidate}")
    _epg_is_version(same "${candidate}" "${version}" "${wanted}")
    if(same)
      set(${variable} "${first}" PARENT_SCOPE)
      set(${folder} "${candidate}" PARENT_SCOPE)
      return()
    endif()
    if(version)
      list(APPEND others "${candidate}" "${version}")
    endif()
  endforeach()
  if(others AND NOT tool STREQUAL "picotool")
    list(GET others 0 other)
    list(GET others 1 version)
    _epg_check_version("${json}" "${other}" "${version}" "${wanted}")
  endif()
  # If no version is found, the function that needs the tool reports it.
endfunction()

# _epg_stated_folder(<result> <json>)
#
# Sets <result> to the folder of a tool that a variable of CMake or of the environment names, or to "".  The VS Code
# extension's file names a folder even before the extension has installed the tool there: such a folder does not count.
#   <json>  the text of targets/tools/<name>.json
function(_epg_stated_folder result json)
  set(${result} "" PARENT_SCOPE)
  _epg_json_list(variables "${json}" variables)
  _epg_json_list(environment "${json}" environment)
  foreach(name IN LISTS variables)
    if(${name} AND (EXISTS "${${name}}" OR NOT "${${name}}" MATCHES "/\\.pico-sdk/"))
      get_filename_component(folder "${${name}}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
      set(${result} "${folder}" PARENT_SCOPE)
      return()
    endif()
  endforeach()
  foreach(name IN LISTS environment)
    if(NOT "$ENV{${name}}" STREQUAL "")
      file(TO_CMAKE_PATH "$ENV{${name}}" folder)
      set(${result} "${folder}" PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# _epg_is_version(<result> <folder> <version> <wanted>)
#
#   <result>   variable that is set to TRUE if the tool in <folder> has the version <wanted>, else to FALSE
#   <folder>   folder of the tool; a folder in its path that is called <wanted> is enough
#   <version>  version that the tool states, or ""
#   <wanted>   wanted version.  Only the numbers at its beginning are compared with <version>: 2.2.0-a4 is a release of the
#              tools around picotool, and contains picotool 2.2.0.
function(_epg_is_version result folder version wanted)
  string(REGEX MATCH "^[0-9.]+" numbers "${wanted}")
  string(REPLACE "/" ";" names "${folder}")
  if(wanted IN_LIST names OR (version AND numbers AND version VERSION_EQUAL numbers))
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

# _epg_check_version(<json> <folder> <version> <wanted>)
#
# Stops with an error if the tool in <folder> does not have the version <wanted>.
#   <json>     the text of targets/tools/<name>.json
#   <folder>   folder of the tool
#   <version>  version that the tool states
#   <wanted>   wanted version
function(_epg_check_version json folder version wanted)
  _epg_is_version(same "${folder}" "${version}" "${wanted}")
  if(NOT same)
    string(JSON title GET "${json}" title)
    string(JSON tested ERROR_VARIABLE none GET "${json}" tested)
    _epg_remedy(remedy "${json}")
    if(NOT none)
      string(REPLACE "${tested}" "${wanted}" remedy "${remedy}")
    endif()
    message(FATAL_ERROR "This project is written for version ${wanted} of the ${title}, and the one in ${folder} is ${version}. ${remedy}
Or write ${version} in place of ${wanted} in CMakeLists.txt.")
  endif()
endfunction()
