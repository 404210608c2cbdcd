# What `cmake --install BUILD --prefix P` puts where, in three components (server, client, dev), and the three Debian
# packages that scripts/packages makes of them. The prefix is known only then: nothing that is installed was told of it
# before, but the unit and the manual pages, which are made at that moment.
include(CMakePackageConfigHelpers)
set(packaging ${CMAKE_SOURCE_DIR}/scripts/packaging)

install(TARGETS sim_server RUNTIME DESTINATION bin COMPONENT server)
install(TARGETS haptic_client RUNTIME DESTINATION bin COMPONENT client)
foreach(row "sim;server" "client;client")
  list(GET row 0 library)
  list(GET row 1 component)
  install(TARGETS palpate_${library}_shared EXPORT palpate
    LIBRARY DESTINATION lib COMPONENT ${component} NAMELINK_COMPONENT dev)
  set(library_name palpate-${library})
  configure_file(${packaging}/palpate.pc.in ${CMAKE_BINARY_DIR}/${library_name}.pc @ONLY)
  install(FILES ${CMAKE_BINARY_DIR}/${library_name}.pc DESTINATION lib/pkgconfig COMPONENT dev)
endforeach()

install(FILES protocol/c_interface/palpate.h DESTINATION include COMPONENT dev)
install(EXPORT palpate NAMESPACE palpate:: FILE palpateConfig.cmake DESTINATION lib/cmake/palpate COMPONENT dev)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/palpateConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/palpateConfigVersion.cmake DESTINATION lib/cmake/palpate COMPONENT dev)
install(FILES ${packaging}/palpate.3 DESTINATION share/man/man3 COMPONENT dev)

install(DIRECTORY configs/scenes configs/meshes DESTINATION share/palpate COMPONENT server)
install(FILES configs/README.md DESTINATION share/palpate COMPONENT server)
install(DIRECTORY configs/clients configs/trajectories configs/udev DESTINATION share/palpate COMPONENT client)

foreach(component server client dev)
  install(FILES ${packaging}/copyright DESTINATION share/doc/palpate-${component} COMPONENT ${component})
endforeach()

# A page for each program, from what it says of itself with --help, by Python, as it is installed: a build does without.
foreach(row "sim_server;server" "haptic_client;client")
  list(GET row 0 program)
  list(GET row 1 component)
  install(CODE "execute_process(COMMAND ${packaging}/man_page $<TARGET_FILE:${program}> ${CMAKE_BINARY_DIR}/${program}.1
    COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
  install(FILES ${CMAKE_BINARY_DIR}/${program}.1 DESTINATION share/man/man1 COMPONENT ${component})
endforeach()

# The unit names the program by its whole path. What an administrator changes lies in /etc for a package, else below the
# prefix.
install(CODE "
  set(etc \${CMAKE_INSTALL_PREFIX}/etc)
  if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
    set(etc /etc)
  endif()
  configure_file(${packaging}/palpate-server.service.in ${CMAKE_BINARY_DIR}/palpate-server.service @ONLY)
  configure_file(${packaging}/palpate-server.in ${CMAKE_BINARY_DIR}/palpate-server @ONLY)
  file(INSTALL ${CMAKE_BINARY_DIR}/palpate-server DESTINATION \${etc}/default)
  file(INSTALL ${CMAKE_BINARY_DIR}/palpate-server.service DESTINATION \${CMAKE_INSTALL_PREFIX}/lib/systemd/system)"
  COMPONENT server)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGE_VENDOR Palpate)
set(CPACK_PACKAGE_CONTACT "Palpate developers <palpate@localhost>")
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_SET_DESTDIR ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL server client dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_SERVER_PACKAGE_NAME palpate-server)
if(PALPATE_MPI)  # the same with `sim_server condense`, in its place
  set(CPACK_DEBIAN_SERVER_PACKAGE_NAME palpate-server-mpi)
  set(CPACK_DEBIAN_SERVER_PACKAGE_PROVIDES "palpate-server (= ${PROJECT_VERSION})")
  set(CPACK_DEBIAN_SERVER_PACKAGE_CONFLICTS palpate-server)
  set(CPACK_DEBIAN_SERVER_PACKAGE_REPLACES palpate-server)
  set(CPACK_DEBIAN_SERVER_PACKAGE_DEPENDS openmpi-bin)
endif()
set(CPACK_DEBIAN_CLIENT_PACKAGE_NAME palpate-client)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME palpate-dev)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_DEBIAN_SERVER_DESCRIPTION "deforms a finite-element organ and answers haptic clients with forces
The program sim_server, which serves a scene over UDP some 30 times a second, its
systemd unit, scenes with their meshes, and the library libpalpate-sim.")
set(CPACK_DEBIAN_CLIENT_DESCRIPTION "lets a person feel an organ that a server deforms
The program haptic_client, which extrapolates forces 500 times a second or more for
a force-feedback device, its configurations, and the library libpalpate-client.")
set(CPACK_DEBIAN_DEV_DESCRIPTION "Palpate from C, C++ and what calls C: headers and configurations
The header palpate.h, and what pkg-config and CMake need to know to build with
libpalpate-client and libpalpate-sim.")
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "palpate-server (= ${PROJECT_VERSION}), palpate-client (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA "${packaging}/conffiles;${packaging}/postinst")
include(CPack)
