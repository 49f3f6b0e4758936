# SPDX-License-Identifier: Apache-2.0
# Any firmware: the program has its own main(), timer and drivers.  EPG adds libraries only, and changes no option of the
# program's compiler or linker.

# Called by epg_add_target(): links the port layer to target <name>.
function(_epg_firmware_target name)
  if(NOT TARGET epg_firmware)
    set(folder "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
    add_library(epg_firmware STATIC EXCLUDE_FROM_ALL "${folder}/src/firmware.c")
    target_include_directories(epg_firmware PUBLIC "${folder}/include")
    target_link_libraries(epg_firmware PUBLIC epg_runtime)
    _epg_compiler_options(epg_firmware)
  endif()
  target_link_libraries(${name} PUBLIC epg_firmware)
  # Models use sin() and other functions of the mathematical library.
  if(NOT MSVC)
    target_link_libraries(${name} PUBLIC m)
  endif()
endfunction()

# Called by epg_add_executable(), which cannot make a program without the user's main() and drivers.
function(_epg_firmware_executable executable name)
  message(FATAL_ERROR "epg_add_executable(${executable} EPG::${name}): a program with the target 'firmware' has a main() and drivers of its own. Link the target to your program instead:
  target_link_libraries(<your program> PRIVATE EPG::${name})
docs/any-firmware.md shows what the program calls and defines.")
endfunction()
