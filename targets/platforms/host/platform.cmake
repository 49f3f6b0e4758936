# SPDX-License-Identifier: Apache-2.0
# The host platform: its port layer, which is the library EPG::host, and executables with EPG's main().

# Adds the library EPG::host, once for all targets.
function(_epg_host_library)
  if(TARGET epg_host)
    return()
  endif()
  set(folder "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
  set(systems posix realtime linux)
  if(WIN32)
    set(systems realtime windows)
  elseif(CMAKE_SYSTEM_NAME STREQUAL "Darwin")
    set(systems posix realtime macos)
  endif()
  list(TRANSFORM systems PREPEND "${folder}/src/*/" OUTPUT_VARIABLE parts)
  list(TRANSFORM parts APPEND "/*.c" OUTPUT_VARIABLE patterns)
  file(GLOB sources "${folder}/src/*/*.c" ${patterns})
  # The console by UDP searches for stops itself, also for a target whose middleware is not the console.
  set(console "${folder}/../../middlewares/console")
  list(APPEND sources "${console}/scan.c" "${console}/frame.c")
  file(GLOB folders "${folder}/src" "${folder}/src/*" ${parts})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folders})
  list(FILTER sources EXCLUDE REGEX "/main\\.c$")
  # A static library, unlike the port layers of microcontrollers, because its sources need no settings of an SDK.
  add_library(epg_host STATIC EXCLUDE_FROM_ALL ${sources})
  target_include_directories(epg_host PUBLIC "${folder}/include" PRIVATE "${folder}/src" "${console}")
  list(TRANSFORM systems PREPEND "${folder}/src/links/")
  target_include_directories(epg_host PRIVATE ${systems})
  target_link_libraries(epg_host PUBLIC epg_runtime "$<$<PLATFORM_ID:Linux>:-pthread>" $<$<NOT:$<BOOL:${WIN32}>>:m>
    $<$<BOOL:${WIN32}>:ws2_32> $<$<BOOL:${WIN32}>:winmm>)
  target_link_libraries(epg_runtime INTERFACE epg_host) # the runtime calls the port layer
  _epg_compiler_options(epg_host)
  target_compile_definitions(epg_host PRIVATE _POSIX_C_SOURCE=200809L $<$<PLATFORM_ID:Darwin>:_DARWIN_C_SOURCE>)
  add_library(EPG::host ALIAS epg_host)
endfunction()

# Called by epg_add_target(): links the port layer to target <name>.  Reports an error if the project is for another
# system.
function(_epg_host_target name)
  if(NOT CMAKE_SYSTEM_NAME MATCHES "^(Linux|Darwin|Windows)$")
    set_property(TARGET ${name} PROPERTY EPG_FAILED TRUE) # its executables need not report the same error again
    message(SEND_ERROR "epg_add_target(${name}): its target is 'host', a program for Linux, macOS or Windows, and this project is compiled for another system, such as a microcontroller (CMAKE_SYSTEM_NAME is ${CMAKE_SYSTEM_NAME}).
Choose the .tcf of a target for the board: 'epg targets' lists them. If there is none, write 'target: firmware' in the .tcf: your program then calls the control cycle and has the drivers (docs/any-firmware.md). For the controller alone, without pins and topics:
  epg_add_model(${name} MODEL <folder>)")
    return()
  endif()
  _epg_host_library()
  target_link_libraries(${name} PUBLIC epg_host)
endfunction()

# Called by epg_add_executable(): adds a program that runs target <name> and has its options on the command line, and the
# CMake target <name>_live, which runs it.
function(_epg_host_executable executable name)
  add_executable(${executable} "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/program/main.c")
  target_compile_definitions(${executable} PRIVATE EPG_HOST_TARGET=${name}_host)
  target_link_libraries(${executable} PRIVATE ${name})
  _epg_compiler_options(${executable})
  _epg_live_target("${name}" "${executable}")
endfunction()
