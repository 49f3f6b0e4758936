# SPDX-License-Identifier: Apache-2.0
# CycloneDDS 0.10: Debian's and Ubuntu's package, and ROS 2 Jazzy's, whose environment puts it on CMAKE_PREFIX_PATH.
# Later versions have other headers for messages that no generated code describes.

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
    # The folder that asked first is not the only one that links it.
    set_target_properties(CycloneDDS::ddsc PROPERTIES IMPORTED_GLOBAL TRUE)
  endif()
  target_link_libraries(${library} PRIVATE CycloneDDS::ddsc)
  # CycloneDDS's headers say `asm`, which is no word of C11.
  target_compile_definitions(${library} PRIVATE asm=__asm__)
  set_target_properties(${library} PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON)
endfunction()
