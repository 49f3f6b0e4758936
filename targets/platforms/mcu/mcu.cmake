# SPDX-License-Identifier: Apache-2.0
# What platforms on microcontrollers share: their port layer is that of the target's family, as sources of whoever links
# a target.  docs/adding-a-family.md says which functions the family.cmake of a family defines.

# Sets <result> to FALSE, after an error, where target <name> cannot be built: no SDK, or one for another board.
function(_epg_mcu_check name result)
  include("${EPG_FAMILY_CMAKE}")
  cmake_language(CALL _epg_${EPG_FAMILY}_check "${name}" good)
  if(NOT good)
    set_property(TARGET ${name} PROPERTY EPG_FAILED TRUE) # what is said once need not be said of executables too
  endif()
  set(${result} "${good}" PARENT_SCOPE)
endfunction()

# Adds the port layer to target <name>; SERVICE are the sources that say how communication is served.
function(_epg_mcu_target name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SERVICE;LIBRARIES")
  set(shared "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
  cmake_path(GET EPG_FAMILY_CMAKE PARENT_PATH family)
  if(NOT TARGET epg_mcu)
    file(GLOB sources "${family}/src/*.c" "${shared}/src/*.c")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${family}/src" "${shared}/src")
    add_library(epg_mcu INTERFACE)
    target_sources(epg_mcu INTERFACE ${sources})
    target_include_directories(epg_mcu INTERFACE "${shared}/include" "${family}/include")
    cmake_language(CALL _epg_${EPG_FAMILY}_library epg_mcu)
  endif()

  # Its own interface library, because the sources must not be compiled into the static library.
  add_library(${name}_port INTERFACE)
  file(GLOB of_both "${family}/${EPG_PLATFORM}/*.c")
  target_sources(${name}_port INTERFACE ${arg_SERVICE} ${of_both})
  target_link_libraries(${name}_port INTERFACE epg_mcu ${arg_LIBRARIES})
  cmake_language(CALL _epg_${EPG_FAMILY}_target "${name}")
  target_include_directories(${name} PRIVATE "${shared}/include" "${family}/include")
  target_link_libraries(${name} INTERFACE ${name}_port)
  set_target_properties(${name} PROPERTIES EPG_FAMILY "${EPG_FAMILY}")
endfunction()

# An executable that holds target <name> and nothing else; <main> is its main().
function(_epg_mcu_executable executable name main)
  add_executable(${executable} "${main}")
  target_compile_definitions(${executable} PRIVATE EPG_MCU_START=${name}_start)
  target_link_libraries(${executable} PRIVATE ${name})
  set_target_properties(${executable} PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON)
  get_target_property(family ${name} EPG_FAMILY)
  cmake_language(CALL _epg_${family}_executable "${executable}")
endfunction()
