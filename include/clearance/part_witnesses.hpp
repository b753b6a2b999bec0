// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where every part's least distance is, after min_distance_per_part. Runs on the host; include part_witnesses.cuh for a
// device.

#include <clearance/answer/asked_once.hpp>
#include <clearance/answer/few_values.hpp>
#include <clearance/answer/kept_memory.hpp>
#include <clearance/answer/plain_search.hpp>
#include <clearance/traversal/any_depth.hpp>

namespace clearance {

namespace minimum {

/// The places of up to so many parts go with the launch.
inline constexpr std::uint32_t few = 12;

/// One thread per part, for one cloud.
template <class PartView, point_source Source>
struct witness_body {
  const PartView* parts;
  pairwise::few_values<frames::placement, few> places;
  Source source;
  vec3 origin;
  world_transform world_from_cloud;
  std::uint32_t cloud;
  const part_minimum* minima;
  any_depth walk;
  part_witness* witnesses;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const part_minimum least = minima[i];
    if (cloud == 0) witnesses[i] = {};
    if (least.cloud != cloud || least.point >= source.size()) return;
    const frames::placement place = places[std::uint32_t(i)];
    const vec3 p = source[least.point].position, q = place.part_from_cloud(p - origin);
    const auto f = evaluate(parts[i], q, least.distance, walk);
    if (f.nearest.id == none || f.distance != least.distance) return;
    const contact here = f.at(q, place.world_from_part);
    witnesses[i] = {f.distance,   std::uint32_t(i),    cloud,        least.point,
                    f.nearest.id, world_from_cloud(p), here.nearest, here.normal};
  }
};

}  // namespace minimum

/// The prepared question: make it once for a robot, and ask it after every frame's minima. Use one object from one
/// thread and one stream; the robot must outlive it.
template <class On, class PartView>
class part_witnesses_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory. Throws
  /// std::invalid_argument if a tree is too deep for `near_first` on a device.
  template <robot Robot, class... Memory>
  part_witnesses_query(const On& on, const Robot& robot, Memory... memory)
      : on_(on), model_(view_of(robot)), memory_(on, memory...) {
    if constexpr (requires { typename On::own_scan; }) minimum::check_stack<near_first>(model_.depth, model_.width);
  }

  /// As `part_witnesses`. Points that a device cannot read are copied into buffers that it keeps.
  template <class Clouds>
  std::vector<part_witness> operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                       std::span<const part_minimum> minima) {
    frames::check_room(model_.size(), minima.size());
    memory_.begin();
    part_witness* const found = memory_.template room<part_witness>(minima.size()).data();
    look(poses, memory_.readable(clouds), std::get<0>(memory_.put(minima)), found);
    auto all = on_.copy_out(found, minima.size());
    for (std::size_t k = 0; k < all.size(); ++k)
      if (minima[k].cloud != none && all[k].part == none)
        throw std::invalid_argument("clearance: the minimum of part " + std::to_string(k) +
                                    " is not one of these poses and clouds");
    return all;
  }

  /// Enqueues it. `minima` and `witnesses`, one per part, and the clouds are in memory that `on` reads and writes. A
  /// minimum of other poses or clouds has no witness. On a device it is one kernel per cloud, waits for nothing, and
  /// allocates only for more parts or clouds than ever before. A graph that captures this keeps the current poses.
  template <class Clouds>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const part_minimum* minima,
               part_witness* witnesses) {
    memory_.begin();
    look(poses, clouds, minima, witnesses);
  }

 private:
  template <class Clouds>
  void look(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const part_minimum* minima,
            part_witness* witnesses) {
    const any_depth walk{stack_need(model_.depth, model_.width)};
    frames::for_each_turn(
        frame_, model_.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          const auto places = pairwise::few_or_kept<minimum::few>(frame_.places, memory_);
          on_.for_each(model_.size(),
                       minimum::witness_body<PartView, S>{model_.parts, places, source, frame_.origin,
                                                          frame_.world_from_cloud, now.cloud, minima, walk, witnesses});
        });
  }

  On on_;
  model_view<PartView> model_;
  pairwise::kept_memory<On> memory_;
  frames::cloud_frame frame_;
};
template <class On, robot Robot, class... Memory>
part_witnesses_query(const On&, const Robot&, Memory...)
    -> part_witnesses_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// The witnesses of minima that min_distance_per_part gave for the same robot, poses and clouds, one per part; a
/// minimum at no point has none. It takes one walk per part; clouds that `on` cannot read are copied once more. Throws
/// std::invalid_argument as min_distance, or if the minima are not those of this robot, these poses and these clouds,
/// or a tree is too deep for `near_first` on a device.
template <backend On, robot Robot, class Clouds>
std::vector<part_witness> part_witnesses(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                         const Clouds& clouds, std::span<const part_minimum> minima) {
  static_assert(explain_clouds<Clouds>());
  return pairwise::asked_once<part_witnesses_query>(on, robot,
                                                    [&](auto& query) { return query(poses, clouds, minima); });
}

}  // namespace clearance
