# What `cmake --install` puts where. systemd finds the units below /usr and below /usr/local.
install(TARGETS canopen-gateway RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY config/profiles/ DESTINATION ${CMAKE_INSTALL_DATADIR}/canopen-gateway/profiles
  FILES_MATCHING PATTERN "*.toml")
install(FILES README.md CHANGELOG.md LICENSE config/gateway.example.toml systemd/80-can.network
  DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md")

file(READ systemd/canopen-gateway.service unit)
string(REPLACE "/usr/bin/" "${CMAKE_INSTALL_FULL_BINDIR}/" unit "${unit}")
file(WRITE "${CMAKE_BINARY_DIR}/canopen-gateway.service" "${unit}")
install(FILES "${CMAKE_BINARY_DIR}/canopen-gateway.service" DESTINATION lib/systemd/system)
install(FILES systemd/canopen-gateway.sysusers DESTINATION lib/sysusers.d RENAME canopen-gateway.conf)
install(FILES systemd/60-canopen-gateway.sysctl.conf DESTINATION lib/sysctl.d RENAME 60-canopen-gateway.conf)
