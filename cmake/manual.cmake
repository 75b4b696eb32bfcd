# Manual pages and completion, made by the program of its own tables. Where it is built for another machine than this one,
# a program built for this one is asked: -DGATEWAY_NATIVE_PROGRAM=PATH.
if(GATEWAY_SANITIZE)
  return()
endif()
set(GATEWAY_NATIVE_PROGRAM "" CACHE FILEPATH "A canopen-gateway of this version that runs here")
set(program canopen-gateway)
if(GATEWAY_NATIVE_PROGRAM)
  set(program "${GATEWAY_NATIVE_PROGRAM}")
endif()
set(GATEWAY_MANUAL_DIR "${PROJECT_BINARY_DIR}/manual")
file(MAKE_DIRECTORY "${GATEWAY_MANUAL_DIR}")
add_custom_command(
  OUTPUT "${GATEWAY_MANUAL_DIR}/canopen-gateway.1" "${GATEWAY_MANUAL_DIR}/gateway.toml.5"
    "${GATEWAY_MANUAL_DIR}/canopen-gateway.bash"
  COMMAND ${program} manual commands > canopen-gateway.1
  COMMAND ${program} manual configuration > gateway.toml.5
  COMMAND ${program} manual completion > canopen-gateway.bash
  DEPENDS canopen-gateway
  WORKING_DIRECTORY "${GATEWAY_MANUAL_DIR}"
  VERBATIM)
add_custom_target(manual ALL
  DEPENDS "${GATEWAY_MANUAL_DIR}/canopen-gateway.1" "${GATEWAY_MANUAL_DIR}/gateway.toml.5"
    "${GATEWAY_MANUAL_DIR}/canopen-gateway.bash")
