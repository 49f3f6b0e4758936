# SPDX-License-Identifier: Apache-2.0
# The CMake target <name>_connect, which opens a target in a browser: `epg connect` with the arguments of
# epg_add_target().

# _epg_connect_target(<name> <argument>...)
#
# Makes the CMake target <name>_connect.
#   <name>      the target
#   <argument>  the arguments of `epg connect` that name the target's files
#
# The server runs inside a build, and may start another build in the same folder.  This works with Ninja and Make:
# neither locks its files, and Ninja opens its log only when one of its own commands has ended.
function(_epg_connect_target name)
  _epg_connect_command(command "${name}" ${ARGN})
  if(command MATCHES "[#<>]") # the name of a file has such a character, which a custom target does not support
    return()
  endif()
  add_custom_target(${name}_connect
    COMMAND ${command}
    COMMENT "Connecting the ports of ${name}; Ctrl-C ends this"
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" USES_TERMINAL VERBATIM)
  file(REMOVE "${CMAKE_BINARY_DIR}/epg/${name}_connect.cmake")
endfunction()

# _epg_connect_script(<result> <name> <argument>...)
#
# Writes a CMake script that does the same as the target <name>_connect.  It is for a project with errors: the generator
# has failed, so CMake writes no build files, and there is no target to build.
#   <result>    variable that is set to the path of the script
#   <name>      the target
#   <argument>  the arguments of `epg connect` that name the target's files
function(_epg_connect_script result name)
  _epg_connect_command(command "${name}" ${ARGN})
  set(words "")
  foreach(word IN LISTS command)
    string(APPEND words " [==[${word}]==]")
  endforeach()
  set(script "${CMAKE_BINARY_DIR}/epg/${name}_connect.cmake")
  file(WRITE "${script}" "# Opens target ${name} in a browser.\nexecute_process(COMMAND${words}\n"
    "  WORKING_DIRECTORY [==[${CMAKE_CURRENT_SOURCE_DIR}]==])\n")
  set(${result} "${script}" PARENT_SCOPE)
endfunction()

# _epg_connect_command(<result> <name> <argument>...)
#
# Sets <result> to the command line of `epg connect`, as a list.  The other arguments: see _epg_connect_target().
function(_epg_connect_command result name)
  _epg_find_python(python)
  _epg_python_folder(folder)
  set(built_by cmake)
  if(WEST_PYTHON)
    set(built_by west)
  endif()
  set(build "${CMAKE_BINARY_DIR}")
  if(SYSBUILD) # this is one image of several, which are built together from the folder above
    get_filename_component(build "${build}" DIRECTORY)
  endif()
  _epg_environment_command(command)
  list(APPEND command "${python}" "${folder}/__main__.py" connect --name "${name}" ${ARGN}
    --build-dir "${build}" --built-by ${built_by})
  set(${result} "${command}" PARENT_SCOPE)
endfunction()

# _epg_record_call(<function> <argument>...)
#
# Adds a call of <function> with its arguments to a record in the build folder.  The first call of a configure run
# begins a new record.  `epg connect` needs it, because it reads CMakeLists.txt without running CMake, and therefore
# understands only calls with literal arguments.
function(_epg_record_call function)
  set(record "${CMAKE_BINARY_DIR}/CMakeFiles/epg/calls.txt")
  get_property(begun GLOBAL PROPERTY EPG_RECORDS_CALLS)
  if(NOT begun)
    set_property(GLOBAL PROPERTY EPG_RECORDS_CALLS TRUE)
    file(WRITE "${record}" "")
  endif()
  set(text "${function}\n")
  foreach(word IN LISTS ARGN)
    string(APPEND text "\t${word}\n")
  endforeach()
  file(APPEND "${record}" "${text}")
endfunction()
