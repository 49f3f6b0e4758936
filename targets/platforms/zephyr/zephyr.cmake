# SPDX-License-Identifier: Apache-2.0
# Functions that the platforms zephyr and native_sim share.
#
# 1. epg_add_target() comes before find_package(Zephyr).  It writes the target's overlay and Kconfig defaults as a
# shield
#    (the user's overlay and prj.conf override a shield), and makes EPG one of Zephyr's modules.
# 2. find_package(Zephyr) loads EPG's module.  zephyr_module/CMakeLists.txt then calls _epg_zephyr_build().
# 3. _epg_zephyr_build() compares the final devicetree and configuration with those that the target needs, and adds the
#    libraries.

include("${CMAKE_CURRENT_LIST_DIR}/c_library.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/compare.cmake")

# Prepares find_package(Zephyr) for target <name>, whose generated files are in <output>.  Sets BOARD, BOARD_ROOT,
# EXTRA_ZEPHYR_MODULES and ZEPHYR_EXTRA_MODULES in the scope of the caller, and SHIELD in the cache.
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

# Called in epg_add_target(): passes the variables that _epg_zephyr_prepare() has set to the caller of epg_add_target().
macro(_epg_zephyr_hand_on)
  foreach(variable BOARD BOARD_ROOT EXTRA_ZEPHYR_MODULES ZEPHYR_EXTRA_MODULES)
    if(NOT "${${variable}}" STREQUAL "")
      set(${variable} "${${variable}}" PARENT_SCOPE)
    endif()
  endforeach()
endmacro()

# Sets <result> to the value that Zephyr will use for <variable>.  Zephyr takes the first of: sysbuild's cache, CMake's
# cache, the environment, a variable of CMake.
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

# Sets <result> to the value that sysbuild has for <variable> in this image, for example from `west build --sysbuild
# -D<variable>=...`, or to "".
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
    list(APPEND names "${image}_${variable}") # a value for this image alone comes last and overrides the general one
  endif()
  foreach(wanted IN LISTS names)
    foreach(line IN LISTS lines)
      if(line MATCHES "^([^:]*):[^=]*=(.*)$" AND CMAKE_MATCH_1 STREQUAL wanted)
        set(${result} "${CMAKE_MATCH_2}" PARENT_SCOPE)
      endif()
    endforeach()
  endforeach()
endfunction()

# Sets BOARD to <wanted> if the user has not set it.  Stops with an error if it is set to a board other than the
# target's.
function(_epg_zephyr_board name wanted)
  _epg_zephyr_value(given BOARD)
  if(wanted STREQUAL "")
    set(BOARD "${given}" PARENT_SCOPE) # the user's own board: its board.yaml does not contain Zephyr's name for it
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

# Writes the shield epg_<name>, and sets <result> to the folder in which Zephyr finds it.  Files are written only if
# their contents change.
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

# Adds <shield> to the shields that the user has chosen.
#
# Zephyr stores the shields of the first configuration in CACHED_SHIELD, which overrides all other values, and warns if
# SHIELD differs from it.  The shield is therefore added to both variables.  A build folder that was configured before
# the target was added gets the shield, too.
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
    return() # -DSHIELD differs from the one before: Zephyr warns that this needs a pristine build
  endif()
  set(SHIELD "${all}" CACHE STRING "Selected shield" FORCE)
  set(CACHED_SHIELD "${all}" CACHE STRING "Selected shield" FORCE)
endfunction()

# Makes EPG one of Zephyr's modules.  EPG may be in the workspace's manifest, too.  Zephyr reads it once nevertheless:
# of modules with the same name it uses the last.
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
  # Append to the variable that Zephyr reads: the first one that has a value.
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

# Adds the libraries of the target that epg_add_target() has prepared.  Called by zephyr_module/CMakeLists.txt.
function(_epg_zephyr_build)
  get_property(name GLOBAL PROPERTY EPG_ZEPHYR_TARGET)
  get_property(output GLOBAL PROPERTY EPG_ZEPHYR_OUTPUT)
  get_property(python GLOBAL PROPERTY EPG_ZEPHYR_PYTHON_BEFORE)
  if(python STREQUAL "" AND NOT "$CACHE{Python3_EXECUTABLE}" STREQUAL "")
    # Zephyr has set Python3_EXECUTABLE in the cache.  The next configuration must not take it for a choice of the user.
    set(EPG_PYTHON_FOUND_LATER "$CACHE{Python3_EXECUTABLE}" CACHE INTERNAL "What Zephyr has found")
  endif()
  if(TARGET "${name}")
    message(FATAL_ERROR "epg_add_target(${name}): Zephyr has a target with this name; choose another name")
  endif()
  _epg_zephyr_compare("${name}" "${output}")
  _epg_build_target("${name}" "${output}")
endfunction()

# Adds the generated source of the platform as a Zephyr library, so that it is compiled like Zephyr's own sources.
# Links it and the port layer, the library epg_zephyr of EPG's module, to the application.
function(_epg_zephyr_port_layer name)
  get_property(output GLOBAL PROPERTY EPG_ZEPHYR_OUTPUT)
  list(TRANSFORM EPG_PLATFORM_SOURCES PREPEND "${output}/" OUTPUT_VARIABLE sources)
  zephyr_library_named("epg_zephyr_${name}")
  zephyr_library_sources(${sources} ${EPG_CLASS_SOURCES})
  zephyr_library_include_directories("${EPG_TARGETS_DIR}/platforms/zephyr/include")
  zephyr_library_link_libraries(${name})
  target_link_libraries(epg_zephyr PRIVATE epg_runtime)
  target_link_libraries(${name} PRIVATE epg_zephyr) # the runtime and the drivers call the port layer
  target_link_libraries(app PUBLIC ${name})
endfunction()

# Adds a main() that starts target <name> to Zephyr's CMake target of the application, which must be <executable>.
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

# Deferred to the end of the top directory: reports an error if Zephyr has not read EPG's module.  Nothing of the target
# would be built then.
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
