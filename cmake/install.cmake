# What `cmake --install` puts where: the programs, what the gallery draws, and the library for
# programs that say find_package(inktrace) or ask pkg-config.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# The library in one file: nothing that it is made of has to be found or linked by others.
add_library(inktrace-shared SHARED $<TARGET_OBJECTS:inktrace>)
set_target_properties(inktrace-shared PROPERTIES
    OUTPUT_NAME inktrace EXPORT_NAME inktrace
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    LINK_DEPENDS ${PROJECT_SOURCE_DIR}/src/api/exports.map)
target_link_libraries(inktrace-shared PRIVATE inktrace inktrace_options)
target_link_options(inktrace-shared PRIVATE
    -Wl,--version-script=${PROJECT_SOURCE_DIR}/src/api/exports.map)
target_include_directories(inktrace-shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(inktrace-shared INTERFACE cxx_std_20)

install(TARGETS inktrace-cli)
install(FILES docs/man/inktrace.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
if(INKTRACE_VIEWER)
    install(TARGETS inktrace-view)
    install(FILES docs/man/inktrace-view.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()
install(FILES LICENSE CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(TARGETS inktrace-shared EXPORT inktrace)
install(DIRECTORY include/inktrace DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY scenes samples DESTINATION ${CMAKE_INSTALL_DATADIR}/inktrace)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/inktrace)
install(EXPORT inktrace NAMESPACE inktrace:: FILE inktraceConfig.cmake DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/inktraceConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/inktraceConfigVersion.cmake DESTINATION ${package})

# And for pkg-config. The prefix is told from where the file lies, which may be moved.
set(pkgconfig ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH prefix_from_pkgconfig /prefix/${pkgconfig} /prefix)
configure_file(cmake/inktrace.pc.in inktrace.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/inktrace.pc DESTINATION ${pkgconfig})
