// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How a distance changes as its part moves, from the witness, without another query. io/jacobian.hpp continues to
// joints.

#include <clearance/result.hpp>

#include <span>
#include <vector>

namespace clearance {

/// Whether a distance has a gradient.
enum class gradient_state : std::uint8_t {
  known,
  no_data,  ///< There is no witness.
  at_zero,  ///< The distance is exactly 0: on a surface, or inside a part of triangles, where moving changes nothing.
  no_direction,  ///< There is no normal: at the centre of a sphere.
};

inline const char* to_string(gradient_state s) {
  constexpr const char* names[] = {"known", "no_data", "at_zero", "no_direction"};
  return names[int(s)];
}

/// The gradient of a distance with respect to the twist of its part, in world axes; plain data that a kernel may write.
/// NaN unless `state` is known. With respect to the point the gradient is the witness's normal.
struct pose_gradient {
  gradient_state state = gradient_state::no_data;
  /// What the velocity of the part at `about` does to the distance, in metres per metre.
  vec3 linear = {not_a_number, not_a_number, not_a_number};
  /// What the part's angular velocity does to the distance, in metres per radian.
  vec3 angular = {not_a_number, not_a_number, not_a_number};
  position about = {0, 0, 0};  ///< The place, in world coordinates, whose velocity is meant.

  CLEARANCE_HD explicit operator bool() const { return state == gradient_state::known; }
  /// How fast the distance grows, in metres per second, if the part moves with `velocity` at `about` (m/s) and turns
  /// (rad/s).
  CLEARANCE_HD real along(vec3 velocity, vec3 turning) const { return dot(linear, velocity) + dot(angular, turning); }
};

/// The gradient of a least distance: of a min_distance_result or a part_witness. If several pairs are equally near, it
/// is that of the witness. `about` is in world coordinates, for example the part's origin.
template <class Witness>
  requires requires(const Witness& w) { w.distance, w.part, w.nearest, w.normal; }
CLEARANCE_HD pose_gradient gradient(const Witness& w, position about) {
  pose_gradient g;
  g.about = about;
  if (w.part == none || !(absolute(w.distance) < infinity)) return g;
  g.state = w.distance == 0             ? gradient_state::at_zero
            : w.normal == vec3{0, 0, 0} ? gradient_state::no_direction
                                        : gradient_state::known;
  if (!g) return g;
  // The distance grows by -normal . (v + w x arm): the part's surface moves and the point stays.
  const double x = w.nearest.x - about.x, y = w.nearest.y - about.y, z = w.nearest.z - about.z;
  const position n{w.normal.x, w.normal.y, w.normal.z};
  g.linear = -w.normal;
  g.angular = {real(fma(z, n.y, -(y * n.z))), real(fma(x, n.z, -(z * n.x))), real(fma(y, n.x, -(x * n.y)))};
  return g;
}
template <class Witness>
pose_gradient gradient(const Witness& w, const Eigen::Vector3d& about) {
  return gradient(w, position{about.x(), about.y(), about.z()});
}

/// A minimum without corners: `-temperature log(sum exp(-distance / temperature))`. Never above the least distance, and
/// at most `temperature log(parts)` below it. Its gradient is the sum of the parts' gradients times `weights`.
struct smooth_minimum {
  double value = infinity;      ///< Metres; infinite if no part has a point.
  std::vector<double> weights;  ///< One per part, with the sum 1; all 0 if the value is infinite.
};

/// Takes every part's minimum; `temperature` is in metres. Throws std::invalid_argument if that is not above 0 and
/// finite, or if a distance is NaN or -infinity.
inline smooth_minimum smooth_minimum_of(std::span<const part_minimum> minima, double temperature) {
  if (!(temperature > 0 && temperature < double(infinity)))
    throw std::invalid_argument("clearance: a temperature is " + std::to_string(temperature) +
                                " m; it must be above 0 and finite");
  smooth_minimum smooth{infinity, std::vector<double>(minima.size(), 0.0)};
  double least = infinity, sum = 0;
  for (const part_minimum& m : minima) {
    if (!(m.distance > -infinity))
      throw std::invalid_argument("clearance: a part's distance is not a number, or below all numbers");
    least = std::min(least, double(m.distance));
  }
  if (least == double(infinity)) return smooth;
  for (std::size_t k = 0; k < minima.size(); ++k)
    sum += smooth.weights[k] = std::exp((least - double(minima[k].distance)) / temperature);
  for (double& w : smooth.weights) w /= sum;
  // The least one's term is exactly 1, so the logarithm is not below 0.
  smooth.value = least - temperature * std::log(sum);
  return smooth;
}

}  // namespace clearance
