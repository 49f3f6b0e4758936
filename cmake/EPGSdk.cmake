# SPDX-License-Identifier: Apache-2.0
# Finds SDKs and tools: the files tools/<tool>.json in the folders of targets describe them, and `epg find-tools` searches
# them.  One start of Python serves a configure run, unless a variable that names a tool changes in between.

# _epg_find_sdk(<result> <tool>)
#
# Finds an SDK or a program.  A folder that a variable names is always taken: if it is wrong, that is an error, and the
# search does not go on in other places.  A library that is not found is downloaded if its file has "fetch".
#   <result>          variable that is set to the folder of the tool; to "" if there is a problem, or for a program on the
#                     PATH
#   <result>_VERSION  is set to its version, or to "" if that is not known
#   <result>_PROBLEM  is set to "", or to sentences about the problem and the command against it
#   <result>_REMEDY   is set to "Get it:" and, on the next line, the command that installs the tool
#   <tool>            name of the tool: the file tools/<tool>.json
function(_epg_find_sdk result tool)
  _epg_search_tools(answer "${tool}")
  string(JSON status GET "${answer}" tools "${tool}" status)
  if(status STREQUAL "missing")
    string(JSON cache GET "${answer}" cache)
    _epg_fetch_sdk(fetched "${tool}" "${cache}")
    if(fetched)
      set_property(GLOBAL PROPERTY EPG_FOUND_TOOLS "")
      _epg_search_tools(answer "${tool}")
    endif()
  endif()
  foreach(key folder version problem remedy)
    string(JSON ${key} GET "${answer}" tools "${tool}" ${key})
  endforeach()
  set(${result} "${folder}" PARENT_SCOPE)
  set(${result}_VERSION "${version}" PARENT_SCOPE)
  set(${result}_PROBLEM "${problem}" PARENT_SCOPE)
  set(${result}_REMEDY "${remedy}" PARENT_SCOPE)
endfunction()

# _epg_search_tools(<result> <tool>...)
#
# Sets <result> to an answer of `epg find-tools` that has these tools, as JSON.  It is an earlier answer if no variable
# that names one of the tools has changed since.
function(_epg_search_tools result)
  get_property(answer GLOBAL PROPERTY EPG_FOUND_TOOLS)
  set(known TRUE)
  foreach(tool IN LISTS ARGN)
    string(JSON searched_with ERROR_VARIABLE unknown GET "${answer}" tools "${tool}" variables)
    _epg_tool_variables(variables "${tool}")
    if(unknown OR NOT "${searched_with}" STREQUAL "${variables}")
      set(known FALSE)
    endif()
  endforeach()
  if(NOT known)
    _epg_ask_for_tools(answer ${ARGN})
    set_property(GLOBAL PROPERTY EPG_FOUND_TOOLS "${answer}")
  endif()
  set(${result} "${answer}" PARENT_SCOPE)
endfunction()

# _epg_ask_for_tools(<result> <tool>[=<version>]...)
#
# Sets <result> to the answer of `epg find-tools`, as JSON.  Stops with an error if EPG's cache must not be used, or if a
# tool's file has a mistake.  The messages of Python go to the terminal directly.
function(_epg_ask_for_tools result)
  _epg_find_python(python)
  _epg_environment(environment)
  _epg_python_folder(folder)
  _epg_tool_variables(variables "*")
  list(TRANSFORM variables PREPEND "--variable=")
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -E env ${environment} "${python}" "${folder}/__main__.py" find-tools ${ARGN} ${variables}
    WORKING_DIRECTORY "${CMAKE_BINARY_DIR}" OUTPUT_VARIABLE answer RESULT_VARIABLE status)
  if(NOT status STREQUAL "0")
    message(FATAL_ERROR "EPG: SDKs and tools were not searched; the messages above say why")
  endif()
  set(${result} "${answer}" PARENT_SCOPE)
endfunction()

# _epg_tool_variables(<result> <tool>)
#
# Sets <result> to the variables that name a tool and have a value: a list of <variable>=<value>.
#   <tool>  name of the tool, or "*" for all tools
function(_epg_tool_variables result tool)
  set(given "")
  _epg_tool_files(files "${tool}")
  foreach(file IN LISTS files)
    file(READ "${file}" json)
    string(JSON count ERROR_VARIABLE none LENGTH "${json}" variables)
    if(NOT none)
      math(EXPR last "${count} - 1")
      foreach(index RANGE ${last})
        string(JSON variable GET "${json}" variables ${index})
        if(${variable})
          string(REPLACE ";" " " value "${${variable}}")
          list(APPEND given "${variable}=${value}")
        endif()
      endforeach()
    endif()
  endforeach()
  set(${result} "${given}" PARENT_SCOPE)
endfunction()

# _epg_tool_files(<result> <tool>)
#
# Sets <result> to the file tools/<tool>.json, or to the files of all tools.
#   <tool>  name of the tool, or "*" for all tools
function(_epg_tool_files result tool)
  _epg_user_folders(roots)
  _epg_own_roots(own)
  set(files "")
  foreach(root IN LISTS roots own)
    file(GLOB found "${root}/tools/${tool}.json")
    list(APPEND files ${found})
  endforeach()
  if(files AND NOT tool STREQUAL "*")
    list(GET files 0 files) # the user's description of a tool counts
  endif()
  set(${result} "${files}" PARENT_SCOPE)
endfunction()
