# The cart as a target of `board`.  A macro, because epg_add_target() sets variables of Zephyr in its caller's scope.
get_filename_component(epg "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(cart "${CMAKE_CURRENT_LIST_DIR}")
set(EPG_PATH "${epg}")
include("${epg}/cmake/epg_import.cmake")
macro(cart_target board)
  epg_add_target(cart TCF "${cart}/cart.tcf" MODEL "${cart}/controller" BINDINGS "${cart}/cart.bindings.yaml"
    PLANT "${cart}/plant" PLANT_BINDINGS "${cart}/plant.bindings.yaml" SET target=${board})
endmacro()
