# SPDX-License-Identifier: Apache-2.0
# Calls EPG's Python code from CMake.

# _epg_find_python(<result>)
#
# Sets <result> to the path of the Python interpreter.  It is Python3_EXECUTABLE or Python_EXECUTABLE if one is set,
# else west's interpreter if west configures, else the interpreter that FindPython3 finds.  Stops with an error if there
# is none, or if it is older than 3.10.
#
# The interpreter is searched once per build tree, and again if these variables change or the interpreter is gone.
function(_epg_find_python result)
  _epg_wanted_python(wanted)
  if(NOT EPG_PYTHON OR NOT EXISTS "${EPG_PYTHON}" OR NOT wanted STREQUAL EPG_PYTHON_WANTED)
    if(Python3_EXECUTABLE)
      set(found "${Python3_EXECUTABLE}")
    elseif(Python_EXECUTABLE)
      set(found "${Python_EXECUTABLE}")
    elseif(WEST_PYTHON)
      set(found "${WEST_PYTHON}")
    else()
      # The user expects an activated virtual environment to be used, even if the system has a newer interpreter.
      set(Python3_FIND_VIRTUALENV FIRST)
      set(Python3_FIND_STRATEGY LOCATION)
      find_package(Python3 3.10 QUIET COMPONENTS Interpreter)
      set(found "${Python3_EXECUTABLE}")
    endif()
    set(remedy "Install it, or name it: cmake -DPython3_EXECUTABLE=<path> ...")
    if(CMAKE_HOST_WIN32)
      string(PREPEND remedy "Get it, and open a new terminal:\n  winget install Python.Python.3.13\n")
    endif()
    if(DEFINED ENV{PYTHONHOME})
      string(APPEND remedy "\nThe environment variable PYTHONHOME is '$ENV{PYTHONHOME}'. If that is not the folder of this Python's library, no Python starts: unset PYTHONHOME")
    endif()
    if(NOT found)
      message(FATAL_ERROR "EPG needs Python 3.10 or newer, but none was found.\n${remedy}")
    endif()
    # The found program may be a launcher that searches the real interpreter at each start (pyenv's takes 100 ms).
    execute_process(COMMAND "${found}" -c "import sys; print('%d.%d' % sys.version_info[:2], sys.executable)"
      OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_VARIABLE problem RESULT_VARIABLE status)
    if(NOT status STREQUAL "0" AND found MATCHES "[/\\]WindowsApps[/\\]")
      message(FATAL_ERROR "EPG needs Python 3.10 or newer. This is not Python: it is Windows' link to the Microsoft Store: ${found}\n${remedy}")
    endif()
    if(NOT status STREQUAL "0" OR NOT answer MATCHES "^([0-9]+\\.[0-9]+) (.+)$")
      message(FATAL_ERROR "EPG needs Python 3.10 or newer, but this interpreter cannot be started: ${found}\n${problem}\n${remedy}")
    endif()
    if(CMAKE_MATCH_1 VERSION_LESS 3.10)
      message(FATAL_ERROR "EPG needs Python 3.10 or newer; this is ${CMAKE_MATCH_1}: ${found}\n${remedy}")
    endif()
    file(TO_CMAKE_PATH "${CMAKE_MATCH_2}" executable)
    set(EPG_PYTHON "${executable}" CACHE INTERNAL "Python interpreter that runs EPG")
    set(EPG_PYTHON_WANTED "${wanted}" CACHE INTERNAL "What EPG_PYTHON was found from")
  endif()
  set(${result} "${EPG_PYTHON}" PARENT_SCOPE)
endfunction()

# _epg_wanted_python(<result>)
#
# Sets <result> to the user's choice of an interpreter, as one text.  EPG_PYTHON_FOUND_LATER is an interpreter that a
# build system has put into the cache after EPG had found one.  It is not a choice of the user, and does not count.
function(_epg_wanted_python result)
  set(python3 "$CACHE{Python3_EXECUTABLE}")
  if(python3 STREQUAL "$CACHE{EPG_PYTHON_FOUND_LATER}")
    set(python3 "")
  endif()
  set(${result} "${python3}|$CACHE{Python_EXECUTABLE}|$CACHE{WEST_PYTHON}" PARENT_SCOPE)
endfunction()

# _epg_run(<result> <argument>...)
#
# Runs `epg <argument>...`.  Its messages go to the terminal directly, because CMake would wrap their lines.  The global
# property EPG_EXIT_STATUS is set to the exit status; epg/cli/main.py lists the values.
#   <result>  variable that is set to TRUE if the exit status is 0, else to FALSE
function(_epg_run result)
  _epg_find_python(python)
  _epg_environment(environment)
  _epg_python_folder(folder)
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -E env EPG_ABSOLUTE_PATHS=1 ${environment} "${python}" "${folder}/__main__.py" ${ARGN}
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
    RESULT_VARIABLE status)
  set_property(GLOBAL PROPERTY EPG_EXIT_STATUS "${status}")
  if(status STREQUAL "0")
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

