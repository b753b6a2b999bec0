// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from everything that its sensors see? On the host; min_distance.cuh has a device, too.

#include <clearance/answer/search_on.hpp>

#include <ranges>

namespace clearance {

namespace detail {

template <class On>
using backend_of = std::remove_cvref_t<decltype(minimum::search_on<On>::backend_of(std::declval<const On&>()))>;

/// One frame, waited for.
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

/// The least distance over all parts and all points, with its bracket and witness. `poses` are world-from-part, one a
/// part; `clouds` a point source, a `placed` one, a range or a tuple of those, or a source and its pose; memory that
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

/// With the minimum of every part beside the robot's: one bound a part instead of one for all, and a tighter `lower`.
template <class On, robot Robot, class... Clouds>
std::pair<min_distance_result, std::vector<part_minimum>> min_distance_per_part(
    const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds&... clouds) {
  std::pair<min_distance_result, std::vector<part_minimum>> all;
  all.first = detail::least_distance<true>(on, view_of(robot), poses, as_clouds(clouds...), &all.second);
  return all;
}

/// Each of several robots against the same clouds, which are copied once if `on` cannot read them; nothing waits in
/// between. `robots` is a range of models or their views, `poses` one of their parts' poses. Throws
/// std::invalid_argument as min_distance, and if the two ranges are not of one size.
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

/// Enqueues it: `result` is memory that `on` can write, and is written in the order of its stream, so that what follows
/// there may read it. Clouds must be readable where it runs.
template <class On, robot Robot, class Clouds>
void min_distance_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                        const Clouds& clouds, min_distance_result* result) {
  static_assert(explain_clouds<Clouds>());
  minimum::search_on<On>::template once<false>(on, view_of(robot), poses, clouds, result, nullptr, minimum::as_it_is{});
}
/// With the minimum of every part, one a part.
template <class On, robot Robot, class Clouds>
void min_distance_per_part_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                 const Clouds& clouds, min_distance_result* result, part_minimum* minima) {
  static_assert(explain_clouds<Clouds>());
  minimum::search_on<On>::template once<true>(on, view_of(robot), poses, clouds, result, minima, minimum::as_it_is{});
}

}  // namespace clearance
