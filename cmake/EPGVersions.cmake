# SPDX-License-Identifier: Apache-2.0
# epg_use_versions([EPG <version>] [PICO_SDK <version>] [ARM_GCC <version>] [PICOTOOL <version>] [FREERTOS_KERNEL <version>])
#
# Before epg_import_pico_sdk(): from several versions beside each other these are taken, and where another one would be
# taken the configure step stops.  Versions are written as the installers name their folders: 14_2_Rel1, 2.2.0-a4.
#
# The compiler is taken from the folder of that name where the Raspberry Pi Pico extension of VS Code installs it; who
# has another one on the PATH gets that.  A picotool of another version is no problem: the SDK says which it can use.

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

# Stops when this EPG is another version.
function(_epg_same_epg wanted)
  set(PACKAGE_FIND_VERSION "${wanted}")
  include("${CMAKE_CURRENT_FUNCTION_LIST_DIR}/EPGConfigVersion.cmake")
  if(NOT PACKAGE_VERSION VERSION_EQUAL wanted)
    message(FATAL_ERROR "This project is written for EPG ${wanted}, and the EPG in ${CMAKE_CURRENT_FUNCTION_LIST_DIR} is ${PACKAGE_VERSION}.
Install EPG ${wanted} from its folder (docs/installing.md), or name that folder: -DEPG_PATH=<folder of EPG>.
Or write ${PACKAGE_VERSION} in place of ${wanted} in CMakeLists.txt.")
  endif()
endfunction()

# Sets <variable> and <folder> to what leads to version <wanted> of <tool>; <variable> to "" when nothing is to be set.
# Stops when a variable, or everything that is installed, is another version.
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
  # Nothing at all is found: whoever needs the tool says so.
endfunction()

# The folder that a variable of CMake or of the environment names, or "".  What the VS Code extension's file says is
# passed over where there is nothing: it names the folder that the extension would fill.
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

# Whether a folder is called <wanted>, or holds it: of 2.2.0-a4, a release of the tools around picotool, 2.2.0 counts.
function(_epg_is_version result folder version wanted)
  string(REGEX MATCH "^[0-9.]+" numbers "${wanted}")
  string(REPLACE "/" ";" names "${folder}")
  if(wanted IN_LIST names OR (version AND numbers AND version VERSION_EQUAL numbers))
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

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
