# What `cmake --install` puts where. systemd finds the units below /usr and below /usr/local.
install(TARGETS canopen-gateway RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY config/profiles/ DESTINATION ${CMAKE_INSTALL_DATADIR}/canopen-gateway/profiles
  FILES_MATCHING PATTERN "*.toml")
install(FILES config/gateway.example.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/canopen-gateway
  RENAME gateway.toml.example)
install(FILES config/four-drives.example.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/canopen-gateway
  RENAME gateway.toml.four-drives)
# In the folders of the project: README.md names them so.
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES systemd/80-can.network systemd/can0.interfaces systemd/can@.service systemd/privileged-port.conf
  systemd/secrets.conf DESTINATION ${CMAKE_INSTALL_DOCDIR}/systemd)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs FILES_MATCHING
  PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png" PATTERN "*.yml" PATTERN "*.json")
if(GATEWAY_MANUAL_DIR)
  install(FILES "${GATEWAY_MANUAL_DIR}/canopen-gateway.1" DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES "${GATEWAY_MANUAL_DIR}/gateway.toml.5" DESTINATION ${CMAKE_INSTALL_MANDIR}/man5)
  install(FILES "${GATEWAY_MANUAL_DIR}/canopen-gateway.bash"
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME canopen-gateway)
endif()

foreach(kind service socket)
  file(READ systemd/canopen-gateway.${kind} unit)
  string(REPLACE "/usr/bin/" "${CMAKE_INSTALL_FULL_BINDIR}/" unit "${unit}")
  string(REPLACE "/usr/share/doc/canopen-gateway/" "${CMAKE_INSTALL_FULL_DOCDIR}/" unit "${unit}")
  string(REPLACE "/usr/share/canopen-gateway/" "${CMAKE_INSTALL_FULL_DATADIR}/canopen-gateway/" unit "${unit}")
  file(WRITE "${CMAKE_BINARY_DIR}/canopen-gateway.${kind}" "${unit}")
  install(FILES "${CMAKE_BINARY_DIR}/canopen-gateway.${kind}" DESTINATION lib/systemd/system)
endforeach()
install(FILES systemd/canopen-gateway.sysusers DESTINATION lib/sysusers.d RENAME canopen-gateway.conf)
install(FILES systemd/canopen-gateway.tmpfiles DESTINATION lib/tmpfiles.d RENAME canopen-gateway.conf)
install(FILES systemd/10-canopen-gateway.sysctl.conf DESTINATION lib/sysctl.d RENAME 10-canopen-gateway.conf)
