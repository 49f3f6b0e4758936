# What the platforms on the Raspberry Pi Pico share: the port layer as sources of whoever links a target, and how
# executables are made.  The Pico SDK is the user's: it is there when epg_add_target() is called, or the message says
# what to write.

# Adds the port layer to target <name>; <service> are the sources that say how core 0 serves communication.
function(_epg_pico_target name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SERVICE;LIBRARIES")
  _epg_pico_check("${name}" good)
  if(NOT good)
    return()
  endif()
  _epg_pico_in_ram("${name}")
  _epg_pico_library()
  include("${EPG_TARGETS_DIR}/libraries/pico_quadrature/library.cmake")

  # Its own interface library, because the sources must not be compiled into the static library.
  add_library(${name}_port INTERFACE)
  target_sources(${name}_port INTERFACE ${arg_SERVICE})
  target_link_libraries(${name}_port INTERFACE epg_pico ${arg_LIBRARIES})
  if(EPG_TRANSPORT STREQUAL "usb")
    _epg_pico_usb_library()
    target_link_libraries(${name}_port INTERFACE epg_pico_usb)
  endif()
  target_include_directories(${name} PRIVATE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/include")
  target_link_libraries(${name} INTERFACE ${name}_port)
endfunction()

# Sets <result> to FALSE after an error when the Pico SDK is not there, or is there for another board.
function(_epg_pico_check name result)
  set(${result} FALSE PARENT_SCOPE)
  set(board "${EPG_BOARD_pico_sdk}")
  if(NOT TARGET pico_runtime)
    _epg_find_sdk(sdk pico_sdk)
    set(found "")
    if(NOT sdk)
      set(found "\n${sdk_PROBLEM}")
    endif()
    message(SEND_ERROR "epg_add_target(${name}): its target is built with the Raspberry Pi Pico SDK, which is not initialised here.
Write at the top of ${CMAKE_SOURCE_DIR}/CMakeLists.txt, in this order:
  set(PICO_BOARD ${board} CACHE STRING \"Board\")
  include(epg_import.cmake)
  epg_import_pico_sdk()        # or: include(pico_sdk_import.cmake)
  project(<name> C CXX ASM)
  pico_sdk_init()${found}")
    return()
  endif()
  if(PICO_SDK_VERSION_STRING VERSION_LESS 2.0.0)
    _epg_data_folder(data)
    file(READ "${data}/targets/tools/pico_sdk.json" json)
    _epg_remedy(remedy "${json}")
    message(SEND_ERROR "epg_add_target(${name}): the Pico SDK in ${PICO_SDK_PATH} is ${PICO_SDK_VERSION_STRING}; EPG needs 2.0.0 or newer.\n${remedy}")
    return()
  endif()
  if(PICO_PLATFORM MATCHES "riscv" OR PICO_PLATFORM STREQUAL "host")
    message(SEND_ERROR "epg_add_target(${name}): EPG runs on the Arm cores only, and PICO_PLATFORM is ${PICO_PLATFORM}; take it out of the configuration of CMake")
    return()
  endif()
  if(NOT PICO_BOARD STREQUAL board)
    message(SEND_ERROR "epg_add_target(${name}): its target is for the board '${board}', and PICO_BOARD is '${PICO_BOARD}'.
Configure with -DPICO_BOARD=${board} in a build folder of its own, or choose the .tcf of a target for '${PICO_BOARD}'.")
    return()
  endif()
  set(${result} TRUE PARENT_SCOPE)
endfunction()

# Puts code and tables of the control cycle into RAM.
#
# The linker scripts of the Pico SDK place text and constants in flash, except those of archives whose name ends in
# libm.a, libgcc.a or (in part) libc.a: these they place in RAM, as "floating point and time critical code".  The model,
# the tables and the runtime are floating-point and time-critical code too, so their archives get names that end so.
# That needs no linker script of our own, in any type of binary, and leaves the linker free to drop what is not used.
# in_ram.ld stops the link when a linker script has other ideas.
function(_epg_pico_in_ram name)
  foreach(library ${name} epg_runtime ${EPG_MODELS})
    get_target_property(done ${library} EPG_IN_RAM)
    if(NOT done)
      set_target_properties(${library} PROPERTIES OUTPUT_NAME "${library}_libm" EPG_IN_RAM TRUE)
      target_compile_options(${library} PRIVATE -ffunction-sections -fdata-sections)
      if(TARGET ${library}_export)
        target_compile_options(${library}_export PRIVATE -ffunction-sections -fdata-sections)
      endif()
    endif()
  endforeach()
endfunction()

# The port layer that both platforms share.
function(_epg_pico_library)
  if(TARGET epg_pico)
    return()
  endif()
  set(folder "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
  file(GLOB sources "${folder}/src/*.c")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${folder}/src")
  add_library(epg_pico INTERFACE)
  target_sources(epg_pico INTERFACE ${sources})
  target_include_directories(epg_pico INTERFACE "${folder}/include" "${folder}/src")
  target_link_libraries(epg_pico INTERFACE
    EPG::pico_quadrature pico_runtime pico_runtime_init pico_multicore pico_flash
    hardware_clocks hardware_exception hardware_flash hardware_gpio hardware_irq hardware_pwm hardware_sync
    hardware_timer hardware_watchdog)
  target_compile_definitions(epg_pico INTERFACE
    # What the control cycle calls of the SDK lies in RAM too.
    PICO_DOUBLE_IN_RAM=1 PICO_FLOAT_IN_RAM=1 PICO_DIVIDER_IN_RAM=1 PICO_INT64_OPS_IN_RAM=1 PICO_BITS_IN_RAM=1
    PICO_MEM_IN_RAM=1
    # NaN stays NaN where the RP2040's ROM routines can do that.
    PICO_DOUBLE_PROPAGATE_NANS=1
    # An overflowing stack is a HardFault, which makes outputs safe.
    PICO_USE_STACK_GUARDS=1
    # Core 1 is EPG's, with a stack of its own: multicore_launch_core1() of the user panics.
    PICO_CORE1_STACK_SIZE=0)
  target_link_options(epg_pico INTERFACE
    LINKER:--wrap=panic LINKER:--wrap=__assert_func LINKER:--wrap=_exit "${folder}/in_ram.ld")
  set_property(TARGET epg_pico APPEND PROPERTY INTERFACE_LINK_DEPENDS "${folder}/in_ram.ld")
endfunction()

# The transport over USB: its own TinyUSB device, so it excludes the SDK's stdio over USB.
function(_epg_pico_usb_library)
  if(TARGET epg_pico_usb)
    return()
  endif()
  if(NOT TARGET tinyusb_device_unmarked)
    message(SEND_ERROR "EPG: the transport 'usb' needs TinyUSB, which the Pico SDK in ${PICO_SDK_PATH} lacks.\nGet it: git -C \"${PICO_SDK_PATH}\" submodule update --init lib/tinyusb")
    add_library(epg_pico_usb INTERFACE)
    return()
  endif()
  set(folder "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/usb")
  add_library(epg_pico_usb INTERFACE)
  target_sources(epg_pico_usb INTERFACE "${folder}/descriptors.c" "${folder}/reset.c" "${folder}/serial.c")
  target_include_directories(epg_pico_usb INTERFACE "${folder}/include")
  target_link_libraries(epg_pico_usb INTERFACE tinyusb_device_unmarked pico_unique_id pico_usb_reset_interface_headers)
endfunction()

# An executable that holds target <name> and nothing else; <main> is its main().
function(_epg_pico_executable executable name main)
  _epg_find_picotool()
  add_executable(${executable} "${main}")
  target_compile_definitions(${executable} PRIVATE EPG_PICO_START=${name}_start)
  target_link_libraries(${executable} PRIVATE ${name})
  set_target_properties(${executable} PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON)
  pico_set_binary_type(${executable} copy_to_ram)
  pico_enable_stdio_uart(${executable} 0)
  pico_enable_stdio_usb(${executable} 0)
  pico_add_extra_outputs(${executable})
endfunction()
