// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/min_distance.hpp>

namespace clearance {

/// A prepared query: made once for a model, asked every frame with new poses and points. It keeps its scratch memory and
/// remembers where the last minimum was, which only ever makes it faster. One object is for one thread and one stream.
///
/// This is the plain form; device.cuh has the fast one for our own trees (min_distance_query.cuh).
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

template <backend B, class Model>
min_distance_query(const B&, const Model&) -> min_distance_query<B, typename Model::view_type>;

}  // namespace clearance
