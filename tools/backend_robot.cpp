// SPDX-License-Identifier: BSD-3-Clause
// From the command's words to the library's questions, wherever they are asked.
#include "questions/asked.hpp"
#include "ranks.hpp"
#include "stopwatch.hpp"

#include <clearance/io/joint_motion.hpp>
#include <clearance/io/robot_bodies.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/questions/zones.hpp>

#include <algorithm>

using namespace clearance;

struct backend_robot::seen_clouds {
  std::vector<cloud> as_measured;
  std::vector<either_cloud> as_they_are;   // uncertain if one of them is
  std::vector<uncertain_cloud> uncertain;  // all of them
  std::vector<uncertain_cloud> until_end;  // as they may be when a plan ends
};

backend_robot::backend_robot(bool on_device, const asked_model& asked)
    : on_device_(on_device),
      asked_(asked),
      memory_(on_device ? memory_on_device(asked) : memory_on_host(asked)),
      seen_(std::make_unique<seen_clouds>()) {}
backend_robot::~backend_robot() = default;

void backend_robot::join(all_ranks& all, const named_values& options) {
  ranks_ = &all;
  all.agree_on(asked_, options);
}

double backend_robot::see(const std::vector<seen_points>& clouds) {
  std::vector<whole_cloud> whole;
  for (const seen_points& seen_cloud : clouds)
    std::visit([&](const auto& source) { whole.push_back(placed{source, seen_cloud.pose}); }, seen_cloud.points);
  if (ranks_) whole = ranks_->share(whole);
  std::vector<cloud> obstacles;
  for (std::size_t k = 0; k < clouds.size(); ++k)
    std::visit(
        [&](const auto& placed_cloud) {
          obstacles.push_back(placed{cropped(placed_cloud.source, clouds[k].boxes), placed_cloud.pose});
        },
        whole[k]);

  stopwatch clock;
  seen_clouds& seen = *seen_;
  seen = {};
  seen.as_measured = memory_->put(obstacles);
  bool some_uncertain = false;
  for (std::size_t k = 0; k < clouds.size(); ++k) {
    const auto& [points, pose, sensor, off, later, boxes] = clouds[k];
    cloud_uncertainty at_end = off;
    at_end.age += later;
    some_uncertain = some_uncertain || sensor.kind != noise_kind::none || off.shift > 0 || off.turn > 0 ||
                     off.max_speed * off.age > 0;
    std::visit(
        [&](const auto& placed_cloud) {
          seen.uncertain.push_back(placed{clearance::uncertain(placed_cloud.source, sensor, off), placed_cloud.pose});
          seen.until_end.push_back(
              placed{clearance::uncertain(placed_cloud.source, sensor, at_end), placed_cloud.pose});
        },
        seen.as_measured[k]);
  }

  const auto take = [&](const auto& chosen) {
    for (const auto& one : chosen)
      std::visit([&](const auto& placed_cloud) { seen.as_they_are.push_back(placed_cloud); }, one);
  };
  some_uncertain ? take(seen.uncertain) : take(seen.as_measured);
  return clock.lap();
}

/// A question that was asked before, or a new one. Building trees and preparing is not part of the time of `query`.
template <class Interface>
Interface& backend_robot::prepared(const typename Interface::question_type& q, bool other_volume) {
  std::shared_ptr<void>& kept = queries_[typeid(Interface)];
  if (!kept) {
    const auto make = maker<Interface>::on[on_device_];
    kept = std::shared_ptr<Interface>(make(other_volume ? memory_->other() : memory_->usual(), other_volume, q));
    build = memory_->build;
    upload = memory_->upload;
    without_field = memory_->without_field;
    fields = memory_->fields;
    fields_cached = memory_->fields_cached;
    without_cells = memory_->without_cells;
    cells = memory_->cells;
    cells_bytes = memory_->cells_bytes;
  }
  return *static_cast<Interface*>(kept.get());
}
template <class Q, class Ask>
typename Q::result backend_robot::together(poses_of poses, const Q& q, const Ask& ask) {
  if (!ranks_) return ask(q);
  const auto joined = joined_on_ranks<Q>::ask;
  if (!joined) throw std::logic_error("ranks are not asked this");
  return joined(*ranks_, poses, q, ask);
}
template <class Q, class Cloud>
typename Q::result backend_robot::ask(poses_of poses, const std::vector<Cloud>& clouds, const Q& q) {
  return together(poses, q, [&](const Q& its) {
    any::query<Q, Cloud>& asked = prepared<any::query<Q, Cloud>>(its);
    stopwatch clock;
    auto found = asked(poses, clouds, its);
    query = clock.lap();
    return found;
  });
}

reply backend_robot::least(poses_of poses) {
  auto& asked = prepared<any::query<min_distance, cloud>>({}, other_volume());
  stopwatch clock;
  reply out{asked(poses, seen_->as_measured, {}), {}};
  query = clock.lap();
  return out;
}

reply backend_robot::least_per_part(poses_of poses, int repeat) {
  const auto found = together(poses, min_distance_per_part{}, [&](const min_distance_per_part& q) {
    auto& asked = prepared<any::query<min_distance_per_part, cloud>>(q, other_volume());
    min_distance_per_part_result result;
    double spent = 0;
    stopwatch clock;
    for (int round = 0; round < repeat && spent < 0.3; ++round) {
      asked.forget();
      clock.lap();
      result = asked(poses, seen_->as_measured, q);
      const double seconds = clock.lap();
      spent += seconds;
      query = round == 0 ? seconds : std::min(query, seconds);
    }
    return result;
  });
  return {found.all, found.parts};
}

