# SPDX-License-Identifier: Apache-2.0
# What the platforms in Zephyr share.
#
# Before find_package(Zephyr): the target's overlay and Kconfig defaults become a shield, which a user's own overlay and
# prj.conf go over, and EPG becomes one of Zephyr's modules.  When Zephyr loads that module, zephyr_module/CMakeLists.txt
# calls _epg_zephyr_build(), which compares what has become of the devicetree and the configuration with what the
# target needs, and makes the libraries.

include("${CMAKE_CURRENT_LIST_DIR}/c_library.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/compare.cmake")

# Sets BOARD, BOARD_ROOT and EXTRA_ZEPHYR_MODULES where the caller is; SHIELD is Zephyr's in the cache.
function(_epg_zephyr_prepare name output)
  get_property(other GLOBAL PROPERTY EPG_ZEPHYR_TARGET)
  if(TARGET zephyr_interface)
    message(FATAL_ERROR "epg_add_target(${name}): Zephyr has read its devicetree already.
Write epg_add_target() before find_package(Zephyr).")
  elseif(other)
    message(FATAL_ERROR "epg_add_target(${name}): this image has the target '${other}' already, and an image of Zephyr runs one.
A second target is a second image, which sysbuild builds beside this one; a model alone is epg_add_model()'s.")
  endif()
  set_property(GLOBAL PROPERTY EPG_ZEPHYR_TARGET "${name}")
  set_property(GLOBAL PROPERTY EPG_ZEPHYR_OUTPUT "${output}")
  set_property(GLOBAL PROPERTY EPG_ZEPHYR_PYTHON_BEFORE "$CACHE{Python3_EXECUTABLE}")

  _epg_zephyr_board("${name}" "${EPG_BOARD_zephyr}")
  set(BOARD "${BOARD}" PARENT_SCOPE)
  _epg_zephyr_write_shield(root "${name}" "${output}")
  list(APPEND BOARD_ROOT "${root}")
  list(REMOVE_DUPLICATES BOARD_ROOT)
  set(BOARD_ROOT "${BOARD_ROOT}" PARENT_SCOPE)
  _epg_zephyr_find_c_library()
  _epg_zephyr_select_shield("epg_${name}")
  _epg_zephyr_add_module()
  set(EXTRA_ZEPHYR_MODULES "${EXTRA_ZEPHYR_MODULES}" PARENT_SCOPE)
  set(ZEPHYR_EXTRA_MODULES "${ZEPHYR_EXTRA_MODULES}" PARENT_SCOPE)
  cmake_language(EVAL CODE
    "cmake_language(DEFER DIRECTORY [[${CMAKE_SOURCE_DIR}]] CALL _epg_zephyr_check_built [[${name}]])")
endfunction()

# In epg_add_target(): hands what _epg_zephyr_prepare() has set on to its caller.
macro(_epg_zephyr_hand_on)
  foreach(variable BOARD BOARD_ROOT EXTRA_ZEPHYR_MODULES ZEPHYR_EXTRA_MODULES)
    if(NOT "${${variable}}" STREQUAL "")
      set(${variable} "${${variable}}" PARENT_SCOPE)
    endif()
  endforeach()
endmacro()

# What a variable will be to Zephyr, which looks in this order: sysbuild's cache, this one, the environment, here.
function(_epg_zephyr_value result variable)
  set(${result} "" PARENT_SCOPE)
  _epg_zephyr_sysbuild_value(value "${variable}")
  foreach(candidate "${value}" "$CACHE{${variable}}" "$ENV{${variable}}" "${${variable}}")
    if(NOT candidate STREQUAL "")
      set(${result} "${candidate}" PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# What `west build --sysbuild -D<variable>=` and the like have set for this image, or "".
function(_epg_zephyr_sysbuild_value result variable)
  set(${result} "" PARENT_SCOPE)
  if(NOT SYSBUILD OR NOT EXISTS "${SYSBUILD_CACHE}")
    return()
  endif()
  file(STRINGS "${SYSBUILD_CACHE}" lines ENCODING UTF-8)
  set(image "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^SYSBUILD_NAME:[^=]*=(.*)$")
      set(image "${CMAKE_MATCH_1}")
    endif()
  endforeach()
  set(names "${variable}")
  if(image)
    list(APPEND names "${image}_${variable}") # the one for this image alone comes last and wins
  endif()
  foreach(wanted IN LISTS names)
    foreach(line IN LISTS lines)
      if(line MATCHES "^([^:]*):[^=]*=(.*)$" AND CMAKE_MATCH_1 STREQUAL wanted)
        set(${result} "${CMAKE_MATCH_2}" PARENT_SCOPE)
      endif()
    endforeach()
  endforeach()
endfunction()

# Sets BOARD where nobody has; stops when it is not the target's.
function(_epg_zephyr_board name wanted)
  _epg_zephyr_value(given BOARD)
  if(wanted STREQUAL "")
    set(BOARD "${given}" PARENT_SCOPE) # a board of the user's, whose board.yaml does not say what Zephyr calls it
    return()
  elseif(given STREQUAL "")
    set(BOARD "${wanted}" PARENT_SCOPE)
    return()
  endif()
  string(REGEX REPLACE "@[^/]*" "" plain "${given}")
  string(FIND "${plain}/" "${wanted}/" place)
  if(NOT place EQUAL 0)
    message(FATAL_ERROR "epg_add_target(${name}): its target is for Zephyr's board '${wanted}', and BOARD is '${given}'.
Build it with -b ${wanted} in a build folder of its own, or choose the .tcf of a target for '${given}'.
'epg targets' lists the boards that EPG knows; docs/adding-a-board.md says how to describe another one.")
  endif()
  set(BOARD "${given}" PARENT_SCOPE)
endfunction()

# The folder that Zephyr finds the shield epg_<name> in; files are touched only when they change.
function(_epg_zephyr_write_shield result name output)
  set(root "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${name}")
  set(shield "${root}/boards/shields/epg_${name}")
  string(TOUPPER "${name}" NAME)
  file(MAKE_DIRECTORY "${shield}")
  file(CONFIGURE OUTPUT "${shield}/Kconfig.shield" @ONLY
    CONTENT "# SPDX-License-Identifier: Apache-2.0\n# Generated by EPG.\n\nconfig SHIELD_EPG_@NAME@\n\tdef_bool $(shields_list_contains,epg_@name@)\n")
  file(COPY_FILE "${output}/${name}.Kconfig" "${shield}/Kconfig.defconfig" ONLY_IF_DIFFERENT)
  file(COPY_FILE "${output}/${name}.overlay" "${shield}/epg_${name}.overlay" ONLY_IF_DIFFERENT)
  set(${result} "${root}" PARENT_SCOPE)
endfunction()

# Adds the shield to those that the user has chosen.  Zephyr keeps what it has seen first in CACHED_SHIELD, which goes
# before everything else, and warns when SHIELD is another: an added shield is in both, whoever has set SHIELD, and a
# build that was configured before the target was added gets it too.
function(_epg_zephyr_select_shield shield)
  if(DEFINED CACHED_SHIELD)
    set(before "${CACHED_SHIELD}")
  else()
    _epg_zephyr_value(before SHIELD)
  endif()
  string(REPLACE " " ";" all "${before}")
  if(NOT shield IN_LIST all)
    list(APPEND all "${shield}")
  endif()
  string(REPLACE ";" " " all "${all}")
  set(written "$CACHE{SHIELD}")
  if(DEFINED CACHED_SHIELD AND NOT written STREQUAL "" AND NOT written STREQUAL CACHED_SHIELD
      AND NOT "${written} ${shield}" STREQUAL all)
    set(CACHED_SHIELD "${all}" CACHE STRING "Selected shield" FORCE)
    return() # another -DSHIELD than before: Zephyr says that this needs a pristine build
  endif()
  set(SHIELD "${all}" CACHE STRING "Selected shield" FORCE)
  set(CACHED_SHIELD "${all}" CACHE STRING "Selected shield" FORCE)
endfunction()

# Makes EPG one of Zephyr's modules.  One that is in the workspace's manifest too is read once: modules of one name are
# one to Zephyr, which takes the last.
function(_epg_zephyr_add_module)
  get_filename_component(module "${EPG_TARGETS_DIR}/.." ABSOLUTE)
  set(extra EXTRA_ZEPHYR_MODULES)
  foreach(value "$CACHE{EXTRA_ZEPHYR_MODULES}" "$CACHE{ZEPHYR_EXTRA_MODULES}"
      "$ENV{EXTRA_ZEPHYR_MODULES}" "$ENV{ZEPHYR_EXTRA_MODULES}" "${EXTRA_ZEPHYR_MODULES}" "${ZEPHYR_EXTRA_MODULES}"
      "${ZEPHYR_MODULES}" "$ENV{ZEPHYR_MODULES}")
    if(module IN_LIST value)
      return()
    endif()
  endforeach()
  # The list is added to where Zephyr finds it first.
  foreach(variable EXTRA_ZEPHYR_MODULES ZEPHYR_EXTRA_MODULES)
    if(NOT "$CACHE{${variable}}" STREQUAL "")
      set(${variable} "$CACHE{${variable}};${module}" CACHE STRING "Modules of Zephyr besides the workspace's" FORCE)
      return()
    endif()
  endforeach()
  foreach(variable EXTRA_ZEPHYR_MODULES ZEPHYR_EXTRA_MODULES)
    if(NOT "$ENV{${variable}}" STREQUAL "")
      set(${variable} "$ENV{${variable}};${module}" CACHE STRING "Modules of Zephyr besides the workspace's" FORCE)
      return()
    endif()
  endforeach()
  if("${EXTRA_ZEPHYR_MODULES}" STREQUAL "" AND NOT "${ZEPHYR_EXTRA_MODULES}" STREQUAL "")
    set(extra ZEPHYR_EXTRA_MODULES)
  endif()
  set(${extra} "${${extra}};${module}")
  list(REMOVE_ITEM ${extra} "")
  set(${extra} "${${extra}}" PARENT_SCOPE)
endfunction()

# From zephyr_module/CMakeLists.txt: the libraries of the target that epg_add_target() has prepared.
function(_epg_zephyr_build)
  get_property(name GLOBAL PROPERTY EPG_ZEPHYR_TARGET)
  get_property(output GLOBAL PROPERTY EPG_ZEPHYR_OUTPUT)
  get_property(python GLOBAL PROPERTY EPG_ZEPHYR_PYTHON_BEFORE)
  if(python STREQUAL "" AND NOT "$CACHE{Python3_EXECUTABLE}" STREQUAL "")
    # Zephyr's doing; the next configure must not take it for its user's.
    set(EPG_PYTHON_FOUND_LATER "$CACHE{Python3_EXECUTABLE}" CACHE INTERNAL "What Zephyr has found")
  endif()
  if(TARGET "${name}")
    message(FATAL_ERROR "epg_add_target(${name}): Zephyr has a target of this name; choose another one")
  endif()
  _epg_zephyr_compare("${name}" "${output}")
  _epg_build_target("${name}" "${output}")
endfunction()

# The generated source, compiled as Zephyr's own libraries are, and the port layer, which is the module's library
# epg_zephyr: all that for the application.
function(_epg_zephyr_port_layer name)
  get_property(output GLOBAL PROPERTY EPG_ZEPHYR_OUTPUT)
  list(TRANSFORM EPG_PLATFORM_SOURCES PREPEND "${output}/" OUTPUT_VARIABLE sources)
  zephyr_library_named("epg_zephyr_${name}")
  zephyr_library_sources(${sources})
  zephyr_library_include_directories("${EPG_TARGETS_DIR}/platforms/zephyr/include")
  zephyr_library_link_libraries(${name})
  target_link_libraries(epg_zephyr PRIVATE epg_runtime)
  target_link_libraries(${name} PRIVATE epg_zephyr) # the port layer that the runtime and the drivers call
  target_link_libraries(app PUBLIC ${name})
endfunction()

# EPG's main() for the application, which Zephyr has made.
function(_epg_zephyr_application executable name)
  if(NOT executable STREQUAL "app")
    message(FATAL_ERROR "epg_add_executable(${executable} EPG::${name}): Zephyr's application is called 'app': epg_add_executable(app EPG::${name})")
  endif()
  set(main "${CMAKE_BINARY_DIR}/epg/${name}_main.c")
  file(CONFIGURE OUTPUT "${main}" @ONLY CONTENT
"/* SPDX-License-Identifier: Apache-2.0 */
/* Generated by EPG: an application that is the target @name@ and nothing else. */
#include \"@name@.h\"

int main(void)
{
    return @name@_start() ? 0 : 1;
}
")
  target_sources(app PRIVATE "${main}")
endfunction()

# At the end of the top directory: Zephyr has read EPG's module, or nothing of the target is built.
function(_epg_zephyr_check_built name)
  if(TARGET "${name}")
    return()
  endif()
  get_filename_component(module "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../.." ABSOLUTE)
  if(NOT TARGET zephyr_interface)
    message(SEND_ERROR "epg_add_target(${name}): its target is built with Zephyr, and this project is none of Zephyr's.
Write after it: find_package(Zephyr REQUIRED HINTS \$ENV{ZEPHYR_BASE})")
  else()
    message(SEND_ERROR "epg_add_target(${name}): Zephyr did not read EPG as a module, so nothing of the target is built.
List EPG in the workspace's manifest, or give its folder: -DEXTRA_ZEPHYR_MODULES=${module}")
  endif()
endfunction()
