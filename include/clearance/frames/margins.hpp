// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From a margin in metres to limits on computed distances.

#include <clearance/frames/bracket.hpp>
#include <clearance/frames/clouds.hpp>

namespace clearance::frames {

/// A point may be within `margin` if its computed distance is at most this. All errors are on the safe side.
CLEARANCE_HD inline real may_be_within(double margin, const part_facts& facts, const float_error& error) {
  const double most = margin + slop(facts) + error.gap + error.here;
  return rounded_up(most / (most < 0 ? 1 + error.per_metre : 1 - error.per_metre));
}
/// A point is certainly within `margin` if its computed distance is at most this.
CLEARANCE_HD inline real is_within(double margin, const part_facts& facts, const float_error& error) {
  const double left = margin - double(facts.tolerance) - error.here;
  return rounded_down(left / (left < 0 ? 1 - error.per_metre : 1 + error.per_metre));
}

/// The largest computed distance that is at most `d_max` metres. Throws std::invalid_argument if that is NaN.
inline real largest_within(double d_max) {
  if (!(d_max == d_max)) throw std::invalid_argument("clearance: d_max is not a number");
  return rounded_down(d_max);
}

/// Throws std::invalid_argument if there is neither one margin nor one per part, or if one is NaN.
inline void check_margins(std::span<const double> margins, std::size_t parts) {
  if (margins.size() != 1 && margins.size() != parts)
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but " +
                                std::to_string(margins.size()) + " margins");
  for (std::size_t k = 0; k < margins.size(); ++k)
    if (!(margins[k] == margins[k]))
      throw std::invalid_argument("clearance: the margin of part " + std::to_string(k) + " is not a number");
}

/// What is known of a frame before a question is asked. Reused, it allocates only for more parts or clouds.
struct frame_ahead {
  cloud_frame frame;
  std::vector<std::uint32_t> first;    ///< The number of each cloud's first point.
  std::vector<real> reaches;           ///< How near a point must be to each part to matter, as the question says.
  std::size_t clouds = 0, points = 0;  ///< How many clouds there are, and points of all clouds.

  /// The facts of all clouds together.
  template <class Clouds>
  const frame_facts& facts_of(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> poses,
                              const Clouds& clouds) {
    first.clear();
    this->clouds = count_clouds(clouds);
    points = std::size_t(
        for_each_turn(frame, facts, poses, clouds, [&](const auto&, const turn& now) { first.push_back(now.first); }));
    return frame;
  }
};

/// The cloud and the point that a number through all clouds names.
struct cloud_point {
  std::uint32_t cloud, point;
};
/// `first` has the numbers of the first points of all `clouds`.
CLEARANCE_HD inline cloud_point place_of(std::uint32_t number, const std::uint32_t* first, std::uint32_t clouds) {
  std::uint32_t cloud = clouds - 1;
  while (first[cloud] > number) --cloud;
  return {cloud, number - first[cloud]};
}

}  // namespace clearance::frames
