# SPDX-License-Identifier: Apache-2.0
# How CMake calls EPG's Python backend.

# Finds the interpreter once per build tree: Python3_EXECUTABLE or Python_EXECUTABLE if set, else west's when west
# configures, else what FindPython3 finds.
# Another -DPython3_EXECUTABLE is heeded, and so is an interpreter that is gone.
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
      # An activated virtual environment wins over newer interpreters of the system, as its user expects.
      set(Python3_FIND_VIRTUALENV FIRST)
      set(Python3_FIND_STRATEGY LOCATION)
      find_package(Python3 3.10 QUIET COMPONENTS Interpreter)
      set(found "${Python3_EXECUTABLE}")
    endif()
    set(remedy "Install it, or name it: cmake -DPython3_EXECUTABLE=<path> ...")
    if(NOT found)
      message(FATAL_ERROR "EPG needs Python 3.10 or newer and found none.\n${remedy}")
    endif()
    # What is found may be a launcher that looks for the real one each time (pyenv's takes 100 ms).
    execute_process(COMMAND "${found}" -c "import sys; print('%d.%d' % sys.version_info[:2], sys.executable)"
      OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_VARIABLE problem RESULT_VARIABLE status)
    if(NOT status STREQUAL "0" OR NOT answer MATCHES "^([0-9]+\\.[0-9]+) (.+)$")
      message(FATAL_ERROR "EPG needs Python 3.10 or newer, and this cannot be started: ${found}\n${problem}\n${remedy}")
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

# What users say of the interpreter.  What a build system has put into the cache after EPG had found one,
# EPG_PYTHON_FOUND_LATER, they have not said.
function(_epg_wanted_python result)
  set(python3 "$CACHE{Python3_EXECUTABLE}")
  if(python3 STREQUAL "$CACHE{EPG_PYTHON_FOUND_LATER}")
    set(python3 "")
  endif()
  set(${result} "${python3}|$CACHE{Python_EXECUTABLE}|$CACHE{WEST_PYTHON}" PARENT_SCOPE)
endfunction()

# Runs `epg <argument>...`; its messages go to the terminal as they are (CMake would wrap their lines).
# Sets <result> to TRUE or FALSE; the global property EPG_EXIT_STATUS holds the exit status (epg/cli/main.py lists them).
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

# What EPG's Python finds in its environment, as <variable>=<value>.
function(_epg_environment result)
  option(EPG_INSTALL_PYTHON_PACKAGES "Let EPG install Python packages it lacks into its own cache" ON)
  # Paths are bytes to CMake, and UTF-8 in what EPG writes for it, whatever the locale.
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

# The user's `targets` folders: the variable EPG_TARGETS_PATH (a list), else the environment variable.
function(_epg_user_folders result)
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

# The folder of the Python package `epg`: beside cmake/ in a checkout, around _data/cmake/ in a wheel.
function(_epg_python_folder result)
  get_filename_component(above "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/.." ABSOLUTE)
  if(EXISTS "${above}/epg/__main__.py")
    set(${result} "${above}/epg" PARENT_SCOPE)
  else()
    get_filename_component(package "${above}/.." ABSOLUTE)
    set(${result} "${package}" PARENT_SCOPE)
  endif()
endfunction()

# The folder that holds targets/ and schemas/.
function(_epg_data_folder result)
  get_filename_component(above "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/.." ABSOLUTE)
  set(${result} "${above}" PARENT_SCOPE)
endfunction()

# Stops with a message that names the caller's arguments unless all of <required> are given.  <usage> is the rest of
# the message: the arguments that the function takes.
function(_epg_require function usage name unparsed missing)
  set(takes "\nIt takes: ${function}(<name> ${usage})")
  if(name IN_LIST ARGN)
    message(FATAL_ERROR "${function}(${name} ...): the first argument must be a name.${takes}")
  endif()
  if(unparsed)
    list(JOIN unparsed " " words)
    message(FATAL_ERROR "${function}(${name}): unknown argument: ${words}.${takes}")
  endif()
  if(missing)
    list(JOIN missing ", " words)
    message(FATAL_ERROR "${function}(${name}): a keyword without a value: ${words}.${takes}")
  endif()
  foreach(keyword IN LISTS ARGN)
    if(NOT DEFINED arg_${keyword})
      message(FATAL_ERROR "${function}(${name}): ${keyword} is missing.${takes}")
    endif()
  endforeach()
  if(TARGET "${name}")
    message(FATAL_ERROR "${function}(${name}): a target of this name exists; choose another one")
  endif()
  _epg_check_folder_names()
endfunction()

# Stops where the name of a folder means something to CMake, Ninja or Make, as epg/check/names.py has it.
function(_epg_check_folder_names)
  _epg_data_folder(data)
  foreach(folder "${CMAKE_CURRENT_SOURCE_DIR}" "${CMAKE_BINARY_DIR}" "${data}")
    set(problem "")
    if(folder MATCHES "[|#<>?]|[$][({]|[$](ENV|CACHE)[{]|\\]=*\\]")
      set(problem "'${CMAKE_MATCH_0}' in it means something to CMake or the build program")
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

# Stops unless the project has enabled <language>.
function(_epg_require_language language reason)
  get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
  if(NOT languages)
    message(FATAL_ERROR "EPG: ${reason} needs ${language}, and project() has not been called yet.
Write project(<name> LANGUAGES ${language}) before the call of EPG.
In an application of Zephyr, choose the .tcf of a target for Zephyr: 'epg targets' lists them. What is for another platform, and epg_add_model(), go after find_package(Zephyr) and project().")
  elseif(NOT language IN_LIST languages)
    message(FATAL_ERROR "EPG: ${reason} needs ${language}: write project(${PROJECT_NAME} LANGUAGES ${languages} ${language})")
  endif()
endfunction()

# The options of all compiled code: + - x / give the same bits on every target.
function(_epg_exact_arithmetic target)
  target_compile_options(${target} PRIVATE
    $<$<OR:$<C_COMPILER_ID:GNU,Clang,AppleClang,ARMClang>,$<CXX_COMPILER_ID:GNU,Clang,AppleClang,ARMClang>>:-ffp-contract=off>)
  set_target_properties(${target} PROPERTIES
    C_STANDARD 11 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF
    CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF)
  if(TARGET zephyr_interface)
    # Zephyr keeps the flags that all code of an image must share, the processor's among them, in this target.
    target_link_libraries(${target} PRIVATE zephyr_interface)
  endif()
endfunction()
