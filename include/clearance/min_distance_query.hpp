// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/min_distance.hpp>

namespace clearance {

/// A prepared question: make it once for a robot, and ask it in every frame with new poses and points. It keeps its
/// memory and remembers where the last minima were, which only makes it faster. Use one object from one thread and one
/// stream. Include min_distance_query.cuh for a device.
template <class On, class PartView>
class min_distance_query {
  static_assert(
      !requires { typename On::own_scan; },
      "a device has a scan of its own: include <clearance/min_distance_query.cuh>, not the .hpp");
};

/// On the CPU, with any tree. After the first frames of a size a call allocates nothing. The robot must outlive it.
template <class PartView>
class min_distance_query<host, PartView> {
 public:
  template <robot Robot>
  min_distance_query(const host& on, const Robot& robot) : search_(on, view_of(robot)) {}

  /// As min_distance.
  template <class... Clouds>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds&... clouds) {
    min_distance_result result;
    search_(poses, as_clouds(clouds...), &result);
    return result;
  }
  /// As min_distance_per_part; writes `minima`, one per part.
  template <class Clouds>
  min_distance_result per_part(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                               std::span<part_minimum> minima) {
    frames::check_room(search_.parts(), minima.size());
    min_distance_result result;
    search_(poses, clouds, &result, minima.data());
    return result;
  }

  /// For the next frame only: pairs farther than `within` metres need not be found. If no pair is nearer, the answer
  /// has no witness and the state `no_data`, whatever points there were. Do not use `per_part` for such a frame.
  void bound_by(real within) { search_.bound_by(within); }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

 private:
  minimum::host_search<PartView> search_;
};

template <class On, robot Robot>
min_distance_query(const On&, const Robot&)
    -> min_distance_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

}  // namespace clearance