# _epg_environment_command(<result>)
#
# Sets <result> to the beginning of a command of a custom target, which runs the rest with these variables.
function(_epg_environment_command result)
  _epg_environment(environment)
  set(command "${CMAKE_COMMAND}" -E env)
  foreach(word IN LISTS environment) # on Windows, ';' separates paths, and in CMake the elements of a list
    string(REPLACE ";" "\\;" word "${word}")
    list(APPEND command "${word}")
  endforeach()
  set(${result} "${command}" PARENT_SCOPE)
endfunction()

# _epg_environment(<result>)
#
# Sets <result> to the environment variables for EPG's Python code: a list of <variable>=<value>.
function(_epg_environment result)
  option(EPG_INSTALL_PYTHON_PACKAGES "Let EPG install missing Python packages into its cache" ON)
  # CMake treats paths as bytes.  EPG must write them as UTF-8 in every locale.
  set(environment PYTHONUTF8=1)
  if(NOT EPG_INSTALL_PYTHON_PACKAGES OR FETCHCONTENT_FULLY_DISCONNECTED)
    list(APPEND environment "EPG_NO_INSTALL=1")
  endif()
  _epg_user_folders(folders)
  if(folders)
    if(CMAKE_HOST_WIN32)
      list(JOIN folders "\\;" folders)
    else()
      list(JOIN folders ":" folders)
    endif()
    list(APPEND environment "EPG_TARGETS_PATH=${folders}")
  endif()
  set(${result} "${environment}" PARENT_SCOPE)
endfunction()

