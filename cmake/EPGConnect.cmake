# SPDX-License-Identifier: Apache-2.0
# The CMake targets <name>_connect and <name>_live, which open a target in a browser: `epg connect` with the arguments of
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
  set_property(GLOBAL PROPERTY EPG_CONNECT_${name} "${ARGN}")
  _epg_page_target("${name}_connect" "${name}" "Connecting the ports of ${name}; Ctrl-C ends this")
  file(REMOVE "${CMAKE_BINARY_DIR}/epg/${name}_connect.cmake")
endfunction()

# _epg_live_target(<name> [<executable>])
#
# Makes the CMake target <name>_live, which opens the page at the tab Live.  Does nothing for a target without
# <name>_connect, and for a second executable of the target.
#   <name>        the target
#   <executable>  its program for this computer: it runs as long as the page's server
function(_epg_live_target name)
  get_property(has_page GLOBAL PROPERTY EPG_CONNECT_${name} SET)
  if(NOT has_page OR TARGET "${name}_live")
    return()
  endif()
  if(ARGC GREATER 1)
    _epg_page_target("${name}_live" "${name}" "Running ${ARGV1}; Ctrl-C ends it" --live --run "$<TARGET_FILE:${ARGV1}>")
    add_dependencies("${name}_live" "${ARGV1}")
  else()
    _epg_page_target("${name}_live" "${name}" "Watching ${name}; Ctrl-C ends this" --live)
  endif()
endfunction()

# _epg_page_target(<target> <name> <comment> [<option>...])
#
# Makes a CMake target that opens the page.
#   <target>   the CMake target
#   <name>     the target; _epg_connect_target() has noted its arguments
#   <comment>  the text that the build prints
#   <option>   more options of `epg connect`
function(_epg_page_target target name comment)
  get_property(arguments GLOBAL PROPERTY EPG_CONNECT_${name})
  _epg_connect_command(command "${name}" ${arguments})
  if(command MATCHES "[#<>]") # the name of a file has such a character, which a custom target does not support
    set(script "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${target}.cmake")
    _epg_write_script("${script}" "${name}" ${command})
    set(command "${CMAKE_COMMAND}" -P "${script}" --)
  endif()
  add_custom_target(${target}
    COMMAND ${command} ${ARGN}
    COMMENT "${comment}"
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" USES_TERMINAL VERBATIM)
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
  set(script "${CMAKE_BINARY_DIR}/epg/${name}_connect.cmake")
  _epg_write_script("${script}" "${name}" ${command})
  set(${result} "${script}" PARENT_SCOPE)
endfunction()

# _epg_write_script(<script> <name> <word>...)
#
# Writes a CMake script that runs a command.  `cmake -P <script> -- <option>...` adds options to it.
#   <script>  path of the script
#   <name>    the target, for a comment
#   <word>    the command
function(_epg_write_script script name)
  set(words "")
  foreach(word IN LISTS ARGN)
    string(APPEND words " [==[${word}]==]")
  endforeach()
  file(WRITE "${script}" "# Opens target ${name} in a browser.\n"
    "set(options \"\")\n"
    "foreach(index RANGE 4 31) # behind cmake -P <script> --\n"
    "  if(index LESS CMAKE_ARGC)\n"
    "    list(APPEND options \"\${CMAKE_ARGV\${index}}\")\n"
    "  endif()\n"
    "endforeach()\n"
    "execute_process(COMMAND${words} \${options}\n"
    "  WORKING_DIRECTORY [==[${CMAKE_CURRENT_SOURCE_DIR}]==] COMMAND_ERROR_IS_FATAL ANY)\n")
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
