# SPDX-License-Identifier: Apache-2.0
# libmicroros as its builders leave it: a folder with libmicroros.a and include/.  It is built for one processor, one
# transport and pools of one size, so nothing is fetched or built here.

function(_epg_middleware_micro_ros library)
  _epg_find_sdk(folder micro_ros)
  if(NOT folder)
    message(FATAL_ERROR "Middleware 'micro_ros' needs libmicroros. ${folder_PROBLEM}")
  endif()
  if(NOT EXISTS "${folder}/libmicroros.a")
    message(FATAL_ERROR "Middleware 'micro_ros' needs libmicroros: there is no ${folder}/libmicroros.a")
  endif()
  if(NOT TARGET epg_micro_ros)
    # Since Humble each package has a folder of its own below include/; before, all shared it.
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
    # micro-ROS's own rcutils lets rcl's default allocator be set, that of ROS 2 for computers does not; timeouts of one
    # publisher or context came with Humble.
    _epg_micro_ros_feature("${folder}" rcutils/allocator.h rcutils_set_default_allocator DEFAULT_ALLOCATOR)
    _epg_micro_ros_feature("${folder}" rmw_microros/timing.h rmw_uros_set_publisher_session_timeout TIMEOUTS)
    if(CMAKE_SYSTEM_NAME MATCHES "^(Generic|PICO)$")
      target_compile_definitions(epg_micro_ros INTERFACE EPG_MICRO_ROS_CLOCK)
    endif()
  endif()
  target_link_libraries(${library} PUBLIC epg_micro_ros) # generated code holds rcl's objects, and looks at the pools
  set_target_properties(${library} PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON)
endfunction()

# Defines EPG_MICRO_ROS_<feature> when <header> of libmicroros declares <symbol>.
function(_epg_micro_ros_feature folder header symbol feature)
  file(GLOB found "${folder}/include/${header}" "${folder}/include/*/${header}")
  foreach(file IN LISTS found)
    file(STRINGS "${file}" lines REGEX "${symbol}")
    if(lines)
      target_compile_definitions(epg_micro_ros INTERFACE EPG_MICRO_ROS_${feature})
    endif()
  endforeach()
endfunction()
