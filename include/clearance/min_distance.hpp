// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/points/point_span.hpp>
#include <clearance/query/nearest.hpp>
#include <clearance/search/host_search.hpp>
#include <clearance/traversal/near_first.hpp>

namespace clearance {

namespace detail {

/// What callers may pass for a cloud, as sources with poses: one source, one placed source, or a range of those.
template <point_source S>
std::array<placed<S>, 1> as_clouds(const S& source) {
  return {{{source}}};
}
template <point_source S>
std::span<const placed<S>> as_clouds(const placed<S>& cloud) {
  return {&cloud, 1};
}
template <point_source S>
std::span<const placed<S>> as_clouds(const std::vector<placed<S>>& clouds) {
  return clouds;
}
inline std::array<placed<point_span>, 1> as_clouds(const std::vector<vec3>& points) { return {{{point_span(points)}}}; }

/// The source itself if the backend can read its memory, else one over a copy that `copies` keeps.
template <backend B, point_source S>
S readable(const B& on, const S& source, std::vector<typename B::template buffer<std::byte>>& copies) {
  if constexpr (requires { source.at(source.bytes().data()); }) {
    if (source.size() != 0 && !on.reads(source.bytes().data())) {
      copies.push_back(on.copy_in(source.bytes()));
      return source.at(copies.back().data());
    }
  }
  return source;
}

template <class Model>
decltype(auto) view_of(const Model& m) {
  if constexpr (requires { m.view().facts.size(); })
    return m.view();
  else
    return m;
}

template <class Model>
using part_view_of = typename std::remove_cvref_t<decltype(view_of(std::declval<const Model&>()))>::part_type;

template <class T, class PartView>
concept traversal_of = traversal<T, typename PartView::hierarchy_type, nearest>;

}  // namespace detail

/// Enqueues the least distance over all parts and points; `result` is device, pinned or managed memory, and is written in
/// the order of the backend's stream, so that what follows there may read it. Clouds must be readable where it runs.
template <backend B, class Model, class Clouds, detail::traversal_of<detail::part_view_of<Model>> Traversal = near_first>
void min_distance_async(const B& on, const Model& model, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                        min_distance_result* result, part_minimum* minima = nullptr, Traversal traversal = {}) {
  minimum_search search(on, detail::view_of(model), poses, traversal, result, minima);
  for (const auto& cloud : detail::as_clouds(clouds)) search.add(cloud.source, cloud.pose);
  search.conclude();
}
/// Of one source, `cloud_pose` world-from-source.
template <backend B, class Model, point_source S, detail::traversal_of<detail::part_view_of<Model>> Traversal = near_first>
void min_distance_async(const B& on, const Model& model, std::span<const Eigen::Isometry3d> poses, const S& source,
                        const Eigen::Isometry3d& cloud_pose, min_distance_result* result, part_minimum* minima = nullptr, Traversal traversal = {}) {
  min_distance_async(on, model, poses, placed<S>{source, cloud_pose}, result, minima, traversal);
}

/// The least distance over all parts and all points, with its bracket and witness. `poses` are world-from-part, one a part;
/// `clouds` a point source, a `placed` one, or a vector of those; memory that the backend cannot read is copied.
/// Throws std::invalid_argument if the number of poses is wrong or one is not rigid.
template <backend B, class Model, class Clouds, detail::traversal_of<detail::part_view_of<Model>> Traversal = near_first>
min_distance_result min_distance(const B& on, const Model& model, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                 Traversal traversal = {}, std::vector<part_minimum>* minima = nullptr) {
  const auto view = detail::view_of(model);
  auto result = on.template make_scratch<min_distance_result>(1);
  auto each = on.template make_scratch<part_minimum>(minima == nullptr ? 0 : view.size());
  std::vector<typename B::template buffer<std::byte>> copies;
  minimum_search search(on, view, poses, traversal, result.data(), minima == nullptr ? nullptr : each.data());
  for (const auto& cloud : detail::as_clouds(clouds)) search.add(detail::readable(on, cloud.source, copies), cloud.pose);
  search.conclude();
  if (minima != nullptr) *minima = on.copy_out(each.data(), each.size());
  return on.copy_out(result.data(), 1)[0];
}
/// Of one source, `cloud_pose` world-from-source.
template <backend B, class Model, point_source S, detail::traversal_of<detail::part_view_of<Model>> Traversal = near_first>
min_distance_result min_distance(const B& on, const Model& model, std::span<const Eigen::Isometry3d> poses, const S& source,
                                 const Eigen::Isometry3d& cloud_pose, Traversal traversal = {}, std::vector<part_minimum>* minima = nullptr) {
  return min_distance(on, model, poses, placed<S>{source, cloud_pose}, traversal, minima);
}

/// The same for one part.
template <backend B, class Tree, class Interior, class Clouds,
          detail::traversal_of<decltype(std::declval<const part<Tree, Interior>&>().view())> Traversal = near_first>
min_distance_result min_distance(const B& on, const part<Tree, Interior>& body, const Eigen::Isometry3d& pose, const Clouds& clouds,
                                 Traversal traversal = {}) {
  const auto view = body.view();
  const auto there = on.copy_in(std::span(&view, 1));
  const model_view<std::remove_const_t<decltype(view)>> one{there.data(), {&body.facts, 1}, view.tree.depth(), view.tree.width()};
  return min_distance(on, one, std::span(&pose, 1), clouds, traversal);
}
template <backend B, class Tree, class Interior, point_source S,
          detail::traversal_of<decltype(std::declval<const part<Tree, Interior>&>().view())> Traversal = near_first>
min_distance_result min_distance(const B& on, const part<Tree, Interior>& body, const Eigen::Isometry3d& pose, const S& source,
                                 const Eigen::Isometry3d& cloud_pose, Traversal traversal = {}) {
  return min_distance(on, body, pose, placed<S>{source, cloud_pose}, traversal);
}

/// With the minimum of every part beside the robot's: one bound a part instead of one for all, and a tighter `lower`.
template <backend B, class Model, class Clouds, detail::traversal_of<detail::part_view_of<Model>> Traversal = near_first>
std::pair<min_distance_result, std::vector<part_minimum>> min_distance_per_part(const B& on, const Model& model,
                                                                                std::span<const Eigen::Isometry3d> poses,
                                                                                const Clouds& clouds, Traversal traversal = {}) {
  std::vector<part_minimum> minima;
  const auto result = min_distance(on, model, poses, clouds, traversal, &minima);
  return {result, std::move(minima)};
}
/// Of one source, `cloud_pose` world-from-source.
template <backend B, class Model, point_source S, detail::traversal_of<detail::part_view_of<Model>> Traversal = near_first>
std::pair<min_distance_result, std::vector<part_minimum>> min_distance_per_part(const B& on, const Model& model,
                                                                                std::span<const Eigen::Isometry3d> poses, const S& source,
                                                                                const Eigen::Isometry3d& cloud_pose, Traversal traversal = {}) {
  return min_distance_per_part(on, model, poses, placed<S>{source, cloud_pose}, traversal);
}

}  // namespace clearance
