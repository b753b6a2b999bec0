# SPDX-License-Identifier: BSD-3-Clause
# Stands for rclcpp and tf2: their headers beside this folder, and a spin() that says frames to the node.
if(NOT TARGET rclcpp::rclcpp)
  add_library(rclcpp::rclcpp INTERFACE IMPORTED)
  target_include_directories(rclcpp::rclcpp INTERFACE ${CMAKE_CURRENT_LIST_DIR}/..)
  target_sources(rclcpp::rclcpp INTERFACE ${CMAKE_CURRENT_LIST_DIR}/../frames.cpp)
endif()
set(rclcpp_TARGETS rclcpp::rclcpp)
