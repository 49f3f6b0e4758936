# SPDX-License-Identifier: Apache-2.0
# Functions that the platforms bare_metal and freertos share.  Their port layer comes from the target's family of chips.
# Its sources are compiled into each executable that links a target, with the SDK's settings for that executable.
# docs/adding-a-family.md lists the functions that a family.cmake must define.

# Checks if target <name> can be built.  Reports an error and sets <result> to FALSE if not, for example without the SDK
# or with the SDK set to another board.
function(_epg_mcu_check name result)
  include("${EPG_FAMILY_CMAKE}")
  cmake_language(CALL _epg_${EPG_FAMILY}_check "${name}" good)
  if(NOT good)
    set_property(TARGET ${name} PROPERTY EPG_FAILED TRUE) # its executables need not report the same error again
  endif()
  set(${result} "${good}" PARENT_SCOPE)
endfunction()

# _epg_mcu_name_archives(<suffix> <library>...)
#
# Gives the archives of the control cycle names that end with <suffix>.a, by which a linker script places their code and
# data.  Functions and variables have sections of their own, so the linker removes unused ones.
function(_epg_mcu_name_archives suffix)
  foreach(library IN LISTS ARGN)
    get_target_property(done ${library} EPG_NAMED)
    if(NOT done)
      set_target_properties(${library} PROPERTIES OUTPUT_NAME "${library}${suffix}" EPG_NAMED TRUE)
      foreach(type IN LISTS CMAKE_CONFIGURATION_TYPES ITEMS ${CMAKE_BUILD_TYPE})
        string(TOUPPER "${type}" TYPE)
        set_target_properties(${library} PROPERTIES ${TYPE}_POSTFIX "") # CMAKE_DEBUG_POSTFIX would come behind the suffix
      endforeach()
      target_compile_options(${library} PRIVATE -ffunction-sections -fdata-sections)
      if(TARGET ${library}_export)
        target_compile_options(${library}_export PRIVATE -ffunction-sections)
      endif()
    endif()
  endforeach()
endfunction()

# Sets <result> to the options of the compiler for code of the communication side: for size instead of speed.  Nothing in
# it is time-critical.  Where it runs from flash, small code also leaves more of the cache to others.  With
# EPG_OPTIMIZE=OFF, Debug builds are not optimised.
function(_epg_mcu_small_options result)
  if(DEFINED EPG_OPTIMIZE AND NOT EPG_OPTIMIZE)
    set(${result} "$<$<CONFIG:Release,RelWithDebInfo>:-Os>" PARENT_SCOPE)
  else()
    set(${result} "$<$<NOT:$<CONFIG:MinSizeRel>>:-Os>" PARENT_SCOPE)
  endif()
endfunction()

# _epg_mcu_small(<library>...)
#
# Compiles libraries of the communication side for size.  Functions and variables have sections of their own, so the
# linker removes unused ones.
function(_epg_mcu_small)
  _epg_mcu_small_options(options)
  foreach(library IN LISTS ARGN)
    get_target_property(done ${library} EPG_SMALL)
    if(NOT done)
      set_target_properties(${library} PROPERTIES EPG_SMALL TRUE)
      target_compile_options(${library} PRIVATE -ffunction-sections -fdata-sections ${options})
    endif()
  endforeach()
endfunction()

# Adds the port layer to target <name>.  SERVICE lists the sources that run the communication side on the platform;
# LIBRARIES lists the libraries that they need.
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

  set(communication epg_communication)
  foreach(middleware IN LISTS EPG_MIDDLEWARES)
    if(TARGET epg_middleware_${middleware})
      list(APPEND communication epg_middleware_${middleware})
    endif()
  endforeach()
  _epg_mcu_small(${communication})

  # An interface library: the sources must be compiled into the executable, not into the target's static library.
  add_library(${name}_port INTERFACE)
  file(GLOB of_both "${family}/${EPG_PLATFORM}/*.c")
  target_sources(${name}_port INTERFACE ${arg_SERVICE} ${of_both})
  target_link_libraries(${name}_port INTERFACE epg_mcu ${arg_LIBRARIES})
  cmake_language(CALL _epg_${EPG_FAMILY}_target "${name}")
  target_include_directories(${name} PRIVATE "${shared}/include" "${family}/include")
  target_link_libraries(${name} INTERFACE ${name}_port)
  set_target_properties(${name} PROPERTIES EPG_FAMILY "${EPG_FAMILY}")
endfunction()

# Adds an executable that contains target <name> and nothing else.  The source <main> has its main().
function(_epg_mcu_executable executable name main)
  add_executable(${executable} "${main}")
  target_compile_definitions(${executable} PRIVATE EPG_MCU_START=${name}_start)
  target_link_libraries(${executable} PRIVATE ${name})
  set_target_properties(${executable} PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON UNITY_BUILD OFF)
  _epg_optimize(${executable})
  get_target_property(family ${name} EPG_FAMILY)
  cmake_language(CALL _epg_${family}_executable "${executable}" "${name}")
endfunction()
