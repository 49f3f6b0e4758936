# SPDX-License-Identifier: Apache-2.0
# Targets in the simulation of a system: shared objects that the program of the system loads.

# _epg_simulator_systems(<result>)
#
# Sets <result> to the folders of sources for the system of this build; to "" if it is a microcontroller.
function(_epg_simulator_systems result)
  set(systems posix elsewhere) # such as macOS
  if(WIN32)
    set(systems windows)
  elseif(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    set(systems posix linux)
  elseif(CMAKE_SYSTEM_NAME STREQUAL "PICO" OR NOT UNIX) # the Pico SDK includes Platform/UnixPaths, which sets UNIX
    set(systems "")
  endif()
  set(${result} "${systems}" PARENT_SCOPE)
endfunction()

# Makes the library epg_simulator, the main() of the programs that simulate systems, once for all.
function(_epg_simulator_library)
  if(TARGET epg_simulator)
    return()
  endif()
  set(here "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
  set(host "${here}/../host")
  _epg_simulator_systems(systems)
  list(TRANSFORM systems REPLACE "(.+)" "${here}/simulator/\\1/*.c" OUTPUT_VARIABLE patterns)
  file(GLOB sources CONFIGURE_DEPENDS "${here}/simulator/*.c" ${patterns})
  add_library(epg_simulator STATIC EXCLUDE_FROM_ALL ${sources}
    "${host}/src/files/files.c" "${host}/src/files/number.c" "${host}/src/files/setpoints.c" "${host}/src/files/trace.c"
    "${host}/src/loop/diverged.c" "${host}/src/program/interface.c")
  target_include_directories(epg_simulator PUBLIC "${here}/include" "${host}/include" PRIVATE "${host}/src" "${here}/simulator")
  target_link_libraries(epg_simulator PUBLIC epg_runtime ${CMAKE_DL_LIBS} m)
  target_compile_definitions(epg_simulator PRIVATE _POSIX_C_SOURCE=200809L)
  _epg_compiler_options(epg_simulator)
endfunction()

# _epg_simulated_module(<module> <symbol> <library> <source>...)
#
# Makes a shared object with one visible <symbol>.  All other symbols are its own, also where another shared object has the
# same names: the linker hides the symbols of static libraries.
function(_epg_simulated_module module symbol library)
  set(link "-Wl,--exclude-libs,ALL,-Bsymbolic,-z,defs")
  set(exported "visibility(\"default\")")
  if(WIN32)
    set(link -static-libgcc) # then the shared object finds all libraries without the folders of GCC
    set(exported dllexport)
  elseif(APPLE)
    set(link "-Wl,-exported_symbol,_${symbol}")
  endif()
  set(here "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
  add_library(${module} MODULE EXCLUDE_FROM_ALL ${ARGN})
  target_include_directories(${module} PRIVATE "${here}/include" "${here}/../host/include" "${here}/../host/src")
  target_link_libraries(${module} PRIVATE ${library} ${link})
  set_target_properties(${module} PROPERTIES PREFIX "" SUFFIX ".so" LIBRARY_OUTPUT_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}"
    C_VISIBILITY_PRESET hidden)
  _epg_compiler_options(${module})
  target_compile_definitions(${module} PRIVATE _POSIX_C_SOURCE=200809L "EPG_EXPORTED=${exported}")
endfunction()

# Compiles a library for shared objects.
function(_epg_simulated_library library)
  foreach(part ${library} ${library}_export)
    if(TARGET ${part})
      set_target_properties(${part} PROPERTIES POSITION_INDEPENDENT_CODE ON)
      # Otherwise static objects of C++ templates would be one for all shared objects.
      target_compile_options(${part} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-gnu-unique>)
    endif()
  endforeach()
endfunction()

# Called by epg_add_system() for each target: makes <name>_unit, and <name>_plant_unit if the target has a plant.
function(_epg_simulated_target name)
  set(here "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
  set(host "${here}/../host/src")
  _epg_simulator_library()
  target_include_directories(${name} PUBLIC "${here}/include" "${here}/../host/include")
  foreach(library epg_runtime epg_communication epg_variables ${name} ${EPG_MODELS})
    _epg_simulated_library(${library})
  endforeach()
  set(time posix/monotonic.c elsewhere/system.c) # only simulated time is used
  if(WIN32)
    set(time windows/system.c)
  endif()
  list(TRANSFORM time PREPEND "${host}/port/")
  _epg_simulated_module(${name}_unit epg_unit ${name} "${here}/src/unit.c" "${host}/port/clock.c" "${host}/port/port.c" ${time})
  target_link_libraries(${name}_unit PRIVATE $<$<BOOL:${WIN32}>:winmm>)
  target_compile_definitions(${name}_unit PRIVATE EPG_UNIT_HOST=${name}_host EPG_UNIT_PLANT=${name}_unit_plant)
  if(TARGET ${name}_plant)
    _epg_simulated_plant(${name}_plant)
  endif()
endfunction()

# Called for the plant of a target and for that of a system: makes <library>_unit of the library of a model.
function(_epg_simulated_plant library)
  foreach(part epg_variables ${library})
    _epg_simulated_library(${part})
  endforeach()
  _epg_simulated_module(${library}_unit epg_plant_module ${library} "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/plant.c")
  target_link_libraries(${library}_unit PRIVATE epg_runtime)
  target_compile_definitions(${library}_unit PRIVATE EPG_PLANT=${library} "EPG_PLANT_HEADER=\"${library}.h\"")
endfunction()

# Called by epg_add_executable().
function(_epg_simulated_executable executable name)
  message(SEND_ERROR "epg_add_executable(${executable}): '${name}' is for the simulation of a system: use epg_add_system()")
endfunction()
