// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from all points that are not its own? Two questions, one after another.

#include <clearance/backends/readback.hpp>
#include <clearance/frames/mapped_clouds.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/self_filter.hpp>

namespace clearance {

/// A self_filter_result, and the least distance over all points that are not hidden; its state is about them alone.
struct filtered_distance {
  self_filter_result filter;
  min_distance_result rest;  ///< Hidden points are dropped as `masked`.
};

/// Says how far a robot is from what `filter` leaves. `own` is filtered out, such as an arm that a camera sees; `robot`
/// may be another one. Clouds that `on` cannot read are copied once. Throws std::invalid_argument as `ask`.
template <class On, class Robot, class Poses, class Own, class OwnPoses, class Clouds>
filtered_distance min_distance_filtered(const On& on, const Robot& robot, const Poses& poses, const Own& own,
                                        const OwnPoses& own_poses, const Clouds& clouds,
                                        const self_filter& filter = {}) {
  static_assert(explain_given<Clouds>());
  if constexpr (requires { typename On::several; }) {
    filtered_distance r{ask(on, own, own_poses, clouds, filter), {}};
    r.rest = ask(on, robot, poses, masked_clouds(clouds, r.filter.labels.data()), min_distance{});
    return r;
  } else {
    return detail::one_call<On>::of(on, [&](auto... memory) {
      frames::readable_clouds<On> copies(on, memory...);
      const auto& copied = copies(clouds);
      auto labels = on.template make_scratch<point_label>(count_points(clouds));
      auto counts = on.template make_scratch<self_filter_counts>(1);
      auto result = on.template make_scratch<min_distance_result>(1);
      const self_filter::out to{labels.data(), counts.data()};
      query filtered(on, own, filter, memory...);
      filtered.enqueue(own_poses, copied, to);
      query(on, robot, min_distance{}, memory...).enqueue(poses, masked_clouds(copied, labels.data()), result.data());
      filtered_distance r;
      backends::readback<On> back(on, memory...);
      back(backends::read_value{r.rest, result.data()});  // the last work, so that all is done
      r.filter = filtered.read(filter, to);
      return r;
    });
  }
}
/// Filters out the robot that is asked about.
template <class On, class Robot, class Poses, class Clouds>
filtered_distance min_distance_filtered(const On& on, const Robot& robot, const Poses& poses, const Clouds& clouds,
                                        const self_filter& filter = {}) {
  return min_distance_filtered(on, robot, poses, robot, poses, clouds, filter);
}

}  // namespace clearance
