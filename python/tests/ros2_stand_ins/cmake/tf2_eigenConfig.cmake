# SPDX-License-Identifier: BSD-3-Clause
set(tf2_eigen_TARGETS rclcpp::rclcpp)
