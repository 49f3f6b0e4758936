# SPDX-License-Identifier: Apache-2.0
# epg_add_target(<name> TCF <file> MODEL <folder> BINDINGS <file>
#                [PLANT <folder> PLANT_BINDINGS <file>] [IOC <file>] [NODE <name>] [NAMESPACE <name>] [SET <key.key=value>...])
# epg_add_target(<name> SYSTEM <file> [IOC <file>])
#
# Makes the library EPG::<name> for a target.  The library itself contains the model, the tables and the runtime, which
# need no SDK.  The port layer of the platform is compiled in each executable that links the library.  Also makes the
# CMake targets <name>_connect and <name>_live, which open the target in a browser.
#
#   <name>          name of the target and of its library; its header is <name>.h
#   TCF             the target configuration: a path, or the name of one of EPG's predefined configurations
#   MODEL           the model
#   BINDINGS        the bindings file: which component port belongs to which model port
#   PLANT           the model of the robot, for a simulation; needs PLANT_BINDINGS
#   PLANT_BINDINGS  the bindings of the plant
#   IOC             the project file (.ioc) of CubeMX of the same program: EPG leaves its pins and timers alone.
#                   A target on the platform firmware must not have it
#   NODE            name of the ROS 2 node, instead of the one in the .tcf
#   NAMESPACE       namespace of the ROS 2 node, instead of the one in the .tcf
#   SET             other values of the .tcf, such as "control.period=2 ms"
#   SYSTEM          the file of a system that has a target <name>, with its files and values
#
# Relative paths begin at the current source folder.  It stops with an error if an argument is wrong.  A mistake in the
# files is reported, and the configure run fails at its end, so that all mistakes are reported together.
#
# epg_add_executable(<executable> EPG::<name>)
#
# Makes an executable with EPG's own main().  If it is for the host, <name>_live runs it.
#   <executable>  name of the executable
#   EPG::<name>   a library that epg_add_target() has made

