# The target of both programs: a macro, since epg_add_target() sets variables of Zephyr's where it is called.
macro(jiwy_target board)
  epg_add_target(jiwy TCF ${board}_jiwy.tcf
    MODEL "${epg}/examples/jiwy/model" BINDINGS "${epg}/examples/jiwy/jiwy.bindings.yaml"
    PLANT "${epg}/examples/jiwy/plant" PLANT_BINDINGS "${epg}/examples/jiwy/plant.bindings.yaml"
    SET control.enable_at_start=true communication.middleware=xrce communication.console=true)
endmacro()
