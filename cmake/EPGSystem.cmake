# SPDX-License-Identifier: Apache-2.0
# epg_add_system(<name> SYSTEM <file> [TARGETS <target>...])
#
# Makes the executable <name>, which simulates all targets of a system, their messages and their plants.  Also makes the
# CMake target <name>_images, which builds the images of all targets that have a project for them, each in its own folder
# below <name>_images.  The CMake target <name>_flash builds them, too, and writes them to the boards.  An ordinary build
# builds neither.
#
#   <name>  name of the executable
#   SYSTEM  the file of the system; a relative path begins at the current source folder
#
# With TARGETS, it is for a firmware project.  It makes the library EPG::<target> of each of these targets, as
# epg_add_target(<target> SYSTEM <file>) does, and nothing else.  <name> is then the name of the call in messages.
#
# In sysbuild.cmake of a Zephyr application, it adds an image for each target on Zephyr, with the name of the target, and
# nothing else.  A relative path of SYSTEM then begins at the folder of sysbuild.cmake.
#
# Each target becomes a shared object beside the executable.  It stops with an error if an argument is wrong.  A mistake in
# the files is reported, and the configure run fails at its end.
function(epg_add_system name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "SYSTEM" "TARGETS")
  _epg_require(epg_add_system "SYSTEM <file> [TARGETS <target>...]" "${name}" "${arg_UNPARSED_ARGUMENTS}"
    "${arg_KEYWORDS_MISSING_VALUES}" SYSTEM)
  if(DEFINED arg_TARGETS)
    foreach(target IN LISTS arg_TARGETS)
      epg_add_target("${target}" SYSTEM "${arg_SYSTEM}")
    endforeach()
    if(COMMAND _epg_zephyr_hand_on) # find_package(Zephyr) reads variables in the scope of the caller
      _epg_zephyr_hand_on()
    endif()
    return()
  endif()
  if(DEFINED SYSBUILD_CURRENT_SOURCE_DIR AND COMMAND ExternalZephyrProject_Add)
    get_filename_component(file "${arg_SYSTEM}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_LIST_DIR}")
    _epg_system_sysbuild("${name}" "${file}")
    return()
  endif()
  _epg_require_new(epg_add_system "${name}")
  _epg_data_folder(data)
  include("${data}/targets/platforms/simulated/platform.cmake")
  _epg_simulator_systems(possible)
  if(NOT possible)
    message(FATAL_ERROR "epg_add_system(${name}): systems are simulated on a computer, and this project is for ${CMAKE_SYSTEM_NAME}.
In a firmware project, name its targets: epg_add_system(${name} SYSTEM ${arg_SYSTEM} TARGETS <target>...)")
  endif()
  get_filename_component(file "${arg_SYSTEM}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
  set(arguments --system "${file}" --source-dir "${CMAKE_SOURCE_DIR}" --caller "${CMAKE_CURRENT_LIST_FILE}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  set(output "${CMAKE_BINARY_DIR}/epg/${name}")
  _epg_generate(good "${name}" "${output}" generate-system "${name}" ${arguments})
  if(NOT good)
    message(SEND_ERROR "EPG: system '${name}' was not generated; the messages above say why")
    _epg_placeholder("${name}")
    return()
  endif()
  _epg_require_language(C "EPG")
  _epg_include("${output}" "${name}")
  set(targets ${EPG_SYSTEM_TARGETS})
  set(plant ${EPG_SYSTEM_PLANT})
  add_executable(${name} "${output}/${name}_system.c")
  if(plant)
    _epg_model_library("${plant}" "${output}" 1)
    target_link_libraries(${name} PRIVATE ${plant}) # for its header
  endif()
  foreach(target IN LISTS targets)
    _epg_system_part("${name}" "${target}" "${plant}" ${arguments})
  endforeach()
  if(plant)
    _epg_simulated_plant("${plant}")
    add_dependencies(${name} ${plant}_unit)
  endif()
  _epg_system_images("${name}" "${file}" "${output}/${name}_images.cmake")
  if(TARGET epg_simulator)
    target_link_libraries(${name} PRIVATE epg_simulator)
  endif()
endfunction()

# _epg_system_sysbuild(<name> <system>)
#
# Adds the images of all targets on Zephyr to a build of sysbuild.  targets/platforms/zephyr/image reads the variables
# <target>_EPG_... from sysbuild's cache.
function(_epg_system_sysbuild name system)
  set(output "${CMAKE_BINARY_DIR}/epg/${name}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${system}")
  _epg_generate(good "${name}" "${output}" generate-system "${name}" --system "${system}"
    --source-dir "${SYSBUILD_CURRENT_SOURCE_DIR}" --caller "${CMAKE_CURRENT_LIST_FILE}")
  if(NOT good)
    message(FATAL_ERROR "EPG: system '${name}' was not generated; the messages above say why")
  endif()
  _epg_include("${output}" "${name}_images")
  foreach(image IN LISTS EPG_IMAGES)
    string(REPLACE "|" ";" parts "${image}")
    list(GET parts 0 target)
    list(GET parts 1 project)
    list(GET parts 2 board)
    if(project STREQUAL "${EPG_TARGETS_DIR}/platforms/zephyr/image")
      set(${target}_EPG_DIR "${CMAKE_CURRENT_FUNCTION_LIST_DIR}" CACHE INTERNAL "folder of EPG's CMake package")
      set(${target}_EPG_IMAGE "${target}" CACHE INTERNAL "target of the image")
      set(${target}_EPG_IMAGE_SYSTEM "${system}" CACHE INTERNAL "system of the target")
      set(${target}_EPG_IMAGE_BOARD "${board}" CACHE INTERNAL "Zephyr's name of the board")
      ExternalZephyrProject_Add(APPLICATION ${target} SOURCE_DIR "${project}" BOARD "${board}")
    endif()
  endforeach()
endfunction()

# _epg_system_part(<name> <target> <plant> <argument>...)
#
# Makes the shared objects of one target of the system <name>.
#   <plant>     the library of the system's plant, or ""
#   <argument>  the arguments of `epg generate-system`
function(_epg_system_part name target plant)
  set(part "${name}_${target}")
  set(output "${CMAKE_BINARY_DIR}/epg/${part}")
  _epg_generate(good "${part}" "${output}" generate-system "${name}" --target "${target}" ${ARGN})
  if(NOT good)
    message(SEND_ERROR "EPG: target '${target}' of system '${name}' was not generated; the messages above say why")
    return()
  endif()
  _epg_include("${output}" "${part}")
  _epg_build_target("${part}" "${output}")
  if(plant)
    target_link_libraries(${part} PRIVATE ${plant}) # for its header
  endif()
  foreach(module ${part}_unit ${part}_plant_unit)
    if(TARGET ${module})
      add_dependencies(${name} ${module})
    endif()
  endforeach()
endfunction()

# _epg_system_images(<name> <system> <images>)
#
# Makes the CMake targets <name>_images and <name>_flash.
#   <system>  the file of the system
#   <images>  the generated file with the list of images
function(_epg_system_images name system images)
  _epg_find_python(python)
  _epg_environment_command(command)
  set(here "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
  add_custom_target(${name}_images
    COMMAND ${command} "${CMAKE_COMMAND}" "-DEPG_IMAGES=${images}" "-DEPG_DIR=${here}" "-DEPG_IMAGE_SYSTEM=${system}"
      "-DEPG_SOURCE=${CMAKE_SOURCE_DIR}"
      "-DEPG_BUILD=${CMAKE_CURRENT_BINARY_DIR}/${name}_images" "-DEPG_PYTHON=${python}"
      -P "${here}/epg_build_images.cmake"
    COMMENT "Images of the system ${name}" USES_TERMINAL VERBATIM)
  _epg_python_folder(folder)
  add_custom_target(${name}_flash
    COMMAND ${command} "${python}" "${folder}/__main__.py" flash "${system}"
      --images "${CMAKE_CURRENT_BINARY_DIR}/${name}_images"
    COMMENT "Writing the images of the system ${name} to its boards" USES_TERMINAL VERBATIM)
  add_dependencies(${name}_flash ${name}_images)
endfunction()