# _epg_user_folders(<result>)
#
# Sets <result> to the absolute paths of the user's folders of targets: the list in the variable EPG_TARGETS_PATH, else
# the paths in the environment variable of this name.
function(_epg_user_folders result)
  if(NOT EPG_TARGETS_PATH AND "$ENV{EPG_TARGETS_PATH}" STREQUAL "")
    set(${result} "" PARENT_SCOPE)
    return()
  endif()
  set(folders "${EPG_TARGETS_PATH}")
  if(NOT folders)
    file(TO_CMAKE_PATH "$ENV{EPG_TARGETS_PATH}" folders)
  endif()
  list(FILTER folders EXCLUDE REGEX "^$")
  set(absolute "")
  foreach(folder IN LISTS folders)
    get_filename_component(folder "${folder}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
    list(APPEND absolute "${folder}")
  endforeach()
  set(${result} "${absolute}" PARENT_SCOPE)
endfunction()

# _epg_python_folder(<result>)
#
# Sets <result> to the folder of the Python package `epg`: it is beside cmake/ in a checkout, and around _data/cmake/ in
# a wheel.
function(_epg_python_folder result)
  get_filename_component(above "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/.." ABSOLUTE)
  if(EXISTS "${above}/epg/__main__.py")
    set(${result} "${above}/epg" PARENT_SCOPE)
  else()
    get_filename_component(package "${above}/.." ABSOLUTE)
    set(${result} "${package}" PARENT_SCOPE)
  endif()
endfunction()

# _epg_data_folder(<result>)
#
# Sets <result> to the folder that contains targets/ and schemas/.
function(_epg_data_folder result)
  get_filename_component(above "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/.." ABSOLUTE)
  set(${result} "${above}" PARENT_SCOPE)
endfunction()

# _epg_pattern(<result> <path>)
#
# Sets <result> to a pattern for file(GLOB) that only <path> matches.
function(_epg_pattern result path)
  string(REGEX REPLACE "[[*?]" "[\\0]" pattern "${path}")
  set(${result} "${pattern}" PARENT_SCOPE)
endfunction()

# _epg_own_roots(<result>)
#
# Sets <result> to the folders of targets that come with EPG: those in integration/, and targets/.  epg/generator/data.py
# has the same list.
function(_epg_own_roots result)
  _epg_data_folder(data)
  _epg_pattern(pattern "${data}")
  file(GLOB roots "${pattern}/integration/*/targets")
  set(${result} ${roots} "${data}/targets" PARENT_SCOPE)
endfunction()

# _epg_require(<function> <usage> <name> <unparsed> <missing> <keyword>...)
#
# Checks the arguments of a public function, and stops with an error if they are wrong.
#   <function>  name of the public function, for the message
#   <usage>     its arguments after the name, for the message
#   <name>      its first argument
#   <unparsed>  unknown arguments: <prefix>_UNPARSED_ARGUMENTS of cmake_parse_arguments()
#   <missing>   keywords without a value: <prefix>_KEYWORDS_MISSING_VALUES
#   <keyword>   keywords that are required; their values are in the caller's variables arg_<keyword>
function(_epg_require function usage name unparsed missing)
  set(takes "\nUsage: ${function}(<name> ${usage})")
  if(name IN_LIST ARGN)
    message(FATAL_ERROR "${function}(${name} ...): the first argument must be a name.${takes}")
  endif()
  if(name MATCHES "^(.+),$")
    message(FATAL_ERROR "${function}(${name} ...): CMake separates arguments by blanks: remove the commas.${takes}")
  endif()
  if(unparsed)
    list(JOIN unparsed " " words)
    list(GET unparsed 0 first)
    set(hint "")
    string(REGEX REPLACE "=.*" "" keyword "${first}")
    string(TOUPPER "${keyword}" keyword)
    if(keyword MATCHES "^[A-Z_]+$" AND usage MATCHES "(^|[^A-Z_])${keyword} <")
      set(hint "\nWrite '${keyword} <value>': keywords are in capitals, and have a blank behind them.")
    endif()
    message(FATAL_ERROR "${function}(${name}): unknown argument: ${words}.${hint}${takes}")
  endif()
  if(missing)
    list(JOIN missing ", " words)
    message(FATAL_ERROR "${function}(${name}): this keyword has no value: ${words}.${takes}")
  endif()
  foreach(keyword IN LISTS ARGN)
    if(NOT DEFINED arg_${keyword})
      message(FATAL_ERROR "${function}(${name}): ${keyword} is missing.${takes}")
    endif()
  endforeach()
  _epg_check_folder_names()
  _epg_check_compiler()
endfunction()

# _epg_require_new(<function> <name>)
#
# Stops with an error if the library or target <name>, which a public function makes, exists already.
function(_epg_require_new function name)
  if(TARGET "${name}")
    message(FATAL_ERROR "${function}(${name}): a target with this name exists already; choose another name")
  endif()
endfunction()

# _epg_check_folder_names()
#
# Stops with an error if the path of the source folder, of the build folder or of EPG contains a text with a special
# meaning for CMake, Ninja or Make.  epg/generator/check/names.py has the same rules.  Each source folder is checked once.
function(_epg_check_folder_names)
  get_property(checked DIRECTORY PROPERTY _EPG_CHECKED_FOLDER_NAMES)
  if(checked STREQUAL CMAKE_CURRENT_SOURCE_DIR) # folders below inherit the property
    return()
  endif()
  set_property(DIRECTORY PROPERTY _EPG_CHECKED_FOLDER_NAMES "${CMAKE_CURRENT_SOURCE_DIR}")
  string(LENGTH "${CMAKE_BINARY_DIR}" length)
  if(CMAKE_HOST_WIN32 AND length GREATER 180)
    message(WARNING "EPG: the path of the build folder has ${length} characters, and those of files in it have up to 80 more. Programs of Windows may not open paths of more than 259 characters. If the build fails, choose another build folder:\n  cmake -B C:/build ...")
  endif()
  _epg_data_folder(data)
  foreach(folder "${CMAKE_CURRENT_SOURCE_DIR}" "${CMAKE_BINARY_DIR}" "${data}")
    set(problem "")
    if(folder MATCHES "[|#<>?]|[$][({]|[$](ENV|CACHE)[{]|\\]=*\\]")
      set(problem "'${CMAKE_MATCH_0}' has a special meaning in CMake or the build program")
    else()
      string(REGEX REPLACE "[^[]" "" opened "${folder}")
      string(REGEX REPLACE "[^]]" "" closed "${folder}")
      string(LENGTH "${opened}" opened)
      string(LENGTH "${closed}" closed)
      if(NOT opened EQUAL closed)
        set(problem "brackets in it must be balanced")
      endif()
    endif()
    if(problem)
      message(FATAL_ERROR "EPG: a folder's name cannot be used in CMake: ${problem}. Rename it:\n  ${folder}")
    endif()
  endforeach()
endfunction()

# _epg_require_language(<language> <reason>)
#
# Stops with an error if the project has not enabled a language.
#   <language>  C or CXX
#   <reason>    the subject of the message that needs the language, such as: model 'jiwy'
function(_epg_require_language language reason)
  get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
  if(NOT languages)
    message(FATAL_ERROR "EPG: ${reason} needs ${language}, and project() has not been called yet.
Write project(<name> LANGUAGES ${language}) before the call of EPG.
In a Zephyr application, choose the .tcf of a target for Zephyr: 'epg targets' lists them. Call epg_add_target() for another platform, and epg_add_model(), after find_package(Zephyr) and project().")
  elseif(NOT language IN_LIST languages)
    message(FATAL_ERROR "EPG: ${reason} needs ${language}: write project(${PROJECT_NAME} LANGUAGES ${languages} ${language})")
  endif()
endfunction()
