# SPDX-License-Identifier: Apache-2.0
# The target <name>_connect, which opens a target in a browser: `epg connect` with what epg_add_target() was told.

# <ARGN> are the arguments that name the target's files.  The server runs inside the build, which it may start again:
# neither Ninja nor Make locks its files, and Ninja opens its log when a command of its own has ended.
function(_epg_connect_target name)
  _epg_connect_command(command "${name}" ${ARGN})
  if(command MATCHES "[#<>]") # in a file's name: custom targets cannot have them
    return()
  endif()
  add_custom_target(${name}_connect
    COMMAND ${command}
    COMMENT "Connecting the ports of ${name}; Ctrl-C ends this"
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" USES_TERMINAL VERBATIM)
  file(REMOVE "${CMAKE_BINARY_DIR}/epg/${name}_connect.cmake")
endfunction()

# Where the generator has failed, CMake writes no build files, and there is no target to build.  Sets <result> to a
# script that does what the target would.
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

function(_epg_connect_command result name)
  _epg_find_python(python)
  _epg_environment(environment)
  _epg_python_folder(folder)
  set(built_by cmake)
  if(WEST_PYTHON)
    set(built_by west)
  endif()
  set(build "${CMAKE_BINARY_DIR}")
  if(SYSBUILD) # an image, which is built with the others
    get_filename_component(build "${build}" DIRECTORY)
  endif()
  set(command "${CMAKE_COMMAND}" -E env)
  foreach(word IN LISTS environment) # the separator of paths on Windows is that of lists
    string(REPLACE ";" "\\;" word "${word}")
    list(APPEND command "${word}")
  endforeach()
  list(APPEND command "${python}" "${folder}/__main__.py" connect --name "${name}" ${ARGN}
    --build-dir "${build}" --built-by ${built_by})
  set(${result} "${command}" PARENT_SCOPE)
endfunction()

# Writes down a call of <function> for `epg connect`, which reads the project's files without running CMake and so
# understands calls with literal arguments only.  A configure run begins with an empty list.
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