reply backend_robot::least_by(poses_of poses, double deadline) {
  // With every part's, as in `least_per_part`: a complete answer then has the same lower end.
  auto& asked = prepared<any::timed_query<min_distance_per_part, cloud>>({});  // before the clock starts
  stopwatch clock;
  const auto known = asked.by(std::chrono::duration<double>(deadline), poses, seen_->as_measured, {});
  query = clock.lap();
  reply out{known.result.all, {}, known.unseen};
  out.parts.resize(asked_.bodies->size());
  return out;
}

zones_result backend_robot::zones(poses_of poses, const clearance::zones& options) {
  return ask(poses, seen_->as_they_are, options);
}
self_filter_result backend_robot::own_points(poses_of poses, double padding) {
  return ask(poses, seen_->as_measured, self_filter{.padding = {padding}});
}
supported_distance backend_robot::supported(poses_of poses, const min_distance_supported& options) {
  return ask(poses, seen_->as_measured, options);
}
point_distances backend_robot::distances(poses_of poses, double d_max, bool is_signed) {
  const double most = real(d_max);
  if (is_signed) return ask(poses, seen_->as_measured, signed_distances{.d_max = most, .which = true});
  return ask(poses, seen_->as_measured, clearance::distances{.d_max = most, .which = true});
}
nearest_k_result backend_robot::nearest(poses_of poses, std::size_t k, double d_max) {
  return ask(poses, seen_->as_measured, nearest_k{.k = k, .d_max = real(d_max)});
}
certain_distance_result backend_robot::certain(poses_of poses, std::span<const part_radius> parts) {
  return ask(poses, seen_->uncertain, certain_distance{{parts.begin(), parts.end()}});
}
std::vector<part_witness> backend_robot::witnesses(poses_of poses, std::span<const part_minimum> minima) {
  return ask(poses, seen_->as_measured, part_witnesses{minima});
}
unseen_result backend_robot::unseen(poses_of poses, const clearance::unseen& options, bool until_end) {
  if (!until_end) return ask(poses, seen_->as_they_are, options);
  std::vector<either_cloud> then;
  for (const uncertain_cloud& one : seen_->until_end) std::visit([&](const auto& its) { then.push_back(its); }, one);
  return ask(poses, then, options);
}
min_distances_result backend_robot::plan(poses_of poses, double d_max) {
  return ask(poses, seen_->as_measured, min_distances{.d_max = real(d_max)});
}
min_distances_per_part_result backend_robot::certain_plan(poses_of poses, double d_max,
                                                          const std::vector<double>& radii) {
  return ask(poses, seen_->until_end, min_distances_per_part{d_max, radii});
}
std::span<const part_facts> backend_robot::facts() { return memory_->facts(); }

std::vector<motion_clearance_result> backend_robot::ways(std::span<const io::joint_motion> ways,
                                                         const motion_clearance_options& options) {
  const auto at = [&](poses_of poses) { return ask(poses, seen_->as_they_are, min_distance_per_part{}); };
  const std::span<const part_facts> parts = facts();
  stopwatch clock;
  std::vector<motion_clearance_result> all;
  for (const io::joint_motion& way : ways)
    all.push_back(clearance::detail::over_motion(at, parts, way, seen_->as_they_are, options));
  query = clock.lap();
  return all;
}

namespace {

/// One way, where `ask(poses)` is `unseen` and `images` are what it is about.
template <class Ask, class Images>
motion_clearance_result hidden_way(const Ask& ask, std::span<const part_facts> facts, const io::joint_motion& way,
                                   const Images& images, const motion_clearance_options& options) {
  bool reaches = false, nothing_hides = false;
  const auto least = [&](poses_of poses) {
    const unseen_result found = ask(poses);
    reaches = reaches || found.all.state == state::unknown;
    nothing_hides = found.all.state == state::free && found.all.part == none;
    min_distance_per_part_result made;
    made.all = found.all;
    for (const unseen_part& part : found.parts) {
      made.parts.emplace_back();
      made.parts.back().distance = part.lower;  // what is certain, parts' gaps and radii taken off
    }
    return made;
  };
  auto found = clearance::detail::over_motion(least, facts, way, images, options);
  if (nothing_hides) {  // whatever the robot does
    found.state = state::free;
    found.lower = infinity;
    found.settled = true;
    return found;
  }
  if (found.state == state::collision) found.state = state::unknown;  // nobody knows what is there
  if (found.state == state::possible && reaches) found.state = state::unknown;
  return found;
}

}  // namespace

std::vector<motion_clearance_result> backend_robot::hidden_ways(std::span<const io::joint_motion> ways,
                                                                const motion_clearance_options& options,
                                                                const clearance::unseen& room) {
  const std::span<const part_facts> of_solids = facts();
  std::vector<part_facts> facts(of_solids.begin(), of_solids.end());
  for (part_facts& part : facts)  // `unseen` has taken gaps and tolerances off
    part = {.center = part.center, .radius = rounded_up(solid_radius(part))};
  stopwatch clock;
  std::vector<motion_clearance_result> all;
  const auto at = [&](poses_of poses) { return unseen(poses, room, false); };
  for (const io::joint_motion& way : ways) all.push_back(hidden_way(at, facts, way, seen_->as_they_are, options));
  query = clock.lap();
  return all;
}
