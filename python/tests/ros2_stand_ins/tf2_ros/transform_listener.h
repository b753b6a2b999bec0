// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tf2_ros/buffer.h>

namespace tf2_ros {
struct TransformListener {
  explicit TransformListener(Buffer&) {}
};
}  // namespace tf2_ros
