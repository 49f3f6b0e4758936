# SPDX-License-Identifier: Apache-2.0
# Finds SDKs and tools.  The files targets/tools/<name>.json describe them, for this file and for `epg doctor`.
#
# epg_import_pico_sdk()
#
# Finds the Pico SDK, the Arm toolchain and picotool, and includes the SDK.  It must be called before project(), in
# place of the SDK's pico_sdk_import.cmake, and does not need PICO_SDK_PATH.  After it, as always with the Pico SDK:
# project(... C CXX ASM) and pico_sdk_init().  It is a macro, because the SDK's file sets variables in the caller.
#
# If a part is missing, it stops with an error that names all missing parts of the project.

macro(epg_import_pico_sdk)
  _epg_find_compiler(_epg_toolchain)
  _epg_find_sdk(_epg_sdk pico_sdk)
  if(_epg_toolchain_PROBLEM OR _epg_sdk_PROBLEM)
    _epg_stop_without_parts()
  endif()
  if(_epg_toolchain)
    set(PICO_TOOLCHAIN_PATH "${_epg_toolchain}" CACHE PATH "Folder of the Arm toolchain")
  endif()
  _epg_find_picotool()
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
      message(FATAL_ERROR "${_epg_picotool_PROBLEM}\nOr configure with -DPICO_NO_PICOTOOL=1: then there is no .uf2, only .elf, .hex and .bin.")
    endif()
  endif()
endmacro()

# _epg_tool_json(<result> <tool>)
#
# Sets <result> to the text of targets/tools/<tool>.json.
function(_epg_tool_json result tool)
  _epg_data_folder(data)
  file(READ "${data}/targets/tools/${tool}.json" json)
  set(${result} "${json}" PARENT_SCOPE)
endfunction()

