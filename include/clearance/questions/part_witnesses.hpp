// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where every part's least distance is, after min_distance_per_part.

#include <clearance/backends/kept_memory.hpp>
#include <clearance/ground/borrowed.hpp>
#include <clearance/minimum/apart.hpp>
#include <clearance/minimum/plain_search.hpp>
#include <clearance/query/query.hpp>

namespace clearance {

namespace minimum {

/// A walk for each part, for one cloud.
template <class PartView, point_source Source>
struct witness_body {
  const PartView* parts;
  backends::few_values<frames::placement, few> places;
  Source source;
  vec3 origin;
  world_transform world_from_cloud;
  std::uint32_t cloud;
  const part_minimum* minima;
  part_witness* witnesses;

  template <class Traversal>
  CLEARANCE_HD void operator()(std::size_t i, const Traversal& walk) const {
    const part_minimum least = minima[i];
    if (cloud == 0) witnesses[i] = {};
    if (least.cloud != cloud || least.point >= source.size()) return;
    const frames::placement place = places[std::uint32_t(i)];
    const vec3 start = source[least.point].position;
    const auto p = scan::element_of(source, least.point, start);
    const auto q = scan::moved(place.part_from_cloud, scan::element_less(source, least.point, start - origin, origin));
    const auto f = evaluate(parts[i], q, least.distance, walk);
    if (f.nearest.id == none || f.distance != least.distance) return;
    const real share = f.inside ? 0 : scan::share_near(f.nearest.primitive, q);
    const contact touched = f.at(scan::place_at(q, share), place.world_from_part);
    const position at = world_from_cloud(scan::place_at(p, share));
    witnesses[i] = {.distance = f.distance,
                    .part = std::uint32_t(i),
                    .cloud = cloud,
                    .point = least.point,
                    .primitive = f.nearest.id,
                    .at = at,
                    .nearest = touched.nearest,
                    .normal = touched.normal};
  }
};

}  // namespace minimum

/// The witness of every part's minimum. On a device it is one kernel per cloud, after min_distance_per_part in a stream
/// or graph. Refused: neither as many minima as parts, and one that is not of these poses and clouds.
struct part_witnesses {
  borrowed<part_minimum> minima;  ///< Every part's least distance, as min_distance_per_part gives it.

  using result = std::vector<part_witness>;
  using can = clearance::can<>;
  /// `minima`, which `enqueue` reads instead, and `witnesses`, one each per part, in memory that the backend reads and
  /// writes. Enqueued, a minimum of other poses or clouds has no witness.
  struct out {
    const part_minimum* minima;
    part_witness* witnesses;
  };
  template <class On, class PartView>
  class engine;
};

template <class On, class PartView>
class part_witnesses::engine {
 public:
  /// Throws std::invalid_argument if a tree is too deep for `near_first` on a device, or for the traversal of `plain`.
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : on_(on), model_(model), memory_(on, from...), back_(on, from...), readable_(on, from...) {
    scan::walk_of(on, model);
  }

  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const part_witnesses& q) {
    frames::check_room(model_.size(), q.minima.size());
    asked_ = &q;
    memory_.begin();
    found_ = memory_.template space<part_witness>(q.minima.size()).data();
    evaluate_all(poses, readable_(clouds), std::get<0>(memory_.put(q.minima)), found_);
  }
  result finish() {
    result witnesses;
    back_(backends::read_array{witnesses, found_, asked_->minima.size()});
    for (std::size_t k = 0; k < witnesses.size(); ++k)
      if (asked_->minima[k].cloud != none && witnesses[k].part == none)
        throw std::invalid_argument("clearance: the minimum of part " + std::to_string(k) +
                                    " is not one of these poses and clouds");
    return witnesses;
  }

  template <class Clouds>
  void start(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const part_witnesses&, const out& to) {
    memory_.begin();
    evaluate_all(poses, clouds, to.minima, to.witnesses);
  }
  void forget() const {}  // it knows nothing of the last frame

 private:
  template <class Clouds>
  void evaluate_all(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const part_minimum* minima,
                    part_witness* witnesses) {
    frames::for_each_turn(
        frame_, model_.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          const auto places = backends::few_or_kept<minimum::few>(frame_.places, memory_);
          minimum::apart<On>::each(on_, model_, model_.size(),
                                   minimum::witness_body<PartView, S>{.parts = model_.parts,
                                                                      .places = places,
                                                                      .source = source,
                                                                      .origin = frame_.origin,
                                                                      .world_from_cloud = frame_.world_from_cloud,
                                                                      .cloud = now.cloud,
                                                                      .minima = minima,
                                                                      .witnesses = witnesses});
        });
  }

  On on_;
  model_view<PartView> model_;
  backends::kept_memory<On> memory_;
  backends::readback<On> back_;
  frames::readable_clouds<On> readable_;
  frames::cloud_frame frame_;
  const part_witnesses* asked_ = nullptr;
  part_witness* found_ = nullptr;
};

}  // namespace clearance
