# The second image of the same build.
ExternalZephyrProject_Add(
  APPLICATION tilt
  SOURCE_DIR ${APP_DIR}/tilt
  BOARD nucleo_h743zi)
