# SPDX-License-Identifier: Apache-2.0
# The library of the middleware dds: CycloneDDS 0.10, from Debian's or Ubuntu's package, or from ROS 2 Jazzy, whose
# environment adds it to CMAKE_PREFIX_PATH.  Later versions have another interface for messages without a described
# type.

function(_epg_middleware_dds library)
  if(NOT TARGET CycloneDDS::ddsc)
    find_package(CycloneDDS CONFIG QUIET)
    if(NOT CycloneDDS_FOUND)
      _epg_find_sdk(folder cyclonedds)
      if(NOT folder)
        message(FATAL_ERROR "${folder_PROBLEM}")
      endif()
      set(CycloneDDS_DIR "${folder}" CACHE PATH "Folder of CycloneDDSConfig.cmake" FORCE)
      find_package(CycloneDDS CONFIG REQUIRED)
    endif()
    if(NOT CycloneDDS_VERSION MATCHES "^0[.]10[.]")
      message(FATAL_ERROR
        "${CycloneDDS_DIR} holds CycloneDDS ${CycloneDDS_VERSION}; EPG's middleware 'dds' needs 0.10.")
    endif()
    # Other folders than the first one that finds the package must be able to link it, too.
    set_target_properties(CycloneDDS::ddsc PROPERTIES IMPORTED_GLOBAL TRUE)
  endif()
  target_link_libraries(${library} PRIVATE CycloneDDS::ddsc)
  target_compile_definitions(epg_communication PUBLIC EPG_TYPE_HASHES=1) # announced to other nodes
  # CycloneDDS's headers use `asm`, which is not a keyword of C11.
  target_compile_definitions(${library} PRIVATE asm=__asm__)
  set_target_properties(${library} PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON)
endfunction()
