# SPDX-License-Identifier: Apache-2.0
# Finds EPG and the Pico SDK, in the versions that CMakeLists.txt sets. Include this file before project().
#
# The VS Code extension "Raspberry Pi Pico" recognises a project by a file of this name.
include("${CMAKE_CURRENT_LIST_DIR}/epg_import.cmake")
epg_use_versions(EPG ${epgVersion} PICO_SDK ${sdkVersion} ARM_GCC ${toolchainVersion} PICOTOOL ${picotoolVersion}
  FREERTOS_KERNEL "${freertosVersion}")
epg_import_pico_sdk()
