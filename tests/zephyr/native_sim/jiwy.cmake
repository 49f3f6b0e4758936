# The target of both programs.  A macro, because epg_add_target() sets variables of Zephyr in the scope of its caller.
macro(jiwy_target board)
  epg_add_target(jiwy TCF ${board}_jiwy.tcf
    MODEL "${epg}/examples/jiwy/model" BINDINGS "${epg}/examples/jiwy/jiwy.bindings.yaml"
    PLANT "${epg}/examples/jiwy/plant" PLANT_BINDINGS "${epg}/examples/jiwy/plant.bindings.yaml"
    SET control.enable_at_start=true communication.middleware=xrce communication.console=true)
endmacro()
