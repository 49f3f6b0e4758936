# SPDX-License-Identifier: Apache-2.0
# Builds the images of a system, one after another: the script of the CMake target <name>_images.
#
#   EPG_IMAGES  file that sets EPG_IMAGES to "<target>|<project>|<board>" of each image
#   EPG_DIR, EPG_IMAGE_SYSTEM, EPG_BUILD, EPG_PYTHON  the CMake package, the system, the folder of the builds, Python
#
# An image that cannot be built, for example because its SDK is missing, does not stop the others.
cmake_minimum_required(VERSION 3.22...3.31)
set(EPG_TARGETS_DIR "${EPG_DIR}/../targets")
include("${EPG_IMAGES}")
set(failed "")
foreach(image IN LISTS EPG_IMAGES)
  string(REPLACE "|" ";" parts "${image}")
  list(GET parts 0 target)
  list(GET parts 1 project)
  list(GET parts 2 board)
  set(folder "${EPG_BUILD}/${target}")
  message(STATUS "Image of ${target}")
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -S "${project}" -B "${folder}" "-DEPG_DIR=${EPG_DIR}" "-DEPG_IMAGE=${target}"
      "-DEPG_IMAGE_SYSTEM=${EPG_IMAGE_SYSTEM}" "-DEPG_IMAGE_BOARD=${board}" "-DPython3_EXECUTABLE=${EPG_PYTHON}"
    RESULT_VARIABLE status)
  if(status EQUAL 0)
    execute_process(COMMAND "${CMAKE_COMMAND}" --build "${folder}" --parallel RESULT_VARIABLE status)
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
