// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from everything that its sensors see? Runs on the host; include min_distance.cuh for a device.

#include <clearance/answer/search_on.hpp>

#include <ranges>

namespace clearance {

namespace detail {

template <class On>
using backend_of = std::remove_cvref_t<decltype(minimum::search_on<On>::backend_of(std::declval<const On&>()))>;

/// One frame; blocks until the answer is there.
template <bool PerPart, class On, class View, class Clouds>
min_distance_result least_distance(const On& on, const View& robot, std::span<const Eigen::Isometry3d> poses,
                                   const Clouds& clouds, std::vector<part_minimum>* minima = nullptr) {
  const auto& there = minimum::search_on<On>::backend_of(on);
  auto result = there.template make_scratch<min_distance_result>(1);
  auto each = there.template make_scratch<part_minimum>(PerPart ? robot.size() : 0);
  minimum::cloud_copies<backend_of<On>> copies;
  minimum::search_on<On>::template once<PerPart>(on, robot, poses, clouds, result.data(),
                                                 PerPart ? each.data() : nullptr,
                                                 minimum::readable_on<backend_of<On>>{there, copies});
  if constexpr (PerPart) *minima = there.copy_out(each.data(), each.size());
  return there.copy_out(result.data(), 1)[0];
}

}  // namespace detail

/// The least distance over all parts and all points, with its bracket and witness. `poses` are world-from-part, one per
/// part; `clouds` is a point source, a `placed` one, a range or a tuple of those, or a source and its pose. Memory that
/// `on` cannot read is copied. Throws std::invalid_argument if the number of poses is wrong or one is not rigid.
template <class On, robot Robot, class... Clouds>
min_distance_result min_distance(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                 const Clouds&... clouds) {
  return detail::least_distance<false>(on, view_of(robot), poses, as_clouds(clouds...));
}

/// The same for one part.
template <class On, class Tree, class Interior, class... Clouds>
min_distance_result min_distance(const On& on, const part<Tree, Interior>& body, const Eigen::Isometry3d& pose,
                                 const Clouds&... clouds) {
  const auto view = body.view();
  const auto there = minimum::search_on<On>::backend_of(on).copy_in(std::span(&view, 1));
  const model_view<std::remove_const_t<decltype(view)>> one{
      there.data(), {&body.facts, 1}, view.tree.depth(), view.tree.width()};
  return detail::least_distance<false>(on, view_of(one), std::span(&pose, 1), as_clouds(clouds...));
}

/// Also gives the minimum of every part. Each part has its own bound, and `lower` is tighter.
template <class On, robot Robot, class... Clouds>
std::pair<min_distance_result, std::vector<part_minimum>> min_distance_per_part(
    const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds&... clouds) {
  std::pair<min_distance_result, std::vector<part_minimum>> all;
  all.first = detail::least_distance<true>(on, view_of(robot), poses, as_clouds(clouds...), &all.second);
  return all;
}

/// Asks about several robots and the same clouds, which are copied once if `on` cannot read them; it does not wait in
/// between. `robots` is a range of models or views, `poses` a range of their parts' poses. Throws std::invalid_argument
/// as min_distance, and if the ranges differ in size.
template <class On, std::ranges::forward_range Robots, std::ranges::forward_range Poses, class Clouds>
std::vector<min_distance_result> min_distance_per_robot(const On& on, const Robots& robots, const Poses& poses,
                                                        const Clouds& clouds) {
  static_assert(explain_clouds<Clouds>());
  const auto count = std::size_t(std::ranges::distance(robots));
  if (count != std::size_t(std::ranges::distance(poses)))
    throw std::invalid_argument("clearance: there are " + std::to_string(count) + " robots, but poses for " +
                                std::to_string(std::ranges::distance(poses)));
  const auto& there = minimum::search_on<On>::backend_of(on);
  auto results = there.template make_scratch<min_distance_result>(count);
  minimum::cloud_copies<detail::backend_of<On>> copies;
  auto next = std::ranges::begin(poses);
  auto* result = results.data();
  for (const auto& robot : robots)
    minimum::search_on<On>::template once<false>(on, view_of(robot), std::span<const Eigen::Isometry3d>(*next++),
                                                 clouds, result++, nullptr,
                                                 minimum::readable_on<detail::backend_of<On>>{there, copies});
  return there.copy_out(results.data(), count);
}

/// Enqueues it. `on` must be able to write `result`; the next work in its stream may read it. Clouds must be readable
/// where it runs.
template <class On, robot Robot, class Clouds>
void min_distance_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                        const Clouds& clouds, min_distance_result* result) {
  static_assert(explain_clouds<Clouds>());
  minimum::search_on<On>::template once<false>(on, view_of(robot), poses, clouds, result, nullptr, minimum::as_it_is{});
}
/// The same with every part's minimum, one per part.
template <class On, robot Robot, class Clouds>
void min_distance_per_part_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                 const Clouds& clouds, min_distance_result* result, part_minimum* minima) {
  static_assert(explain_clouds<Clouds>());
  minimum::search_on<On>::template once<true>(on, view_of(robot), poses, clouds, result, minima, minimum::as_it_is{});
}

}  // namespace clearance
