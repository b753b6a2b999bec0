# SPDX-License-Identifier: BSD-3-Clause
# The generators that Debian has.
foreach(package ament_cmake_core rosidl_cmake rosidl_generator_c rosidl_generator_cpp)
  find_package(${package} REQUIRED)
endforeach()
