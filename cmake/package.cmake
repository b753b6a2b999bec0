# SPDX-License-Identifier: BSD-3-Clause
# cpack makes clearance-dev_*.deb: headers and CMake files, for every architecture; and libclearance-io-dev_*.deb, the
# compiled components solid and io, where io's packages are installed.

# The version is in include/clearance/ground/config.hpp; package.xml, which other tools read, must have the same one.
file(STRINGS package.xml said REGEX "<version>")
if(NOT said MATCHES "<version>${PROJECT_VERSION}</version>")
  message(FATAL_ERROR "package.xml must say version ${PROJECT_VERSION}, as include/clearance/ground/config.hpp does")
endif()

# Dependencies come from scripts/lib.sh.
file(STRINGS scripts/lib.sh names REGEX "^packages_library=")
string(REGEX MATCHALL "[^ \"]+-dev" clearance_library_packages "${names}")
list(JOIN clearance_library_packages ", " clearance_library_packages)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ${clearance_library_packages})
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS libclearance-io-dev)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME clearance)
set(CPACK_PACKAGE_VENDOR "The clearance authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES OFF)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_COMPONENTS_ALL dev debian)
set(CPACK_COMPONENT_DEV_GROUP dev)
set(CPACK_COMPONENT_DEBIAN_GROUP dev)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME clearance-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
if(NOT CPACK_DEBIAN_PACKAGE_MAINTAINER)
  set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The clearance authors <clearance@example.org>")
endif()
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "distance of a robot from what its depth sensor sees")
set(CPACK_DEBIAN_DEV_DESCRIPTION
"clearance takes a robot's parts and a raw point cloud or depth image, new in
every frame, and gives the minimum distance with its witness and an interval
that certainly contains the true one, on the CPU and on an NVIDIA GPU.
.
This package has the C++20 and CUDA headers, and the files for CMake's
find_package. The components solid, which closes and packs meshes, and io,
which reads robots, meshes and clouds from files, are in libclearance-io-dev.")
if(TARGET clearance_io)
  list(APPEND CPACK_COMPONENTS_ALL io)
  set(CPACK_COMPONENT_IO_GROUP io)
  set(CPACK_DEBIAN_IO_PACKAGE_NAME libclearance-io-dev)
  set(CPACK_DEBIAN_IO_PACKAGE_DEPENDS
      "clearance-dev (= ${PROJECT_VERSION}-1), libexpat1-dev, libyaml-cpp-dev, liblzf-dev, libtbb-dev")
  set(CPACK_DEBIAN_IO_DESCRIPTION
"This package has the compiled components of clearance: solid, which closes
and packs meshes, and io, which reads and writes files of robots, meshes,
spheres, clouds and images.")
endif()

# Debian's files in /usr/share/doc, besides those of every installation.
find_program(CLEARANCE_GZIP gzip)
mark_as_advanced(CLEARANCE_GZIP)
if(CLEARANCE_GZIP)
  set(doc ${PROJECT_BINARY_DIR}/debian)
  string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
  file(WRITE ${doc}/changelog.Debian "clearance (${PROJECT_VERSION}-1) unstable; urgency=medium\n\n"
       "  * Made by CPack; changelog.gz says what is new.\n\n -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${date}\n")
  configure_file(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${doc}/changelog COPYONLY)
  execute_process(COMMAND ${CLEARANCE_GZIP} -9nf ${doc}/changelog ${doc}/changelog.Debian)
  install(FILES ${doc}/changelog.gz ${doc}/changelog.Debian.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/clearance-dev
          COMPONENT debian EXCLUDE_FROM_ALL)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/clearance-dev RENAME copyright
        COMPONENT debian EXCLUDE_FROM_ALL)
include(CPack)
