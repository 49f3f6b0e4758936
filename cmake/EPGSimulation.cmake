# epg_add_simulation(<name> EXECUTABLE <executable> SCENARIO <file> [OUTPUT <folder>] [REALTIME])
#
# A target that builds a host executable, runs it through a scenario, prints a table and leaves <name>.csv and <name>.png
# in <folder> (default: the build folder).  It fails when the scenario's limits do not hold.

function(epg_add_simulation name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "REALTIME" "EXECUTABLE;SCENARIO;OUTPUT" "")
  _epg_require(epg_add_simulation "${name}" "${arg_UNPARSED_ARGUMENTS}" "${arg_KEYWORDS_MISSING_VALUES}" EXECUTABLE SCENARIO)
  if(NOT TARGET "${arg_EXECUTABLE}")
    message(FATAL_ERROR "epg_add_simulation(${name}): there is no executable '${arg_EXECUTABLE}'; call epg_add_executable() before")
  endif()
  get_target_property(failed "${arg_EXECUTABLE}" EPG_FAILED)
  if(failed)
    return()
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
    COMMAND "${python}" "${folder}/__main__.py" simulate "$<TARGET_FILE:${arg_EXECUTABLE}>"
      --scenario "${scenario}" --output "${arg_OUTPUT}" ${realtime}
    DEPENDS ${arg_EXECUTABLE} "${scenario}"
    USES_TERMINAL VERBATIM)
endfunction()