function(epg_add_target name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TCF;MODEL;BINDINGS;PLANT;PLANT_BINDINGS;IOC;NODE;NAMESPACE;SYSTEM" "SET")
  string(CONCAT usage "TCF <file> MODEL <folder> BINDINGS <file> [PLANT <folder> PLANT_BINDINGS <file>] [IOC <file>] "
    "[NODE <name>] [NAMESPACE <name>] [SET <key.key=value>...]) or epg_add_target(<name> SYSTEM <file> [IOC <file>]")
  set(required TCF MODEL BINDINGS)
  if(DEFINED arg_SYSTEM)
    set(required "")
    foreach(keyword TCF MODEL BINDINGS PLANT PLANT_BINDINGS NODE NAMESPACE SET)
      if(DEFINED arg_${keyword})
        message(FATAL_ERROR "epg_add_target(${name}): the file of the system says this: remove ${keyword}")
      endif()
    endforeach()
  endif()
  _epg_require(epg_add_target "${usage}" "${name}" "${arg_UNPARSED_ARGUMENTS}" "${arg_KEYWORDS_MISSING_VALUES}" ${required})
  _epg_require_new(epg_add_target "${name}")
  foreach(pair "PLANT;PLANT_BINDINGS" "PLANT_BINDINGS;PLANT")
    list(GET pair 0 one)
    list(GET pair 1 other)
    if(DEFINED arg_${one} AND NOT DEFINED arg_${other})
      message(FATAL_ERROR "epg_add_target(${name}): ${one} needs ${other}")
    endif()
  endforeach()

  set(here "${CMAKE_CURRENT_SOURCE_DIR}")
  set(output "${CMAKE_BINARY_DIR}/epg/${name}")
  set(arguments --source-dir "${CMAKE_SOURCE_DIR}" --caller "${CMAKE_CURRENT_LIST_FILE}")
  if(DEFINED arg_SYSTEM)
    get_filename_component(inputs "${arg_SYSTEM}" ABSOLUTE BASE_DIR "${here}")
    list(APPEND arguments --system "${inputs}")
  else()
    get_filename_component(model "${arg_MODEL}" ABSOLUTE BASE_DIR "${here}")
    get_filename_component(bindings "${arg_BINDINGS}" ABSOLUTE BASE_DIR "${here}")
    list(PREPEND arguments --tcf "${arg_TCF}" --beside "${here}" --model "${model}" --bindings "${bindings}")
    set(inputs "${bindings}")
    get_filename_component(tcf "${arg_TCF}" ABSOLUTE BASE_DIR "${here}")
    if(EXISTS "${tcf}")
      list(APPEND inputs "${tcf}")
    endif()
  endif()
  if(DEFINED arg_PLANT)
    get_filename_component(plant "${arg_PLANT}" ABSOLUTE BASE_DIR "${here}")
    get_filename_component(plant_bindings "${arg_PLANT_BINDINGS}" ABSOLUTE BASE_DIR "${here}")
    list(APPEND arguments --plant "${plant}" --plant-bindings "${plant_bindings}")
    list(APPEND inputs "${plant_bindings}")
  endif()
  if(DEFINED arg_IOC)
    get_filename_component(ioc "${arg_IOC}" ABSOLUTE BASE_DIR "${here}")
    list(APPEND arguments --ioc "${ioc}")
    list(APPEND inputs "${ioc}")
  endif()
  foreach(keyword NODE NAMESPACE)
    if(DEFINED arg_${keyword})
      string(TOLOWER "--${keyword}" option)
      list(APPEND arguments "${option}" "${arg_${keyword}}")
    endif()
  endforeach()
  foreach(setting IN LISTS arg_SET)
    list(APPEND arguments --set "${setting}")
  endforeach()

  _epg_user_folders(roots)
  set(folders "")
  foreach(root IN LISTS roots)
    list(APPEND folders --targets-path "${root}")
  endforeach()
  _epg_record_call(epg_add_target "${name}" ${arguments} ${folders})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${inputs})
  _epg_generate(good "${name}" "${output}" generate "${name}" ${arguments})
  if(NOT good)
    set(connect "")
    get_property(status GLOBAL PROPERTY EPG_EXIT_STATUS)
    if(status STREQUAL "1" AND NOT DEFINED arg_SYSTEM) # a mistake in the target's files; after another error, `epg connect` would not run either
      _epg_connect_script(script "${name}" ${arguments})
      set(connect "\nIts ports can be connected in a browser:\n  cmake -P \"${script}\"")
    endif()
    message(SEND_ERROR "EPG: target '${name}' was not generated; the messages above say why${connect}")
    _epg_placeholder("${name}")
    return()
  endif()
  if(NOT DEFINED arg_SYSTEM)
    _epg_connect_target("${name}" ${arguments})
  endif()

  _epg_include("${output}" "${name}")
  _epg_check_needs(good "${name}")
  if(NOT good)
    _epg_placeholder("${name}")
    return()
  endif()
  include("${EPG_PLATFORM_CMAKE}")
  if(NOT EPG_PLATFORM STREQUAL "host") # a host program runs as part of <name>_live: see epg_add_executable()
    _epg_live_target("${name}")
  endif()
  # Zephyr chooses its compiler later, after it has read this target's devicetree.  It makes the libraries then.
  if(COMMAND _epg_${EPG_PLATFORM}_before_build)
    cmake_language(CALL _epg_${EPG_PLATFORM}_before_build "${name}" "${output}")
  else()
    _epg_build_target("${name}" "${output}")
  endif()
endfunction()

