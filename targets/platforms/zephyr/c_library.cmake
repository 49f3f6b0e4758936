# SPDX-License-Identifier: Apache-2.0
# The choice of the C library for the toolchain `gnuarmemb`.
#
# Models need a complete <math.h>.  With ZEPHYR_TOOLCHAIN_VARIANT=gnuarmemb Zephyr uses newlib.  Debian's newlib is
# built without the locks that Zephyr implements, and the build stops ("Retargetable locking must be enabled").
# Debian's picolibc works, but Zephyr does not search for it.  TOOLCHAIN_HAS_PICOLIBC makes Zephyr use it.  sysbuild
# does not pass this setting to its images, so each target sets it.
#
# Sets TOOLCHAIN_HAS_PICOLIBC in the cache if newlib lacks the locks and the toolchain has picolibc.  Warns if it has
# neither.
function(_epg_zephyr_find_c_library)
  _epg_zephyr_value(variant ZEPHYR_TOOLCHAIN_VARIANT)
  _epg_zephyr_value(folder GNUARMEMB_TOOLCHAIN_PATH)
  if(DEFINED TOOLCHAIN_HAS_PICOLIBC OR NOT variant STREQUAL "gnuarmemb" OR folder STREQUAL "")
    return()
  endif()
  find_program(compiler arm-none-eabi-gcc PATHS "${folder}/bin" NO_DEFAULT_PATH NO_CACHE)
  if(NOT compiler)
    return() # Zephyr reports this error
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
