# SPDX-License-Identifier: BSD-3-Clause
# Makes the target clearance::io when everything it needs is found; else clearance_io_missing names what is not.
# Included by our own build and by the installed package (there because of COMPONENTS io).

set(clearance_io_missing)

find_package(assimp CONFIG QUIET)
if(NOT TARGET assimp::assimp)
  list(APPEND clearance_io_missing assimp)
endif()
find_package(urdfdom CONFIG QUIET)
if(NOT TARGET urdfdom::urdfdom_model)
  list(APPEND clearance_io_missing urdfdom)
endif()
find_package(yaml-cpp CONFIG QUIET)
set(clearance_yaml yaml-cpp::yaml-cpp)  # its name since 0.8
if(NOT TARGET yaml-cpp::yaml-cpp)
  set(clearance_yaml yaml-cpp)
endif()
if(NOT TARGET ${clearance_yaml})
  list(APPEND clearance_io_missing yaml-cpp)
endif()
find_path(CLEARANCE_STB_INCLUDE_DIR stb_image.h PATH_SUFFIXES stb)
find_path(CLEARANCE_XXHASH_INCLUDE_DIR xxhash.h)
find_path(CLEARANCE_LZF_INCLUDE_DIR liblzf/lzf.h)
find_library(CLEARANCE_LZF_LIBRARY lzf)
mark_as_advanced(CLEARANCE_STB_INCLUDE_DIR CLEARANCE_XXHASH_INCLUDE_DIR CLEARANCE_LZF_INCLUDE_DIR CLEARANCE_LZF_LIBRARY)
if(NOT CLEARANCE_STB_INCLUDE_DIR)
  list(APPEND clearance_io_missing stb)
endif()
if(NOT CLEARANCE_XXHASH_INCLUDE_DIR)
  list(APPEND clearance_io_missing xxhash)
endif()
if(NOT CLEARANCE_LZF_INCLUDE_DIR OR NOT CLEARANCE_LZF_LIBRARY)
  list(APPEND clearance_io_missing liblzf)
endif()

if(NOT clearance_io_missing AND NOT TARGET clearance::io)
  add_library(clearance::io INTERFACE IMPORTED GLOBAL)
  target_include_directories(clearance::io SYSTEM INTERFACE ${CLEARANCE_STB_INCLUDE_DIR} ${CLEARANCE_XXHASH_INCLUDE_DIR}
                                                          ${CLEARANCE_LZF_INCLUDE_DIR})
  target_link_libraries(clearance::io INTERFACE clearance::clearance assimp::assimp urdfdom::urdfdom_model ${clearance_yaml}
                                                ${CLEARANCE_LZF_LIBRARY})
endif()
