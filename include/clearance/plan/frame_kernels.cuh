// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What comes before and after a search for many configurations on a device: poses are placed in a cloud, and results
// are written. Also the arguments of all kernels.

#include <clearance/frames/bracket.hpp>
#include <clearance/frames/clouds.hpp>
#include <clearance/plan/search_kernels.cuh>
#include <clearance/points/point_span.hpp>

namespace clearance::plan {

/// What all parts of a configuration have in common, in one cloud.
struct configuration_facts : frames::frame_facts {
  bool rigid = true;  ///< Are all poses rigid?

  configuration_facts() = default;
  CLEARANCE_HD configuration_facts(const world_transform& cloud, vec3 origin, const position_error& off)
      : frames::frame_facts(cloud, origin, off) {}
};

/// Many configurations and one cloud. Arrays lie on the device, with one entry per configuration or, where that is
/// said, one per part of each configuration.
template <class PartView, class Question>
struct asked_batch {
  using part_type = PartView;
  using question_type = Question;
  using memory_type = typename Question::memory_type;
  using body_type = scan::scan_body<PartView, point_span, any_depth, typename Question::answer_type>;

  const PartView* parts = nullptr;
  const field_view* fields = nullptr;
  std::uint32_t part_count = 0, configurations = 0;
  std::uint32_t robots = 1;                ///< Configuration c is one of robot c % robots, each of `part_count` parts.
  const world_transform* poses = nullptr;  ///< Per part.
  frames::turn now = {};
  world_transform world_from_cloud = {};
  position_error off = {};
  Question question = {};
  bool foreseen = false;                ///< The errors of all clouds were combined before.
  std::uint64_t seen = 0;               ///< Points of all clouds.
  frames::placement* places = nullptr;  ///< Per part.
  ball_bounds* bounds = nullptr;        ///< Per part.
  configuration_facts* facts = nullptr;
  memory_type* all = nullptr;
  margin_reach* near = nullptr;       ///< Per part, only for a question by margins.
  distance_key* part_best = nullptr;  ///< Per part: minima of parts, used if `extra` is not null.
  const real* extra = nullptr;        ///< Per part of the robot: how much farther it is looked for; or null.
  last_place* last = nullptr;
  cloud_tree::numbered_point* seeds = nullptr;
  typename Question::result_type* results = nullptr;
  scan::drop_counts* dropped = nullptr;
  std::uint32_t* lost = nullptr;    ///< Becomes 1 if a pose is not rigid.
  std::uint32_t* pieces = nullptr;  ///< How many pieces blocks have left, and have left again.

  CLEARANCE_HD std::uint32_t first_part(std::uint32_t c) const { return c % robots * part_count; }
  CLEARANCE_HD const PartView* its_parts(std::uint32_t c) const { return parts + first_part(c); }
  CLEARANCE_HD frames::placement* its_places(std::uint32_t c) const { return places + std::size_t(c) * part_count; }
  CLEARANCE_HD ball_bounds* bounds_of(std::uint32_t c) const { return bounds + std::size_t(c) * part_count; }
  CLEARANCE_HD margin_reach* near_of(std::uint32_t c) const { return near + std::size_t(c) * part_count; }
  CLEARANCE_HD of_parts minima_of(std::uint32_t c) const {
    if (extra == nullptr) return {};
    return {part_best + std::size_t(c) * part_count, extra};
  }

  /// Where to begin with part `j % part_count`: at the last minimum of `c` and of its neighbours, for j below 3 *
  /// part_count.
  CLEARANCE_HD cloud_tree::numbered_point seed(std::uint32_t c, std::uint32_t j) const {
    const std::uint32_t from = c + (j / part_count - 1) * robots;
    return from < configurations ? seeds[from] : cloud_tree::numbered_point{{0, 0, 0}, none};
  }

