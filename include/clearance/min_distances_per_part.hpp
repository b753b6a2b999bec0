// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is each part of many configurations of one robot from everything that its sensors see? Runs on the host;
// include min_distances_per_part.cuh for a device.

#include <clearance/answer/kept_memory.hpp>
#include <clearance/min_distances.hpp>

#include <deque>

namespace clearance {

/// The result of min_distance for each part alone, as min_distances gives it. of(c) are those of configuration c, one
/// per part.
struct min_distances_per_part_result {
  std::vector<min_distance_result> all;
  std::size_t parts = 0;

  std::size_t size() const { return parts == 0 ? 0 : all.size() / parts; }
  std::span<const min_distance_result> of(std::size_t c) const { return std::span(all).subspan(c * parts, parts); }
};

/// The prepared question, as min_distances_query. Each part is asked about as its own robot, with its own memory and
/// structure over the clouds: a frame costs as much as min_distances for each part.
template <class On, class PartView>
class min_distances_per_part_query {
  using query = min_distances_query<On, PartView>;

 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory. Throws
  /// std::invalid_argument as min_distances_query. The robot must outlive it.
  template <robot Robot, class... Memory>
  min_distances_per_part_query(const On& on, const Robot& robot, Memory... memory)
      : clouds_(on, memory...), model_(view_of(robot)) {
    for (std::size_t k = 0; k < model_.size(); ++k)
      each_.emplace_back(on,
                         model_view<PartView>{model_.parts + k, model_.facts.subspan(k, 1), model_.depth, model_.width},
                         memory...);
  }

  /// As min_distances_per_part. The result stays valid until the next call. Points that a device cannot read are copied
  /// once for all parts.
  template <class Clouds>
  const min_distances_per_part_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                                  const min_distances_options& options = {}) {
    static_assert(explain_clouds<Clouds>());
    const std::size_t parts = model_.size(), count = detail::count_configurations(parts, poses.size());
    result_.parts = parts;
    result_.all.resize(count * parts);
    own_.resize(count);
    detail::named(parts, poses, [&] {
      const auto& there = clouds_.readable(clouds);
      for (std::size_t k = 0; k < parts; ++k) {
        for (std::size_t c = 0; c < count; ++c) own_[c] = poses[c * parts + k];
        const auto& found = each_[k](own_, there, options).of;
        for (std::size_t c = 0; c < count; ++c) {
          auto& its = result_.all[c * parts + k] = found[c];
          if (its.part != none) its.part = std::uint32_t(k);
        }
      }
    });
    return result_;
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() {
    for (auto& q : each_) q.forget();
  }

 private:
  pairwise::memory_on<On> clouds_;
  model_view<PartView> model_;
  std::deque<query> each_;
  std::vector<Eigen::Isometry3d> own_;
  min_distances_per_part_result result_;
};
template <class On, robot Robot, class... Memory>
min_distances_per_part_query(const On&, const Robot&, Memory...)
    -> min_distances_per_part_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// The least distance of each part of each configuration. `poses`, `clouds`, `options` and exceptions as for
/// min_distances.
template <class On, robot Robot, class Clouds>
min_distances_per_part_result min_distances_per_part(const On& on, const Robot& robot,
                                                     std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                                     const min_distances_options& options = {}) {
  return detail::one_call<On>::of(on, [&](auto... memory) {
    min_distances_per_part_query query(on, robot, memory...);
    return query(poses, clouds, options);
  });
}

}  // namespace clearance
