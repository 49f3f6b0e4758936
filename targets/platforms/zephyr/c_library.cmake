# SPDX-License-Identifier: Apache-2.0
# The C library of a toolchain that Zephyr does not know well enough.
#
# Models need a complete <math.h>.  With ZEPHYR_TOOLCHAIN_VARIANT=gnuarmemb Zephyr takes newlib, and that of Debian is built
# without the locks that Zephyr implements ("Retargetable locking must be enabled").  Debian's picolibc serves, but Zephyr
# does not look for it: TOOLCHAIN_HAS_PICOLIBC says that it is there.  sysbuild hands no such setting on to its images, so
# each target sets its own.
function(_epg_zephyr_find_c_library)
  _epg_zephyr_value(variant ZEPHYR_TOOLCHAIN_VARIANT)
  _epg_zephyr_value(folder GNUARMEMB_TOOLCHAIN_PATH)
  if(DEFINED TOOLCHAIN_HAS_PICOLIBC OR NOT variant STREQUAL "gnuarmemb" OR folder STREQUAL "")
    return()
  endif()
  find_program(compiler arm-none-eabi-gcc PATHS "${folder}/bin" NO_DEFAULT_PATH NO_CACHE)
  if(NOT compiler)
    return() # Zephyr says so
  endif()
  set(header "${CMAKE_BINARY_DIR}/CMakeFiles/epg/newlib_locks.c")
  file(CONFIGURE OUTPUT "${header}" CONTENT
    "#include <newlib.h>\n#ifndef _RETARGETABLE_LOCKING\n#error no locks\n#endif\n" @ONLY)
  execute_process(COMMAND "${compiler}" -fsyntax-only "${header}" RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  execute_process(COMMAND "${compiler}" -print-file-name=picolibc.specs
    OUTPUT_VARIABLE specs ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(failed AND EXISTS "${specs}")
    set(TOOLCHAIN_HAS_PICOLIBC ON CACHE BOOL "True if toolchain supports picolibc")
  elseif(failed)
    message(WARNING "EPG: newlib of ${compiler} is built without the locks that Zephyr needs.
If the build stops with 'Retargetable locking must be enabled': apt install picolibc-arm-none-eabi")
  endif()
endfunction()