  /// Tests points against the parts of configuration `c`, one point at a time, from any source.
  CLEARANCE_HD body_type body(std::uint32_t c, memory_type* best) const {
    return {.parts = its_parts(c),
            .places = its_places(c),
            .part_count = part_count,
            .source = {},
            .origin = facts[c].origin,
            .first = now.first,
            .counts = nullptr,
            .answer = Question::answer(best, near_of(c), minima_of(c)),
            .walk = {}};
  }
};

/// What a kernel that searches is asked, and how its blocks do it. `Pair` is what a block's stack holds.
template <class PartView, class Question, class Pair>
struct batch_arguments : asked_batch<PartView, Question> {
  using pair_type = Pair;
  using pieces_type = batch_pieces<Pair>;

  batch_pieces<Pair> left = {};  ///< The pairs that blocks leave.
  /// What earlier blocks have left. If it is set, blocks take these pieces instead of configurations.
  batch_pieces<Pair> given = {};
  std::uint32_t depth = 0;      ///< Depth of a block's stack, in pairs.
  std::uint32_t rounds = none;  ///< After so many rounds a block leaves its unfinished pairs.
};

/// So many lanes place a configuration. A few for each of several parts were slower than a warp.
CLEARANCE_HD constexpr std::uint32_t placing_lanes(std::uint32_t parts) { return parts == 1 ? 1 : 32; }

/// Places the parts of each configuration in a cloud, and finds where its search begins. A warp per configuration, or
/// a lane if that has one part.
template <class PartView, class Question, class Source>
__global__ void __launch_bounds__(128) place_configurations(const __grid_constant__ asked_batch<PartView, Question> a,
                                                            const __grid_constant__ Source source) {
  const std::uint32_t lanes = placing_lanes(a.part_count), c = (blockIdx.x * 128 + threadIdx.x) / lanes,
                      lane = threadIdx.x % lanes, first = threadIdx.x % 32 - lane;
  const unsigned team = (scan::all_lanes >> (32 - lanes)) << first;
  if (c >= a.configurations) return;
  if (c == 0 && lane == 0) a.pieces[0] = a.pieces[1] = 0;
  const PartView* const parts = a.its_parts(c);
  frames::placement* const places = a.its_places(c);
  bool rigid = true;
  for (std::uint32_t k = lane; k < a.part_count; k += lanes) {
    const std::size_t which = std::size_t(c) * a.part_count + k;
    world_transform pose = a.poses[which];
    if (!make_rigid(pose)) {
      rigid = false;
      pose = {};
      *static_cast<volatile std::uint32_t*>(a.lost) = 1;
    }
    places[k].world_from_part = pose;
  }
  rigid = __all_sync(team, rigid);
  __syncwarp(team);
  configuration_facts facts(a.world_from_cloud, {0, 0, 0}, a.off);
  if (lane == 0) {
    const auto pose = [places](std::uint32_t k) -> const world_transform& { return places[k].world_from_part; };
    facts.origin = frames::origin_near(frames::middle_of(a.world_from_cloud, pose, a.part_count));
  }
  facts.origin = scan::from_lane(facts.origin, int(first), team);
  for (std::uint32_t k = lane; k < a.part_count; k += lanes) {
    const frames::placement here =
        frames::place(parts[k].facts, places[k].world_from_part, a.world_from_cloud, facts.origin, a.off);
    places[k] = here;
    a.bounds_of(c)[k] = ball_bounds(parts[k].facts, here.part_from_cloud);
  }
  __syncwarp(team);
  for (std::uint32_t k = 0; k < a.part_count; ++k) facts.add(parts[k].facts, places[k].error);
  facts.rigid = rigid;
  if (a.now.cloud != 0 || a.foreseen) facts.error.widen(a.facts[c].error);  // a bracket covers all clouds
  if constexpr (Question::by_margin)
    for (std::uint32_t k = lane; k < a.part_count; k += lanes)
      a.near_of(c)[k] = a.question.near(k, parts[k].facts, facts.error);
  __syncwarp(team);
  if (lane != 0) return;
  if (a.now.cloud == 0) {
    a.all[c] = a.question.start(rigid);
    if (a.extra != nullptr)
      for (std::uint32_t k = 0; k < a.part_count; ++k) a.minima_of(c).best[k] = no_key;
  }
  a.facts[c] = facts;
  if constexpr (!Question::by_margin) {
    if (a.now.cloud == 0) a.results[c] = {};
    cloud_tree::numbered_point seed{{0, 0, 0}, none};
    if (const last_place last = a.last[c]; last.cloud == a.now.cloud && last.point < source.size())
      if (const sample s = source[last.point]; s.valid()) seed = {s.position, last.point};
    a.seeds[c] = seed;
  }
}

/// Writes the witness of each configuration's minimum, if it is a point of this cloud; after the last cloud, the whole
/// result. One warp per configuration: each lane tests one part, and all lanes look for the primitive together.
template <class PartView, class Question, class Source>
__global__ void __launch_bounds__(128) finish_configurations(const __grid_constant__ asked_batch<PartView, Question> a,
                                                             const __grid_constant__ Source source) {
  using walk_type = minimum::walk_by_warp<typename PartView::hierarchy_type>;
  __shared__ typename walk_type::memory pending[4];
  const std::uint32_t c = (blockIdx.x * 128 + threadIdx.x) / 32, lane = threadIdx.x % 32;
  if (c >= a.configurations) return;
  const PartView* const parts = a.its_parts(c);
  const configuration_facts& facts = a.facts[c];
  const minimum::shared_bounds bounds{a.all + c, nullptr};
  min_distance_result mine;
  const walk_type walk(pending[threadIdx.x / 32]);
  const auto of_part = [&](std::uint32_t k) -> minimum::resolve_body<PartView, Source, walk_type> {
    return {.parts = parts + k,
            .places = a.its_places(c) + k,
            .part_count = 1,
            .source = source,
            .origin = facts.origin,
            .world_from_cloud = facts.world_from_cloud,
            .first = a.now.first,
            .cloud = a.now.cloud,
            .bounds = bounds,
            .walk = walk,
            .result = &mine,
            .minima = nullptr};
  };
  for (std::uint32_t first = 0; first < a.part_count && __all_sync(scan::all_lanes, mine.part == none); first += 32) {
    unsigned those = __ballot_sync(scan::all_lanes, first + lane < a.part_count && of_part(first + lane).may_be_of(0));
    for (; those != 0 && __all_sync(scan::all_lanes, mine.part == none); those &= those - 1) {
      const std::uint32_t k = first + std::uint32_t(__ffs(int(those))) - 1;
      of_part(k)(1);
      if (mine.part != none) mine.part = k;
      if (mine.part != none) a.results[c] = mine;
    }
  }
  __syncwarp();
  if (!a.now.last || lane != 0) return;
  min_distance_result r = a.results[c];
  a.question.conclude(r, parts, a.part_count, a.dropped, a.all + c, a.minima_of(c), facts, a.seen);
  if (!facts.rigid) {
    r.state = state::possible;
    r.distance = not_a_number;
    r.lower = 0;
    r.upper = infinity;
  }
  if (r.part != none) r.part += a.first_part(c);
  a.results[c] = r;
  a.last[c] = {r.cloud, r.point};
}

/// Writes the state of each configuration after the last cloud, for a question by margins.
template <class PartView, class Question>
__global__ void __launch_bounds__(128) tell_configurations(const __grid_constant__ asked_batch<PartView, Question> a) {
  const std::uint32_t c = blockIdx.x * 128 + threadIdx.x;
  if (c >= a.configurations) return;
  a.results[c] = a.facts[c].rigid ? Question::told(a.all[c], *a.dropped, a.seen) : state::possible;
}

}  // namespace clearance::plan
