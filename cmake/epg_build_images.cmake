# SPDX-License-Identifier: Apache-2.0
# Builds the images of a system, one after another: the script of the CMake target <name>_images.
#
#   EPG_IMAGES  file that sets EPG_IMAGES to "<target>|<project>|<board>" of each image
#   EPG_DIR, EPG_IMAGE_SYSTEM, EPG_BUILD, EPG_PYTHON  the CMake package, the system, the folder of the builds, Python
#   EPG_SOURCE  the top folder of the project that calls epg_add_system()
#
# An image that cannot be built, for example because its SDK is missing, does not stop the others.
cmake_minimum_required(VERSION 3.22...3.31)
set(EPG_TARGETS_DIR "${EPG_DIR}/../targets")
set(CMAKE_SOURCE_DIR "${EPG_SOURCE}")
if("$ENV{CMAKE_BUILD_PARALLEL_LEVEL}" STREQUAL "") # without a number, make would start all compilers at once
  cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
else()
  set(cores "$ENV{CMAKE_BUILD_PARALLEL_LEVEL}")
endif()
include("${EPG_IMAGES}")
set(failed "")
set(generator "")
find_program(EPG_NINJA ninja)
if(EPG_NINJA AND "$ENV{CMAKE_GENERATOR}" STREQUAL "")
  set(generator -G Ninja) # make would link images of Zephyr in each build
endif()
foreach(image IN LISTS EPG_IMAGES)
  string(REPLACE "|" ";" parts "${image}")
  list(GET parts 0 target)
  list(GET parts 1 project)
  list(GET parts 2 board)
  set(folder "${EPG_BUILD}/${target}")
  message(STATUS "Image of ${target}")
  set(arguments -S "${project}" -B "${folder}" "-DEPG_DIR=${EPG_DIR}" "-DEPG_IMAGE=${target}"
    "-DEPG_IMAGE_SYSTEM=${EPG_IMAGE_SYSTEM}" "-DEPG_IMAGE_BOARD=${board}" "-DPython3_EXECUTABLE=${EPG_PYTHON}")
  # A folder that these arguments have configured is only built: it configures itself again if one of its files changes.
  # Zephyr links its program again after each configure run.
  set(record "${folder}/CMakeFiles/epg_image.txt")
  set(before "")
  if(EXISTS "${record}")
    file(READ "${record}" before)
  endif()
  set(status 0)
  if(NOT before STREQUAL "${arguments}")
    file(REMOVE "${record}")
    set(chosen ${generator})
    if(EXISTS "${folder}/CMakeCache.txt") # it has a generator already
      set(chosen "")
    endif()
    execute_process(COMMAND "${CMAKE_COMMAND}" ${chosen} ${arguments} RESULT_VARIABLE status)
    if(status EQUAL 0)
      file(WRITE "${record}" "${arguments}")
    endif()
  endif()
  if(status EQUAL 0)
    execute_process(COMMAND "${CMAKE_COMMAND}" --build "${folder}" --parallel ${cores} RESULT_VARIABLE status)
  endif()
  if(NOT status EQUAL 0)
    list(APPEND failed "${target}")
  endif()
endforeach()
if(failed)
  list(JOIN failed ", " failed)
  message(FATAL_ERROR "EPG: these images were not built: ${failed}. The messages above say why.")
endif()
message(STATUS "The images are in ${EPG_BUILD}, each in the folder of its target.")
