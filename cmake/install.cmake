# What `cmake --install` puts where. systemd finds the units below /usr and below /usr/local.
install(TARGETS canopen-gateway RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY config/profiles/ DESTINATION ${CMAKE_INSTALL_DATADIR}/canopen-gateway/profiles
  FILES_MATCHING PATTERN "*.toml")
# In the folders of the project: README.md names them so.
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES config/gateway.example.toml DESTINATION ${CMAKE_INSTALL_DOCDIR}/config)
install(FILES systemd/80-can.network DESTINATION ${CMAKE_INSTALL_DOCDIR}/systemd)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs FILES_MATCHING
  PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png")

file(READ systemd/canopen-gateway.service unit)
string(REPLACE "/usr/bin/" "${CMAKE_INSTALL_FULL_BINDIR}/" unit "${unit}")
string(REPLACE "/usr/share/doc/canopen-gateway/" "${CMAKE_INSTALL_FULL_DOCDIR}/" unit "${unit}")
file(WRITE "${CMAKE_BINARY_DIR}/canopen-gateway.service" "${unit}")
install(FILES "${CMAKE_BINARY_DIR}/canopen-gateway.service" DESTINATION lib/systemd/system)
install(FILES systemd/canopen-gateway.sysusers DESTINATION lib/sysusers.d RENAME canopen-gateway.conf)
install(FILES systemd/60-canopen-gateway.sysctl.conf DESTINATION lib/sysctl.d RENAME 60-canopen-gateway.conf)
