// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/min_distance.hpp>

namespace clearance {

/// A prepared query: made once for a model, asked every frame with new poses and points. It keeps its scratch memory
/// and remembers where the last minimum was, which only ever makes it faster. One object is for one thread and one
/// stream.
///
/// This is the plain form; the host's is below, and min_distance_query.cuh has the device's for our own trees.
template <backend B, class PartView>
class min_distance_query {
 public:
  min_distance_query(const B& on, model_view<PartView> model) : on_(on), model_(model) {}
  template <class Model>
  min_distance_query(const B& on, const Model& model) : min_distance_query(on, model.view()) {}

  template <class Clouds>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds) {
    return min_distance(on_, model_, poses, clouds);
  }

 private:
  B on_;
  model_view<PartView> model_;
};

/// On the CPU, with any tree. After the first frames of a size, a call allocates nothing. The model's memory must stay.
template <class PartView>
class min_distance_query<host, PartView> {
 public:
  min_distance_query(const host& on, model_view<PartView> model)
      : search_(on, model, near_first{}), parts_(model.size()) {}
  template <class Model>
  min_distance_query(const host& on, const Model& model) : min_distance_query(on, model.view()) {}

  /// As min_distance; `minima`, if not empty, one a part, are every part's own, as of min_distance_per_part.
  template <class Clouds>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                 std::span<part_minimum> minima = {}) {
    if (!minima.empty() && minima.size() != parts_)
      throw std::invalid_argument("clearance::min_distance_query: there are " + std::to_string(parts_) +
                                  " parts, but room for " + std::to_string(minima.size()) + " minima");
    min_distance_result result;
    search_.begin(poses, &result, minima.empty() ? nullptr : minima.data());
    for (const auto& cloud : detail::as_clouds(clouds)) search_.add(cloud.source, cloud.pose);
    search_.conclude();
    return result;
  }
  template <point_source S>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const S& source,
                                 const Eigen::Isometry3d& cloud_pose) {
    return (*this)(poses, placed<S>{source, cloud_pose});
  }

  /// Drops what is known of the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

 private:
  minimum_search<host, PartView, near_first> search_;
  std::size_t parts_;
};

template <backend B, class Model>
min_distance_query(const B&, const Model&) -> min_distance_query<B, typename Model::view_type>;

}  // namespace clearance
