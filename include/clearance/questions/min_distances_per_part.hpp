// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is each part of many configurations of one robot from everything that its sensors see?

#include <clearance/questions/min_distances.hpp>

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

/// The least distance of each part of each configuration, otherwise as min_distances. Each part is asked about as its
/// own robot, with its own memory and structure over the clouds: a frame costs as much as min_distances for each part.
struct min_distances_per_part {
  double d_max = infinity;  ///< Metres, as for min_distances.

  using result = min_distances_per_part_result;
  template <class On, class PartView>
  class engine;
  template <class PartView>
  using joined = plan::joined_minima<min_distances_per_part, PartView>;

  static std::vector<min_distance_result>& results(result& r) { return r.all; }
  static void so_far(result& r, std::uint64_t unseen) {
    for (min_distance_result& its : r.all) minimum::allow_for_unseen(its, unseen);
  }
};

template <class On, class PartView>
class min_distances_per_part::engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : readable_(on, from...), parts_(model.size()) {
    for (std::size_t k = 0; k < parts_; ++k) each_.emplace_back(on, model.part(k), from...);
  }

  /// The result stays valid until the next call. Points that a device cannot read are copied once for all parts.
  template <class Clouds>
  const result& run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const min_distances_per_part& q) {
    const std::size_t count = detail::count_configurations(parts_, poses.size());
    result_.parts = parts_;
    result_.all.resize(count * parts_);
    own_.resize(count);
    detail::named(parts_, poses, [&] {
      const auto& there = readable_(clouds);
      for (std::size_t k = 0; k < parts_; ++k) {
        for (std::size_t c = 0; c < count; ++c) own_[c] = poses[c * parts_ + k];
        const auto& found = each_[k].run(own_, there, {q.d_max}).of;
        for (std::size_t c = 0; c < count; ++c) {
          auto& its = result_.all[c * parts_ + k] = found[c];
          if (its.part != none) its.part = std::uint32_t(k);
        }
      }
    });
    return result_;
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() {
    for (auto& its : each_) its.forget();
  }

 private:
  frames::readable_clouds<On> readable_;
  std::size_t parts_;
  std::deque<plan::engine<On, PartView, min_distances>> each_;
  std::vector<Eigen::Isometry3d> own_;
  min_distances_per_part_result result_;
};

}  // namespace clearance
