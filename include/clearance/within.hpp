// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are within a distance of each part? Runs on the host; include within.cuh for a device.

#include <clearance/answer/listed.hpp>
#include <clearance/collect_query.hpp>

#include <algorithm>

namespace clearance {

/// Points near parts. The pairs of part k are offsets[k] to offsets[k + 1] - 1, the nearest first, then by cloud and
/// point.
struct within_result {
  std::vector<std::size_t> offsets;
  std::vector<pair_distance> pairs;  ///< Distances as computed, in metres.
  point_counts counts;
  distance_certainty certain;  ///< Of each distance.
};

namespace detail {

/// One radius for each part, from one or one per part.
inline void set_radii(std::span<const real> radius, std::size_t parts, std::vector<real>& radii) {
  if (radius.size() != 1 && radius.size() != parts)
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but " +
                                std::to_string(radius.size()) + " radii");
  radii.clear();
  for (std::size_t k = 0; k < parts; ++k) {
    radii.push_back(radius[radius.size() == 1 ? 0 : k]);
    if (!(radii[k] == radii[k]))
      throw std::invalid_argument("clearance: the radius of part " + std::to_string(k) + " is not a number");
  }
}

/// All pairs within `radii`, one per part, in order. Clouds must be readable where the question runs.
template <class Question, class Clouds>
within_result list_within(Question& question, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                          const std::vector<real>& radii) {
  auto& memory = question.memory;
  within_result all;
  all.certain = question.certain(poses, clouds);
  std::vector<pair_distance> pairs;
  for (std::size_t least = 1 << 16;;) {  // once more, if there was not enough
    memory.begin();
    const auto list = memory.template room<pair_distance>(least);
    const auto [count, reaches] = memory.put(std::vector<unsigned long long>(1), radii);
    all.counts = question.count(poses, clouds, pairwise::listed{list.data(), count, list.size(), reaches});
    const std::size_t found = std::size_t(question.on.copy_out(count, 1)[0]);
    if (found <= list.size()) {
      pairs = question.on.copy_out(list.data(), found);
      break;
    }
    least = found;
  }
  std::sort(pairs.begin(), pairs.end(), [](const pair_distance& a, const pair_distance& b) {
    return std::tie(a.part, a.distance, a.cloud, a.point) < std::tie(b.part, b.distance, b.cloud, b.point);
  });
  all.offsets.assign(radii.size() + 1, 0);
  for (const pair_distance& pair : pairs) ++all.offsets[pair.part + 1];
  for (std::size_t k = 0; k < radii.size(); ++k) all.offsets[k + 1] += all.offsets[k];
  all.pairs = std::move(pairs);
  return all;
}

}  // namespace detail

/// The prepared question: make it once for a robot, and ask it in every frame with new poses, points and radii. Use one
/// object from one thread and one stream; the robot must outlive it.
template <class On, class PartView>
class within_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  within_query(const On& on, const Robot& robot, Memory... memory) : question_(on, view_of(robot), memory...) {}

  /// As `within`. Points that a device cannot read are copied into buffers that it keeps.
  template <class Clouds>
  within_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                           std::span<const real> radius) {
    static_assert(explain_clouds<Clouds>());
    auto& radii = question_.ahead.reaches;
    detail::set_radii(radius, question_.model.size(), radii);
    return detail::list_within(question_, poses, question_.memory.readable(clouds), radii);
  }
  template <class Clouds>
  within_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, real radius) {
    return (*this)(poses, clouds, std::span<const real>(&radius, 1));
  }

  /// Enqueues it, with your memory: up to `capacity` pairs in any order; `count` becomes how many there are; if that is
  /// more, some were cut. Clouds, and all that is written, must stay valid until it is done. On a device it allocates
  /// nothing and waits for nothing. A graph that captures this keeps the current poses and radii.
  template <class Clouds>
  distance_certainty enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                             std::span<const real> radius, pair_distance* pairs, std::size_t capacity,
                             unsigned long long* count, point_counts* counts) {
    static_assert(explain_clouds<Clouds>());
    auto& radii = question_.ahead.reaches;
    detail::set_radii(radius, question_.model.size(), radii);
    const distance_certainty certain = question_.certain(poses, clouds);
    question_.memory.begin();
    const auto [reaches] = question_.memory.put(radii);
    const unsigned long long nothing = 0;
    question_.on.stage(std::span(&nothing, 1), count);
    question_.ask(poses, clouds, pairwise::listed{pairs, count, capacity, reaches}, counts);
    return certain;
  }
  template <class Clouds>
  distance_certainty enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, real radius,
                             pair_distance* pairs, std::size_t capacity, unsigned long long* count,
                             point_counts* counts) {
    return enqueue(poses, clouds, std::span<const real>(&radius, 1), pairs, capacity, count, counts);
  }

 private:
  pairwise::pair_question<On, PartView> question_;
};
template <class On, robot Robot, class... Memory>
within_query(const On&, const Robot&, Memory...)
    -> within_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// All pairs of a point and a part whose computed distance is at most `radius` metres: one for all parts, or one per
/// part. `poses` and `clouds` as for min_distance. Throws std::invalid_argument as that does, and if there are neither
/// one nor as many radii as parts, or one is NaN.
template <class On, robot Robot, class Clouds>
within_result within(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                     std::span<const real> radius) {
  return pairwise::asked_once<within_query>(on, robot, [&](auto& query) { return query(poses, clouds, radius); });
}
/// The same with one radius for all parts.
template <class On, robot Robot, class Clouds>
within_result within(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                     real radius) {
  return within(on, robot, poses, clouds, std::span<const real>(&radius, 1));
}

/// Enqueues it, with your memory: up to `capacity` pairs in any order; `count` (0 beforehand) becomes how many there
/// are; if that is more, some were cut. `reaches`, one per part, and all else in memory that `on` can read and write
/// until it is done.
template <class On, robot Robot, class Clouds>
void within_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                  const real* reaches, pair_distance* pairs, std::size_t capacity, unsigned long long* count,
                  point_counts* counts) {
  collect_async(on, robot, poses, clouds, pairwise::listed{pairs, count, capacity, reaches}, counts);
}

}  // namespace clearance
