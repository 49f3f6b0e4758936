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
  set(tools ${ARGN} ${needed})
  list(REMOVE_DUPLICATES tools)
  _epg_problems(missing text ${tools})
  message(FATAL_ERROR "EPG: this computer lacks parts that the project is built with.\n${text}Then configure again.")
endfunction()

# _epg_check_needs(<result> <name>)
#
# Checks that the tools in EPG_NEEDS are there.  The caller must have included <name>.cmake, which sets EPG_NEEDS.
# A missing tool is reported once, even if several targets need it.
#   <result>  variable that is set to TRUE if no tool is missing, else to FALSE
#   <name>    the target, for the message
function(_epg_check_needs result name)
  get_property(reported GLOBAL PROPERTY EPG_REPORTED_TOOLS)
  set(needed ${EPG_NEEDS})
  list(REMOVE_ITEM needed ${reported})
  _epg_problems(missing text ${needed})
  if(missing)
    message(SEND_ERROR "epg_add_target(${name}): this computer lacks parts that the target is built with.\n${text}Then configure again.")
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
#
# Programs other than the Arm compiler are not checked: CMake has found them before.
function(_epg_problems missing text)
  set(wrong "")
  set(lines "")
  foreach(tool IN LISTS ARGN)
    set(part_PROBLEM "")
    _epg_tool_json(json "${tool}")
    string(JSON target ERROR_VARIABLE no_target GET "${json}" target)
    string(JSON holds ERROR_VARIABLE no_folder GET "${json}" holds)
    if(tool STREQUAL "arm_gcc")
      if(NOT CMAKE_C_COMPILER)
        _epg_find_compiler(part)
      endif()
    elseif(NOT no_folder AND (no_target OR NOT TARGET "${target}"))
      _epg_find_sdk(part "${tool}")
    endif()
    if(part_PROBLEM)
      list(APPEND wrong "${tool}")
      string(APPEND lines "${part_PROBLEM}\n")
    endif()
  endforeach()
  if(lines MATCHES "git clone")
    find_program(EPG_GIT git NO_CMAKE_FIND_ROOT_PATH)
    mark_as_advanced(EPG_GIT)
    if(NOT EPG_GIT)
      _epg_tool_json(json git)
      _epg_remedy(remedy "${json}")
      string(PREPEND lines "Git was not found, which commands below start. ${remedy}\n")
    endif()
  endif()
  set(${missing} "${wrong}" PARENT_SCOPE)
  set(${text} "${lines}" PARENT_SCOPE)
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

# _epg_remedy(<result> <json>)
#
#   <result>  variable that is set to "Get it:" and, on the next line, the command that installs the tool: with the
#             package manager of this computer if the tool has a command for it
#   <json>    the text of targets/tools/<name>.json
function(_epg_remedy result json)
  set(managers apt dnf pacman brew winget)
  set(command "")
  foreach(manager IN LISTS managers)
    string(JSON candidate ERROR_VARIABLE none GET "${json}" get ${manager})
    if(NOT command AND NOT none)
      find_program(EPG_PACKAGE_MANAGER_${manager} NAMES ${manager}-get ${manager} NO_CMAKE_FIND_ROOT_PATH)
      mark_as_advanced(EPG_PACKAGE_MANAGER_${manager})
      if(EPG_PACKAGE_MANAGER_${manager})
        _epg_privileged(sudo ${manager})
        set(command "${sudo}${candidate}")
      endif()
    endif()
  endforeach()
  if(NOT command)
    string(JSON command GET "${json}" get any)
  endif()
  if(command MATCHES "{pico_sdk}")
    _epg_pico_sdk_folder(sdk)
    _epg_quoted(sdk "${sdk}")
    string(REPLACE "{pico_sdk}" "${sdk}" command "${command}")
  endif()
  _epg_cache_folder(cache)
  _epg_quoted(cache "${cache}")
  string(REPLACE "{cache}" "${cache}" command "${command}")
  set(${result} "Get it:\n  ${command}" PARENT_SCOPE)
endfunction()

# _epg_privileged(<result> <manager>)
#
# Sets <result> to "sudo " if a command of the package manager needs it, else to "".  epg/tools/remedy.py decides in the
# same way.
function(_epg_privileged result manager)
  set(${result} "" PARENT_SCOPE)
  if(CMAKE_HOST_UNIX AND NOT manager MATCHES "^(brew|winget)$")
    execute_process(COMMAND id -u OUTPUT_VARIABLE user OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(NOT user STREQUAL "0")
      set(${result} "sudo " PARENT_SCOPE)
    endif()
  endif()
endfunction()

# _epg_pico_sdk_folder(<result>)
#
# Sets <result> to the folder of the Pico SDK, or to the folder in which the command that installs it will put it.
function(_epg_pico_sdk_folder result)
  _epg_find_sdk(sdk pico_sdk)
  if(NOT sdk)
    _epg_tool_json(json pico_sdk)
    string(JSON tested GET "${json}" tested)
    string(JSON cached GET "${json}" cached)
    _epg_cache_folder(cache)
    string(REPLACE "*" "${tested}" cached "${cached}")
    set(sdk "${cache}/${cached}")
  endif()
  set(${result} "${sdk}" PARENT_SCOPE)
endfunction()

# _epg_quoted(<result> <path>)
#
# Sets <result> to <path> as a word of a command line: in quotes if it has a blank.
function(_epg_quoted result path)
  if(path MATCHES " ")
    set(path "\"${path}\"")
  endif()
  set(${result} "${path}" PARENT_SCOPE)
endfunction()
