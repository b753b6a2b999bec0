// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are within a distance of each part? On the host; within.cuh has a device.

#include <clearance/answer/bracket.hpp>
#include <clearance/answer/listed.hpp>
#include <clearance/backend/staged.hpp>
#include <clearance/collect.hpp>

#include <algorithm>

namespace clearance {

/// Points near parts: those of part k are pairs offsets[k] to offsets[k + 1] - 1, the nearest first, then by cloud and point.
struct within_result {
  std::vector<std::size_t> offsets;
  std::vector<pair_distance> pairs;  ///< Distances as computed, in metres.
  point_counts counts;
  distance_certainty certain;  ///< Of each distance.
};

/// All pairs of a point and a part whose computed distance is at most `radius` metres: one for all parts, or one a part. `poses` and
/// `clouds` as for min_distance. Throws std::invalid_argument as that does, and if there are other than one or as many radii, or one
/// is NaN.
template <class On, robot Robot, class Clouds>
within_result within(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::span<const real> radius) {
  static_assert(explain_clouds<Clouds>());
  const auto model = view_of(robot);
  if (radius.size() != 1 && radius.size() != model.size())
    throw std::invalid_argument("clearance: there are " + std::to_string(model.size()) + " parts, but " + std::to_string(radius.size()) + " radii");
  std::vector<real> reaches;
  for (std::size_t k = 0; k < model.size(); ++k) {
    reaches.push_back(radius[radius.size() == 1 ? 0 : k]);
    if (!(reaches[k] == reaches[k])) throw std::invalid_argument("clearance: the radius of part " + std::to_string(k) + " is not a number");
  }
  auto near = staged(on, reaches);
  within_result all;
  frames::cloud_frame frame;
  frames::for_each_turn(frame, model.facts, poses, clouds, [](const auto&, const frames::turn&) {});
  all.certain = certainty_of(frame);
  std::vector<pair_distance> pairs;
  for (std::size_t room = 1 << 16;;) {  // once more, if there was not enough
    auto list = on.template make_scratch<pair_distance>(room);
    auto count = staged(on, std::vector<unsigned long long>(1));
    all.counts = collect(on, robot, poses, clouds, pairwise::listed{list.data(), count.data(), room, near.data()});
    const std::size_t found = std::size_t(on.copy_out(count.data(), 1)[0]);
    if (found <= room) {
      pairs = on.copy_out(list.data(), found);
      break;
    }
    room = found;
  }
  std::sort(pairs.begin(), pairs.end(), [](const pair_distance& a, const pair_distance& b) {
    return std::tie(a.part, a.distance, a.cloud, a.point) < std::tie(b.part, b.distance, b.cloud, b.point);
  });
  all.offsets.assign(model.size() + 1, 0);
  for (const pair_distance& pair : pairs) ++all.offsets[pair.part + 1];
  for (std::size_t k = 0; k < model.size(); ++k) all.offsets[k + 1] += all.offsets[k];
  all.pairs = std::move(pairs);
  return all;
}
/// The same with one radius for all parts.
template <class On, robot Robot, class Clouds>
within_result within(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, real radius) {
  return within(on, robot, poses, clouds, std::span<const real>(&radius, 1));
}

/// Enqueues it, with memory of the caller's: up to `capacity` pairs in any order; `count` (0 beforehand) becomes how many there are: if
/// that is more, some were cut. `reaches`, one a part, and all else in memory that `on` can read and write until it is done.
template <class On, robot Robot, class Clouds>
void within_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const real* reaches,
                  pair_distance* pairs, std::size_t capacity, unsigned long long* count, point_counts* counts) {
  collect_async(on, robot, poses, clouds, pairwise::listed{pairs, count, capacity, reaches}, counts);
}

}  // namespace clearance
