# SPDX-License-Identifier: Apache-2.0
# epg_add_simulation(<name> EXECUTABLE <executable> SCENARIO <file> [OUTPUT <folder>] [REALTIME])
#
# Makes a CMake target that builds an executable and runs it through a scenario.  It prints a table of the results.  It
# writes trace.csv, topics.csv, statistics.json, tracking.csv and other files; epg/simulate/run.py lists them.  The
# target fails if a limit of the scenario does not hold.
#
#   <name>      name of the CMake target; `cmake --build build --target <name>` runs the simulation
#   EXECUTABLE  an executable of epg_add_executable() for the host or of epg_add_system(), which must exist, or Zephyr's
#               `app` on native_sim
#   SCENARIO    the scenario; a relative path begins at the current source folder
#   OUTPUT      folder of the results; a relative path begins at the current build folder, which is the default
#   REALTIME    runs in real time instead of simulated time

function(epg_add_simulation name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "REALTIME" "EXECUTABLE;SCENARIO;OUTPUT" "")
  _epg_require(epg_add_simulation "EXECUTABLE <executable> SCENARIO <file> [OUTPUT <folder>] [REALTIME]" "${name}"
    "${arg_UNPARSED_ARGUMENTS}" "${arg_KEYWORDS_MISSING_VALUES}" EXECUTABLE SCENARIO)
  _epg_require_new(epg_add_simulation "${name}")
  if(NOT TARGET "${arg_EXECUTABLE}")
    message(FATAL_ERROR "epg_add_simulation(${name}): there is no executable '${arg_EXECUTABLE}'; call epg_add_executable() first")
  endif()
  get_target_property(failed "${arg_EXECUTABLE}" EPG_FAILED)
  if(failed)
    return()
  endif()
  set(program "$<TARGET_FILE:${arg_EXECUTABLE}>")
  set(built "${arg_EXECUTABLE}")
  get_target_property(type "${arg_EXECUTABLE}" TYPE)
  if(NOT type STREQUAL "EXECUTABLE")
    # Zephyr's `app` is a library; native_sim links it to a program for this computer.
    if(NOT TARGET native_runner_executable)
      message(FATAL_ERROR "epg_add_simulation(${name}): '${arg_EXECUTABLE}' cannot run on this computer; of Zephyr's boards, only native_sim can")
    endif()
    set(program "${APPLICATION_BINARY_DIR}/zephyr/${KERNEL_EXE_NAME}")
    set(built native_runner_executable)
  endif()
  if(NOT arg_OUTPUT)
    set(arg_OUTPUT "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  get_filename_component(arg_OUTPUT "${arg_OUTPUT}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_BINARY_DIR}")
  get_filename_component(scenario "${arg_SCENARIO}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
  _epg_find_python(python)
  _epg_python_folder(folder)
  set(realtime "")
  if(arg_REALTIME)
    set(realtime --realtime)
  endif()
  add_custom_target(${name}
    COMMAND "${python}" "${folder}/__main__.py" simulate "${program}"
      --scenario "${scenario}" --output "${arg_OUTPUT}" ${realtime}
    DEPENDS ${built} "${scenario}"
    USES_TERMINAL VERBATIM)
endfunction()
