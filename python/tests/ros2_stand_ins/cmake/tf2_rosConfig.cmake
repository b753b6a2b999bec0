# SPDX-License-Identifier: BSD-3-Clause
set(tf2_ros_TARGETS rclcpp::rclcpp)
