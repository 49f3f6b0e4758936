# SPDX-License-Identifier: Apache-2.0
# The library of the middleware micro_ros: a folder with libmicroros.a and include/, as micro-ROS's build tools make it.
# The library is built for one processor, one transport and fixed sizes of its pools, so it is not fetched or built
# here.

function(_epg_middleware_micro_ros library)
  _epg_find_sdk(folder micro_ros)
  if(NOT folder)
    message(FATAL_ERROR "Middleware 'micro_ros' needs libmicroros. ${folder_PROBLEM}")
  endif()
  if(NOT EXISTS "${folder}/libmicroros.a")
    message(FATAL_ERROR "Middleware 'micro_ros' needs libmicroros: there is no ${folder}/libmicroros.a")
  endif()
  if(NOT TARGET epg_micro_ros)
    # Since ROS 2 Humble, each package has its own folder below include/; before, all packages shared it.
    set(headers "${folder}/include")
    file(GLOB packages LIST_DIRECTORIES true "${folder}/include/*")
    foreach(package IN LISTS packages)
      get_filename_component(name "${package}" NAME)
      if(IS_DIRECTORY "${package}/${name}")
        list(APPEND headers "${package}")
      endif()
    endforeach()
    add_library(epg_micro_ros INTERFACE)
    target_include_directories(epg_micro_ros SYSTEM INTERFACE ${headers})
    target_link_libraries(epg_micro_ros INTERFACE "${folder}/libmicroros.a")
    # Only micro-ROS's rcutils, not that of ROS 2 for computers, has a function to set the default allocator of rcl.
    # Timeouts of a single publisher or context exist since Humble.
    _epg_micro_ros_feature("${folder}" rcutils/allocator.h rcutils_set_default_allocator DEFAULT_ALLOCATOR)
    _epg_micro_ros_feature("${folder}" rmw_microros/timing.h rmw_uros_set_publisher_session_timeout TIMEOUTS)
    if(CMAKE_SYSTEM_NAME MATCHES "^(Generic|PICO)$")
      target_compile_definitions(epg_micro_ros INTERFACE EPG_MICRO_ROS_CLOCK)
    endif()
  endif()
  target_link_libraries(${library} PUBLIC epg_micro_ros) # generated code defines rcl's objects, and checks the pools
  set_target_properties(${library} PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON)
endfunction()

# Defines EPG_MICRO_ROS_<feature> if <header> of libmicroros declares <symbol>.
function(_epg_micro_ros_feature folder header symbol feature)
  file(GLOB found "${folder}/include/${header}" "${folder}/include/*/${header}")
  foreach(file IN LISTS found)
    file(STRINGS "${file}" lines REGEX "${symbol}")
    if(lines)
      target_compile_definitions(epg_micro_ros INTERFACE EPG_MICRO_ROS_${feature})
    endif()
  endforeach()
endfunction()
