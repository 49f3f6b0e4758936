# SPDX-License-Identifier: Apache-2.0
# epg_use_versions([EPG <version>] [<tool> <version>]...)
#
# Fixes the versions of a project's tools.  It must be called before the functions that find SDKs.  If several versions
# of a tool are installed, the given one is taken.  If another version would be taken, the configure run stops with an
# error, except if the tool's file says that the version is only preferred.
#
#   EPG     version of EPG
#   <tool>  name of a tool in capital letters.  The file tools/<tool>.json of the tool must have "project_version".
#
# Versions are written as in the installers' names of folders: 14_2_Rel1, 2.2.0-a4.
# It is a macro, because it sets variables in the caller.

macro(epg_use_versions)
  _epg_choose_versions(_epg_choices ${ARGN})
  foreach(_epg_choice IN LISTS _epg_choices)
    if(_epg_choice MATCHES "^([^=]+)=(.+)$")
      set(${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
    endif()
  endforeach()
endmacro()

# _epg_choose_versions(<result> <argument>...)
#
# Checks the arguments of epg_use_versions(), and stops with an error if a version cannot be taken.
#   <result>  variable that is set to the variables that select the versions: a list of <variable>=<folder>
function(_epg_choose_versions result)
  _epg_tool_files(files "*")
  set(keywords "")
  foreach(file IN LISTS files)
    file(READ "${file}" json)
    string(JSON accepts ERROR_VARIABLE none GET "${json}" project_version)
    if(NOT none)
      get_filename_component(tool "${file}" NAME_WE)
      string(TOUPPER "${tool}" keyword)
      list(APPEND keywords "${keyword}")
    endif()
  endforeach()
  list(REMOVE_DUPLICATES keywords)
  cmake_parse_arguments(wanted "" "EPG;${keywords}" "" ${ARGN})
  if(wanted_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "epg_use_versions: unknown argument: ${wanted_UNPARSED_ARGUMENTS}")
  endif()
  if(wanted_EPG)
    _epg_same_epg("${wanted_EPG}")
  endif()
  set(tools "")
  foreach(keyword IN LISTS keywords)
    if(wanted_${keyword})
      string(TOLOWER "${keyword}" tool)
      list(APPEND tools "${tool}=${wanted_${keyword}}")
    endif()
  endforeach()
  set(choices "")
  if(tools)
    _epg_ask_for_tools(answer ${tools})
    list(LENGTH tools count)
    foreach(index RANGE 1 ${count})
      math(EXPR index "${index} - 1")
      string(JSON problem GET "${answer}" versions ${index} problem)
      if(problem)
        message(FATAL_ERROR "${problem}")
      endif()
      string(JSON variable GET "${answer}" versions ${index} variable)
      string(JSON folder GET "${answer}" versions ${index} folder)
      list(APPEND choices "${variable}=${folder}")
    endforeach()
  endif()
  set(${result} "${choices}" PARENT_SCOPE)
endfunction()

# _epg_same_epg(<wanted>)
#
# Stops with an error if this EPG does not have the version <wanted>.
function(_epg_same_epg wanted)
  set(PACKAGE_FIND_VERSION "${wanted}")
  include("${CMAKE_CURRENT_FUNCTION_LIST_DIR}/EPGConfigVersion.cmake")
  if(NOT PACKAGE_VERSION VERSION_EQUAL wanted)
    message(FATAL_ERROR "This project is written for EPG ${wanted}, but the EPG in ${CMAKE_CURRENT_FUNCTION_LIST_DIR} is ${PACKAGE_VERSION}.
Install EPG ${wanted} from its folder (docs/installing.md), or name that folder: -DEPG_PATH=<folder of EPG>.
Or write ${PACKAGE_VERSION} in place of ${wanted} in CMakeLists.txt.")
  endif()
endfunction()