# _epg_find_sdk(<result> <tool>)
#
# Finds an SDK.  A folder that a variable names is always taken: if it is wrong, that is an error, and the search does
# not go on in other places.  A library that is not found is downloaded if its file has "fetch".
#   <result>          variable that is set to the folder of the SDK, or to ""
#   <result>_VERSION  is set to its version, or to "" if that is not known
#   <result>_PROBLEM  is set to "", or to sentences about the problem and the command against it
#   <tool>            name of the SDK: the file targets/tools/<tool>.json
function(_epg_find_sdk result tool)
  _epg_tool_json(json "${tool}")
  string(JSON title GET "${json}" title)
  string(JSON holds GET "${json}" holds)
  _epg_remedy(remedy "${json}")
  set(${result} "" PARENT_SCOPE)
  set(${result}_VERSION "" PARENT_SCOPE)
  set(${result}_PROBLEM "" PARENT_SCOPE)

  _epg_json_list(variables "${json}" variables)
  _epg_json_list(environment "${json}" environment)
  set(found "")
  set(stated "")
  foreach(variable IN LISTS variables)
    if(NOT stated AND ${variable})
      set(stated "${${variable}}")
      set(source "variable ${variable}")
    endif()
  endforeach()
  foreach(variable IN LISTS environment)
    if(NOT stated AND NOT "$ENV{${variable}}" STREQUAL "")
      file(TO_CMAKE_PATH "$ENV{${variable}}" stated)
      set(source "environment variable ${variable}")
    endif()
  endforeach()
  if(stated)
    get_filename_component(stated "${stated}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
    if(NOT EXISTS "${stated}/${holds}")
      set(${result}_PROBLEM "The ${source} leads to no ${title}: there is no ${stated}/${holds}. ${remedy}" PARENT_SCOPE)
      return()
    endif()
    set(found "${stated}")
  else()
    _epg_candidates(folders ${tool} "${json}")
    if(folders)
      list(GET folders 0 found)
    endif()
  endif()
  if(NOT found)
    _epg_fetch_sdk(found "${json}")
  endif()
  if(NOT found)
    string(JSON optional ERROR_VARIABLE none GET "${json}" optional)
    if(none)
      set(optional "")
    else()
      set(optional " (${optional})")
    endif()
    set(${result}_PROBLEM "${title} was not found${optional}. ${remedy}" PARENT_SCOPE)
    return()
  endif()

  _epg_sdk_version(version "${json}" "${found}")
  string(JSON oldest ERROR_VARIABLE none GET "${json}" oldest)
  if(version AND NOT none AND version VERSION_LESS oldest)
    set(${result}_PROBLEM "The ${title} in ${found} is ${version}; EPG needs ${oldest} or newer. ${remedy}" PARENT_SCOPE)
    return()
  endif()
  set(${result} "${found}" PARENT_SCOPE)
  set(${result}_VERSION "${version}" PARENT_SCOPE)
endfunction()

# _epg_find_compiler(<result>)
#
# Finds the Arm toolchain.
#   <result>          variable that is set to its folder; "" if it is on the PATH, if PICO_TOOLCHAIN_PATH is set, or if
#                     there is none
#   <result>_PROBLEM  is set to "", or, if there is none, to a sentence and the command that installs it
function(_epg_find_compiler result)
  set(${result} "" PARENT_SCOPE)
  set(${result}_PROBLEM "" PARENT_SCOPE)
  if(PICO_TOOLCHAIN_PATH OR NOT "$ENV{PICO_TOOLCHAIN_PATH}" STREQUAL "")
    return()
  endif()
  _epg_tool_json(json arm_gcc)
  _epg_json_list(programs "${json}" programs)
  find_program(EPG_ARM_GCC NAMES ${programs} NO_CMAKE_FIND_ROOT_PATH)
  mark_as_advanced(EPG_ARM_GCC)
  if(EPG_ARM_GCC)
    return()
  endif()
  _epg_candidates(folders arm_gcc "${json}")
  if(folders)
    list(GET folders 0 found)
    set(${result} "${found}" PARENT_SCOPE)
    return()
  endif()
  string(JSON title GET "${json}" title)
  _epg_remedy(remedy "${json}")
  set(${result}_PROBLEM "${title} was not found. ${remedy}" PARENT_SCOPE)
endfunction()

# _epg_candidates(<result> <tool> <json>)
#
# Sets <result> to the folders in which the tool is installed, the best one first: the places of its installers, then
# those in CMake's package registry, then those in EPG's cache.  epg/tools/find_tool.py does the same steps, and
# tests/tools compares the answers.
#   <tool>  name of the tool
#   <json>  the text of targets/tools/<tool>.json
function(_epg_candidates result tool json)
  string(JSON files ERROR_VARIABLE none GET "${json}" holds)
  if(none)
    set(files "")
    _epg_json_list(programs "${json}" programs)
    foreach(program IN LISTS programs)
      list(APPEND files "${program}" "${program}.exe" "bin/${program}" "bin/${program}.exe")
    endforeach()
  endif()
  if(CMAKE_HOST_WIN32)
    file(TO_CMAKE_PATH "$ENV{USERPROFILE}" home)
  else()
    set(home "$ENV{HOME}")
  endif()
  set(found "")
  _epg_json_list(places "${json}" places)
  foreach(place IN LISTS places)
    string(REGEX REPLACE "^~" "${home}" place "${place}")
    file(GLOB folders LIST_DIRECTORIES true "${place}")
    _epg_holding(folders "${folders}" ${files})
    list(APPEND found ${folders})
  endforeach()
  string(JSON registry ERROR_VARIABLE none GET "${json}" registry)
  if(NOT none)
    _epg_registered(folders "${home}/.cmake/packages/${registry}" ${files})
    list(APPEND found ${folders})
  endif()
  string(JSON cached ERROR_VARIABLE none GET "${json}" cached)
  if(none)
    set(cached "${tool}-*")
  endif()
  _epg_cache_folder(cache)
  file(GLOB folders LIST_DIRECTORIES true "${cache}/${cached}")
  _epg_holding(folders "${folders}" ${files})
  set(${result} ${found} ${folders} PARENT_SCOPE)
endfunction()

# _epg_holding(<result> <folders> <file>...)
#
# Sets <result> to the folders of the list <folders> that contain at least one <file>, the newest version first.
function(_epg_holding result folders)
  list(SORT folders COMPARE NATURAL ORDER DESCENDING)
  set(found "")
  foreach(folder IN LISTS folders)
    foreach(file IN LISTS ARGN)
      if(EXISTS "${folder}/${file}" AND NOT IS_DIRECTORY "${folder}/${file}")
        list(APPEND found "${folder}")
        break()
      endif()
    endforeach()
  endforeach()
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

# _epg_registered(<result> <registry> <file>...)
#
# Sets <result> to the folders that are registered in CMake's package registry and contain at least one <file>, the
# newest version first.  If a registered folder has none, the nearest folder above it with one is taken.
#   <registry>  folder of the registry for one package; each of its files names a folder
function(_epg_registered result registry)
  set(found "")
  file(GLOB entries "${registry}/*")
  foreach(entry IN LISTS entries)
    file(READ "${entry}" folder)
    string(STRIP "${folder}" folder)
    set(last "")
    while(NOT folder STREQUAL last)
      _epg_holding(good "${folder}" ${ARGN})
      if(good)
        list(APPEND found "${folder}")
        break()
      endif()
      set(last "${folder}")
      get_filename_component(folder "${folder}" DIRECTORY)
    endwhile()
  endforeach()
  _epg_holding(found "${found}" ${ARGN})
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

# _epg_sdk_version(<result> <json> <folder>)
#
# Sets <result> to the version that the SDK's own files state, or to "".
#   <json>    the text of targets/tools/<name>.json, whose "version" names a file and patterns
#   <folder>  folder of the SDK
function(_epg_sdk_version result json folder)
  set(${result} "" PARENT_SCOPE)
  string(JSON name ERROR_VARIABLE none GET "${json}" version file)
  if(none OR NOT EXISTS "${folder}/${name}")
    return()
  endif()
  file(READ "${folder}/${name}" text)
  string(JSON count LENGTH "${json}" version patterns)
  math(EXPR last "${count} - 1")
  set(parts "")
  foreach(index RANGE ${last})
    string(JSON pattern GET "${json}" version patterns ${index})
    # The patterns are Python's: replace the parts that CMake's regular expressions do not have.
    string(REPLACE "\\d" "[0-9]" pattern "${pattern}")
    string(REPLACE "\\s" "[ \t]" pattern "${pattern}")
    string(REPLACE "(?:" "(" pattern "${pattern}")
    if(NOT text MATCHES "${pattern}")
      return()
    endif()
    list(APPEND parts "${CMAKE_MATCH_1}")
  endforeach()
  list(JOIN parts "." version)
  set(${result} "${version}" PARENT_SCOPE)
endfunction()

# _epg_cache_folder(<result>)
#
# Sets <result> to the folder of EPG's cache, the same as in epg/bootstrap.py.
function(_epg_cache_folder result)
  if(NOT "$ENV{EPG_CACHE}" STREQUAL "")
    file(TO_CMAKE_PATH "$ENV{EPG_CACHE}" folder)
  elseif(CMAKE_HOST_WIN32 AND NOT "$ENV{LOCALAPPDATA}" STREQUAL "")
    file(TO_CMAKE_PATH "$ENV{LOCALAPPDATA}/epg" folder)
  elseif(NOT "$ENV{XDG_CACHE_HOME}" STREQUAL "")
    set(folder "$ENV{XDG_CACHE_HOME}/epg")
  else()
    set(folder "$ENV{HOME}/.cache/epg")
  endif()
  _epg_check_cache("${folder}")
  set(${result} "${folder}" PARENT_SCOPE)
endfunction()

# _epg_check_cache(<folder>)
#
# Stops with an error if other users can change files in EPG's cache <folder>: CMake includes SDKs from there, and
# builds run programs from there.  epg/bootstrap.py, which runs later, checks the permissions of groups in more detail.
function(_epg_check_cache folder)
  get_property(checked GLOBAL PROPERTY EPG_CHECKED_CACHE)
  if(NOT CMAKE_HOST_UNIX OR checked STREQUAL folder OR NOT IS_DIRECTORY "${folder}")
    return()
  endif()
  set_property(GLOBAL PROPERTY EPG_CHECKED_CACHE "${folder}")
  set(find [=[find "$1"/. -prune \( -perm -0002 -o -perm -0020 ! -group "$(id -g)" -o ! -user "$(id -u)" ! -user 0 ! -user "${SUDO_UID:-0}" \)]=])
  execute_process(COMMAND sh -c "${find}" sh "${folder}" OUTPUT_VARIABLE found ERROR_QUIET)
  if(found)
    message(FATAL_ERROR "EPG does not use its cache, ${folder}: other users of this computer can change what is in it.
Delete it, or set the environment variable EPG_CACHE to a folder of your own, or, if you know all that is in it:
  chmod -R go-w ${folder}")
  endif()
endfunction()

# _epg_json_list(<result> <json> <key>)
#
# Sets <result> to the elements of the array <key> in the JSON text <json>; empty if there is no such array.
function(_epg_json_list result json key)
  set(values "")
  string(JSON count ERROR_VARIABLE none LENGTH "${json}" ${key})
  if(NOT none AND count GREATER 0)
    math(EXPR last "${count} - 1")
    foreach(index RANGE ${last})
      string(JSON value GET "${json}" ${key} ${index})
      list(APPEND values "${value}")
    endforeach()
  endif()
  set(${result} "${values}" PARENT_SCOPE)
endfunction()
