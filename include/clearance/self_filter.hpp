// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are the robot itself, and how far is the rest? Runs on the host; include self_filter.cuh for a device.

#include <clearance/answer/margins.hpp>
#include <clearance/answer/own_points.hpp>
#include <clearance/collect_query.hpp>
#include <clearance/frame/masked_clouds.hpp>
#include <clearance/min_distance.hpp>

#include <cmath>

namespace clearance {

struct self_filter_options {
  /// Metres around a part that belong to the robot: one number for all parts, or one per part. It has to cover the
  /// error of points on the robot's surface: noise, calibration, and the gap of the part's spheres.
  std::vector<double> padding = {0.01};
};

/// Whose each point is. A point is the robot's if it is certainly within the padding of a part's solid. If gap,
/// tolerance or rounding leave that open, it is `uncertain` and not hidden: a point hidden wrongly may be an obstacle,
/// a point kept wrongly stops a robot. Without a certificate every other point is uncertain.
struct self_filter_result {
  std::vector<point_label> labels;   ///< One per point of all clouds, in their order.
  std::vector<std::size_t> offsets;  ///< The labels of cloud c are offsets[c] to offsets[c + 1] - 1.
  std::vector<std::uint32_t> rest;   ///< The numbers of all valid points that are not hidden, ascending.
  self_filter_counts counts;
};

/// The same, and the least distance over all points that are not hidden; its state is about them alone.
struct filtered_distance {
  self_filter_result filter;
  min_distance_result rest;  ///< Hidden points are dropped as `masked`.
};

namespace detail {

template <class Clouds>
std::size_t count_points(const Clouds& clouds) {
  std::size_t points = 0;
  for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) { points += source.size(); });
  return points;
}

/// How near points must be to each part to be perhaps the robot's, and certainly. True if all others are uncertain, so
/// that nobody need ask which.
inline bool set_paddings(std::span<const double> padding, std::span<const part_facts> facts,
                         const frames::float_error& error, std::vector<real>& reaches) {
  const std::size_t given = padding.size(), parts = facts.size();
  if (given != 1 && given != parts)
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but " +
                                std::to_string(given) + " paddings");
  reaches.resize(2 * parts);
  bool all_uncertain = false;
  for (std::size_t k = 0; k < parts; ++k) {
    const double its = padding[given == 1 ? 0 : k];
    if (!(its >= 0 && its < double(infinity)))
      throw std::invalid_argument("clearance: the padding of part " + std::to_string(k) + " is " + std::to_string(its) +
                                  " m; it must be finite, and not negative");
    reaches[parts + k] = pairwise::is_within(its, facts[k], error);
    reaches[k] = pairwise::may_be_within(its, facts[k], error);
    if (!(reaches[k] < infinity)) all_uncertain = true, reaches[k] = reaches[parts + k];
  }
  return all_uncertain;
}

/// What is there to the host.
template <class On, class Clouds>
self_filter_result labelled(const On& on, const Clouds& clouds, const point_label* labels,
                            const self_filter_counts* counts) {
  self_filter_result all;
  all.offsets = {0};
  for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) {
    all.offsets.push_back(all.offsets.back() + source.size());
  });
  all.labels = on.copy_out(labels, all.offsets.back());
  all.counts = on.copy_out(counts, 1)[0];
  all.rest.reserve(std::size_t(all.counts.points.valid - all.counts.own));
  for (std::size_t i = 0; i < all.labels.size(); ++i)
    if (all.labels[i] == point_label::rest || all.labels[i] == point_label::uncertain)
      all.rest.push_back(std::uint32_t(i));
  return all;
}

}  // namespace detail

