# SPDX-License-Identifier: BSD-3-Clause
# Finds what programs with clearance::io link besides; clearance_io_missing lists the missing Debian packages. Our own
# build includes this, and so does the installed package (for COMPONENTS io).

set(clearance_io_missing)

# Packages may name linker files that another package brings. Appends to `absent` the missing files that a target and
# its dependencies ask for.
function(clearance_io_link_files target absent)
  set(targets ${target})
  set(seen)
  set(lacking ${${absent}})
  while(targets)
    list(POP_FRONT targets next)
    list(APPEND seen ${next})
    get_target_property(links ${next} INTERFACE_LINK_LIBRARIES)
    foreach(link ${links})
      if(TARGET ${link} AND NOT link IN_LIST seen)
        list(APPEND targets ${link})
      elseif(link MATCHES "(^|:)(/[^<>]+)")  # it may stand in a generator expression
        set(file "${CMAKE_MATCH_2}")
        if(NOT EXISTS "${file}")
          list(APPEND lacking "${file}")
        endif()
      endif()
    endforeach()
  endwhile()
  list(REMOVE_DUPLICATES lacking)
  set(${absent} ${lacking} PARENT_SCOPE)
endfunction()

find_package(EXPAT QUIET)
if(NOT TARGET EXPAT::EXPAT)
  list(APPEND clearance_io_missing libexpat1-dev)
endif()
find_package(yaml-cpp CONFIG QUIET)
set(clearance_yaml yaml-cpp::yaml-cpp)  # its name since 0.8
if(NOT TARGET yaml-cpp::yaml-cpp)
  set(clearance_yaml yaml-cpp)
endif()
if(TARGET ${clearance_yaml})
  clearance_io_link_files(${clearance_yaml} clearance_io_missing)
else()
  list(APPEND clearance_io_missing libyaml-cpp-dev)
endif()
find_library(CLEARANCE_LZF_LIBRARY lzf)
mark_as_advanced(CLEARANCE_LZF_LIBRARY)
if(NOT CLEARANCE_LZF_LIBRARY)
  list(APPEND clearance_io_missing liblzf-dev)
elseif(NOT TARGET clearance::lzf)
  add_library(clearance::lzf UNKNOWN IMPORTED GLOBAL)
  set_target_properties(clearance::lzf PROPERTIES IMPORTED_LOCATION ${CLEARANCE_LZF_LIBRARY})
endif()
