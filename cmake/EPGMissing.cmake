# SPDX-License-Identifier: Apache-2.0
# Reports all missing SDKs, compilers and libraries in one message, each with the command that installs it.
#
# A command is written on a separate line that begins with blanks: CMake does not wrap such lines of a message.

# _epg_stop_without_parts(<tool>...)
#
# Stops with a list of everything that is missing: of the tools named here, and of those that the targets need which
# CMakeLists.txt will add after an SDK is found.
function(_epg_stop_without_parts)
  _epg_tools_of_project(needed)
  _epg_sdks_to_find(needed ${needed})
  set(tools ${ARGN} ${needed})
  list(REMOVE_DUPLICATES tools)
  _epg_problems(missing text ${tools})
  message(FATAL_ERROR "EPG: this computer lacks tools that the project needs.\n${text}Then configure again.")
endfunction()

# _epg_check_needs(<result> <name>)
#
# Checks that the tools in EPG_NEEDS are there.  The caller must have included <name>.cmake, which sets EPG_NEEDS.
# A missing tool is reported once, even if several targets need it.
#   <result>  variable that is set to TRUE if no tool is missing, else to FALSE
#   <name>    the target, for the message
function(_epg_check_needs result name)
  get_property(reported GLOBAL PROPERTY EPG_REPORTED_TOOLS)
  get_property(programs GLOBAL PROPERTY EPG_PROGRAMS)
  set(needed ${EPG_NEEDS})
  list(REMOVE_ITEM needed ${reported} ${programs})
  _epg_sdks_to_find(needed ${needed})
  _epg_problems(missing text ${needed})
  if(missing)
    message(SEND_ERROR "epg_add_target(${name}): this computer lacks tools that the target needs.\n${text}Then configure again.")
    set_property(GLOBAL APPEND PROPERTY EPG_REPORTED_TOOLS ${missing})
  endif()
  set(${result} TRUE PARENT_SCOPE)
  foreach(tool IN LISTS reported missing)
    if(tool IN_LIST EPG_NEEDS)
      set(${result} FALSE PARENT_SCOPE)
    endif()
  endforeach()
endfunction()

# _epg_problems(<missing> <text> <tool>...)
#
#   <missing>  variable that is set to the list of the tools that are wrong or not found
#   <text>     variable that is set to the description of these problems and the commands against them
#   <tool>     names of tools: the files targets/tools/<tool>.json
function(_epg_problems missing text)
  set(wrong "")
  set(lines "")
  _epg_search_tools(answer ${ARGN}) # one search for all of them
  foreach(tool IN LISTS ARGN)
    _epg_find_sdk(part "${tool}")
    if(part_PROBLEM)
      list(APPEND wrong "${tool}")
      string(APPEND lines "${part_PROBLEM}\n")
    endif()
  endforeach()
  if(lines MATCHES "git clone")
    _epg_find_sdk(git git)
    if(git_PROBLEM)
      string(PREPEND lines "Git was not found, and commands below need it. ${git_REMEDY}\n")
    endif()
  endif()
  set(${missing} "${wrong}" PARENT_SCOPE)
  set(${text} "${lines}" PARENT_SCOPE)
endfunction()

# _epg_sdks_to_find(<result> <tool>...)
#
# Sets <result> to the tools that EPG must find.  CMake finds programs itself.  An SDK whose "target" exists is found
# already.  The project can have a copy of a tool.  The global property EPG_PROGRAMS gets the names of the programs.
function(_epg_sdks_to_find result)
  set(sdks "")
  foreach(tool IN LISTS ARGN)
    _epg_tool_files(file "${tool}")
    file(READ "${file}" json)
    string(JSON programs ERROR_VARIABLE no_program GET "${json}" programs)
    if(NOT no_program)
      set_property(GLOBAL APPEND PROPERTY EPG_PROGRAMS "${tool}")
    endif()
    string(JSON target ERROR_VARIABLE no_target GET "${json}" target)
    _epg_is_in_project(in_project "${json}")
    if(no_program AND (no_target OR NOT TARGET "${target}") AND NOT in_project)
      list(APPEND sdks "${tool}")
    endif()
  endforeach()
  set(${result} "${sdks}" PARENT_SCOPE)
endfunction()

# _epg_is_in_project(<result> <json>)
#
# Sets <result> to TRUE if the project has one of the files "in_project" of a tool's description.
function(_epg_is_in_project result json)
  set(${result} FALSE PARENT_SCOPE)
  string(JSON count ERROR_VARIABLE none LENGTH "${json}" in_project)
  if(none)
    return()
  endif()
  math(EXPR last "${count} - 1")
  foreach(index RANGE ${last})
    string(JSON file GET "${json}" in_project ${index})
    if(EXISTS "${CMAKE_SOURCE_DIR}/${file}")
      set(${result} TRUE PARENT_SCOPE)
    endif()
  endforeach()
endfunction()

# _epg_tools_of_project(<result>)
#
# Sets <result> to the names of the tools that the targets of this project need.  `epg doctor` reads its CMakeLists.txt
# without running CMake, so calls with other than literal arguments are missing.
function(_epg_tools_of_project result)
  set(${result} "" PARENT_SCOPE)
  _epg_find_python(python)
  _epg_environment(environment)
  _epg_python_folder(folder)
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -E env ${environment} "${python}" "${folder}/__main__.py" doctor --json
      --project "${CMAKE_SOURCE_DIR}"
    OUTPUT_VARIABLE answer ERROR_QUIET)
  string(JSON count ERROR_VARIABLE none LENGTH "${answer}" items)
  set(tools "")
  if(NOT none AND count GREATER 0)
    math(EXPR last "${count} - 1")
    foreach(index RANGE ${last})
      string(JSON tool GET "${answer}" items ${index} name)
      list(APPEND tools "${tool}")
    endforeach()
  endif()
  list(REMOVE_ITEM tools zephyr) # targets for Zephyr are built by another build of the same files
  set(${result} "${tools}" PARENT_SCOPE)
endfunction()