/// The prepared question: make it once for a robot, and ask it in every frame with new poses, points and paddings. Use
/// one object from one thread and one stream; the robot must outlive it.
template <class On, class PartView>
class self_filter_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  self_filter_query(const On& on, const Robot& robot, Memory... memory) : question_(on, view_of(robot), memory...) {}

  /// As `self_filter`. Points that a device cannot read are copied into buffers that it keeps.
  template <class Clouds>
  self_filter_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                const self_filter_options& options = {}) {
    static_assert(explain_clouds<Clouds>());
    auto& memory = question_.memory;
    memory.begin();
    point_label* const labels = memory.template room<point_label>(detail::count_points(clouds)).data();
    self_filter_counts* const counts = memory.template room<self_filter_counts>(1).data();
    ask(poses, memory.readable(clouds), options, labels, counts);
    return detail::labelled(question_.on, clouds, labels, counts);
  }

  /// As `self_filter_async`. On a device it is one kernel per cloud, waits for nothing, and allocates only for more
  /// clouds than ever before. A graph that captures this keeps the current poses and paddings.
  template <class Clouds>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const self_filter_options& options,
               point_label* labels, self_filter_counts* counts) {
    static_assert(explain_clouds<Clouds>());
    question_.memory.begin();
    ask(poses, clouds, options, labels, counts);
  }

 private:
  template <class Clouds>
  void ask(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const self_filter_options& options,
           point_label* labels, self_filter_counts* counts) {
    using answer = pairwise::own_points;
    const On& on = question_.on;
    const auto facts = question_.model.facts;
    auto& ahead = question_.ahead;
    const frames::float_error error = ahead.look(facts, poses, clouds).error;
    const bool all_uncertain = detail::set_paddings(options.padding, facts, error, ahead.reaches);
    const auto near = pairwise::few_or_kept<2 * pairwise::paddings::few>(ahead.reaches, question_.memory);
    const auto start = pairwise::few_or_kept<answer::few_clouds>(ahead.first, question_.memory);
    const answer own{labels, counts, {near, std::uint32_t(facts.size())}, start, all_uncertain};
    constexpr bool alone = !pairwise::pairs_on<On>::meets_points;
    if constexpr (alone) {
      on.for_each(1, pairwise::forget_labels{counts});
      std::uint32_t cloud = 0;
      for_each_cloud(clouds, [&]<point_source S>(const S& source, const Eigen::Isometry3d&) {
        on.for_each(source.size(), pairwise::label_alone<S>{own, source, cloud++});
      });
    }
    question_.ask(poses, clouds, own, &counts->points);
    if constexpr (alone) on.for_each(detail::count_points(clouds), pairwise::count_labels{own});
  }

  pairwise::pair_question<On, PartView> question_;
};
template <class On, robot Robot, class... Memory>
self_filter_query(const On&, const Robot&, Memory...)
    -> self_filter_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// Which points are the robot itself? `poses` and `clouds` as for min_distance. Throws std::invalid_argument as that
/// does, and if there are neither one nor as many paddings as parts, or one is negative or not finite.
template <class On, robot Robot, class Clouds>
self_filter_result self_filter(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                               const Clouds& clouds, const self_filter_options& options = {}) {
  return pairwise::asked_once<self_filter_query>(on, robot, [&](auto& query) { return query(poses, clouds, options); });
}

/// Enqueues self_filter, into memory that `on` can write. Clouds must be readable where it runs, and stay until it is
/// done. The next work in the stream may ask about `masked_clouds(clouds, labels)`.
template <class On, robot Robot, class Clouds>
void self_filter_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                       const self_filter_options& options, point_label* labels, self_filter_counts* counts) {
  pairwise::asked_once<self_filter_query>(on, robot,
                                          [&](auto& query) { query.enqueue(poses, clouds, options, labels, counts); });
}

/// Also says how far a robot is from the rest. `own` is filtered out, such as an arm that a camera sees; `robot` may be
/// another one. Clouds that `on` cannot read are copied once.
template <class On, robot Robot, robot Own, class Clouds>
filtered_distance min_distance_filtered(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                        const Own& own, std::span<const Eigen::Isometry3d> own_poses,
                                        const Clouds& clouds, const self_filter_options& options = {}) {
  static_assert(explain_clouds<Clouds>());
  const auto& there = minimum::search_on<On>::backend_of(on);
  auto labels = there.template make_scratch<point_label>(detail::count_points(clouds));
  auto counts = there.template make_scratch<self_filter_counts>(1);
  auto result = there.template make_scratch<min_distance_result>(1);
  pairwise::memory_on<detail::backend_of<On>> memory(there);
  auto&& readable = memory.readable(clouds);
  self_filter_async(there, own, own_poses, readable, options, labels.data(), counts.data());
  const auto rest = masked_clouds(readable, labels.data());
  minimum::search_on<On>::template once<false>(on, view_of(robot), poses, rest, result.data(), nullptr,
                                               minimum::as_it_is{});
  return {detail::labelled(there, clouds, labels.data(), counts.data()), there.copy_out(result.data(), 1)[0]};
}
/// Filters out the robot that is asked about.
template <class On, robot Robot, class Clouds>
filtered_distance min_distance_filtered(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                        const Clouds& clouds, const self_filter_options& options = {}) {
  return min_distance_filtered(on, robot, poses, robot, poses, clouds, options);
}

}  // namespace clearance