# _epg_build_target(<name> <output>)
#
# Makes the libraries of a target.
#   <name>    the target
#   <output>  folder of its generated files
function(_epg_build_target name output)
  _epg_require_language(C "EPG")
  _epg_include("${output}" "${name}")
  _epg_runtime_library("${EPG_TARGETS_DIR}/runtime")
  foreach(model IN LISTS EPG_MODELS)
    _epg_model_library("${model}" "${output}" 1)
  endforeach()
  set(generated ${EPG_GENERATED_SOURCES})
  if(NOT COMMAND _epg_${EPG_PLATFORM}_before_build) # Zephyr compiles the sources of its platform with its own settings
    list(APPEND generated ${EPG_PLATFORM_SOURCES})
    set(in_executable ${EPG_CLASS_SOURCES}) # with the settings of the SDK, as the port layer
  endif()
  list(TRANSFORM generated PREPEND "${output}/")
  add_library(${name} STATIC ${generated} ${EPG_COMPONENT_SOURCES})
  target_include_directories(${name} PUBLIC "${output}" ${EPG_CLASS_INCLUDES} PRIVATE ${EPG_COMPONENT_INCLUDES})
  target_sources(${name} INTERFACE ${in_executable})
  target_link_libraries(${name} PUBLIC epg_runtime ${EPG_MODELS})
  foreach(middleware IN LISTS EPG_MIDDLEWARES)
    _epg_middleware_library(${name} ${middleware})
  endforeach()
  _epg_compiler_options(${name})
  set_target_properties(${name} PROPERTIES EPG_PLATFORM "${EPG_PLATFORM}" EPG_PLATFORM_CMAKE "${EPG_PLATFORM_CMAKE}")
  add_library(EPG::${name} ALIAS ${name})

  include("${EPG_PLATFORM_CMAKE}")
  cmake_language(CALL _epg_${EPG_PLATFORM}_target "${name}")
endfunction()

function(epg_add_executable executable target)
  string(REGEX REPLACE "^EPG::" "" name "${target}")
  if(NOT TARGET "${name}")
    message(FATAL_ERROR "epg_add_executable(${executable} ${target}): there is no such target; call epg_add_target(${name} ...) first")
  endif()
  _epg_record_call(epg_add_executable "${executable}" "${name}")
  get_target_property(failed "${name}" EPG_FAILED)
  if(failed)
    _epg_placeholder("${executable}")
    return()
  endif()
  get_target_property(platform "${name}" EPG_PLATFORM)
  if(NOT platform)
    message(FATAL_ERROR "epg_add_executable(${executable} ${target}): ${name} was not made by epg_add_target()")
  endif()
  get_target_property(file "${name}" EPG_PLATFORM_CMAKE)
  include("${file}")
  cmake_language(CALL _epg_${platform}_executable "${executable}" "${name}")
endfunction()

# _epg_middleware_library(<name> <middleware>)
#
# Links a middleware to a target.  Its library is made once per build.
#   <name>        the target; the caller must have included its <name>.cmake, which sets EPG_MIDDLEWARE_<middleware>_*
#   <middleware>  name of the middleware
function(_epg_middleware_library name middleware)
  set(folder "${EPG_MIDDLEWARE_${middleware}_FOLDER}")
  if(NOT EPG_MIDDLEWARE_${middleware}_SOURCES)
    return()
  endif()
  set(library "epg_middleware_${middleware}")
  if(NOT TARGET ${library})
    add_library(${library} STATIC EXCLUDE_FROM_ALL ${EPG_MIDDLEWARE_${middleware}_SOURCES})
    target_include_directories(${library} PUBLIC "${folder}")
    target_link_libraries(${library} PUBLIC epg_runtime)
    _epg_compiler_options(${library})
    # The middleware's own function _epg_middleware_<middleware>(<library>) links the other libraries that it needs.
    if(EXISTS "${folder}/middleware.cmake")
      include("${folder}/middleware.cmake")
      cmake_language(CALL _epg_middleware_${middleware} ${library})
    endif()
  endif()
  target_link_libraries(${name} PRIVATE ${library}) # the middleware's headers are for generated code, not for the user
endfunction()

# _epg_runtime_library(<folder>)
#
# Makes the libraries epg_runtime, with the control cycle, and epg_communication from EPG's portable runtime, once per
# build.  A microcontroller can keep the first one in faster memory.
#   <folder>  folder of the runtime
function(_epg_runtime_library folder)
  if(TARGET epg_runtime)
    return()
  endif()
  foreach(part control communication)
    set(library epg_runtime)
    if(part STREQUAL "communication")
      set(library epg_communication)
    endif()
    file(GLOB sources "${folder}/src/${part}/*.c")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${folder}/src/${part}")
    add_library(${library} STATIC EXCLUDE_FROM_ALL ${sources})
    target_include_directories(${library} PUBLIC "${folder}/include")
    _epg_compiler_options(${library})
  endforeach()
  target_link_libraries(epg_runtime PUBLIC epg_communication)
  target_link_libraries(epg_communication PUBLIC epg_runtime)
endfunction()
