// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/scene_mesh.hpp>

namespace clearance::io {

/// The colour of a distance in metres: red at 0 and inside, then yellow, green (half way) and cyan, and blue from `far`
/// on.
inline colour distance_colour(double distance, double far) {
  const double along = std::clamp(4 * distance / far, 0.0, 4.0);
  const auto part = [](double value) { return float(std::clamp(value, 0.0, 1.0)); };
  return {part(2 - along), std::min(part(along), part(4 - along)), part(along - 2), 1};
}

}  // namespace clearance::io
