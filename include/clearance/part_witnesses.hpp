// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where every part's least distance is, after min_distance_per_part. On any backend.

#include <clearance/answer/plain_search.hpp>
#include <clearance/answer/search_on.hpp>
#include <clearance/backend/staged.hpp>

namespace clearance {

namespace minimum {

/// A thread a part, of one cloud.
template <class PartView, point_source Source, class Traversal>
struct witness_body {
  const PartView* parts;
  const frames::placement* places;
  Source source;
  vec3 origin;
  world_transform world_from_cloud;
  std::uint32_t cloud;
  const part_minimum* minima;
  Traversal walk;
  part_witness* witnesses;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const part_minimum& least = minima[i];
    if (least.cloud != cloud) return;
    part_witness& w = witnesses[i];
    const vec3 p = source[least.point].position, q = places[i].part_from_cloud(p - origin);
    const auto f = evaluate(parts[i], q, least.distance, walk);
    w.distance = f.distance;
    if (f.nearest.id == none) return;
    const contact here = f.at(q, places[i].world_from_part);
    w.part = std::uint32_t(i), w.cloud = cloud, w.point = least.point, w.primitive = f.nearest.id;
    w.at = world_from_cloud(p), w.nearest = here.nearest, w.normal = here.normal;
  }
};

}  // namespace minimum

/// The witnesses of minima that min_distance_per_part gave for the same robot, poses and clouds, one a part; a minimum at no point has
/// none. One walk a part; clouds that `on` cannot read are copied once more. Throws std::invalid_argument as min_distance, or if the
/// minima are not those of this robot, these poses and these clouds, or a tree is too deep for `near_first` elsewhere than on the host.
template <backend On, robot Robot, class Clouds>
std::vector<part_witness> part_witnesses(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         std::span<const part_minimum> minima) {
  static_assert(explain_clouds<Clouds>());
  const auto model = view_of(robot);
  using part_type = typename decltype(model)::part_type;
  frames::check_room(model.size(), minima.size());
  const auto not_of_these = [](std::size_t k) {
    throw std::invalid_argument("clearance: the minimum of part " + std::to_string(k) + " is not one of these poses and clouds");
  };
  const auto look = [&](const auto& walk) {
    auto least = staged(on, std::vector<part_minimum>(minima.begin(), minima.end()));
    auto found = staged(on, std::vector<part_witness>(minima.size()));
    minimum::cloud_copies<On> copies;
    const minimum::readable_on<On> readable{on, copies};
    std::uint32_t count = 0;
    frames::cloud_frame frame;
    frames::for_each_turn(frame, model.facts, poses, clouds, [&]<point_source S>(const S& anywhere, const frames::turn& now) {
      count = now.cloud + 1;
      bool here = false;
      for (std::size_t k = 0; k < minima.size(); ++k) {
        if (minima[k].cloud != now.cloud) continue;
        if (minima[k].point >= anywhere.size()) not_of_these(k);
        here = true;
      }
      if (!here) return;
      auto places = staged(on, frame.places);
      using body = minimum::witness_body<part_type, S, std::remove_cvref_t<decltype(walk)>>;
      on.for_each(model.size(), body{model.parts, places.data(), readable(anywhere, now.cloud), frame.origin, frame.world_from_cloud, now.cloud,
                                     least.data(), walk, found.data()});
    });
    std::vector<part_witness> all = on.copy_out(found.data(), minima.size());
    for (std::size_t k = 0; k < all.size(); ++k)
      if (minima[k].cloud != none && (minima[k].cloud >= count || all[k].part == none || all[k].distance != minima[k].distance)) not_of_these(k);
    return all;
  };
  if constexpr (std::is_same_v<On, host>) {
    return look(any_depth{stack_need(model.depth, model.width)});
  } else {
    minimum::check_stack<near_first>(model.depth, model.width);
    return look(near_first{});
  }
}

}  // namespace clearance
