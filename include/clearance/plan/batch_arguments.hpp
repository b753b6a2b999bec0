// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The arguments of a batch's kernels.

#include <clearance/frames/clouds.hpp>
#include <clearance/plan/tree_search.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/robot/field.hpp>
#include <clearance/traversal/any_depth.hpp>

namespace clearance::plan {

/// What all parts of a configuration have in common, in one cloud.
struct configuration_facts : frames::frame_facts {
  bool rigid = true;  ///< Are all poses rigid?

  configuration_facts() = default;
  CLEARANCE_HD configuration_facts(const world_transform& cloud, vec3 origin, const position_error& off)
      : frames::frame_facts(cloud, origin, off) {}
};

/// Where a configuration's last minimum was.
struct last_place {
  std::uint32_t cloud = none, point = none;
};

/// Pairs that blocks have left to other blocks. Each piece belongs to one configuration.
template <class Pair>
struct batch_pieces {
  static constexpr std::uint32_t most = 16;
  struct piece {
    std::uint32_t configuration, count;
    Pair pairs[most];
  };
  piece* pieces = nullptr;
  std::uint32_t* used = nullptr;  ///< How many pieces were asked for.
  std::uint32_t capacity = 0;     ///< How many there are.

  CLEARANCE_HD std::uint32_t size() const { return *used < capacity ? *used : capacity; }
};

/// Many configurations and one cloud. Arrays have one entry per configuration, or one per part of each configuration.
template <class PartView, class Question>
struct asked_batch {
  using part_type = PartView;
  using question_type = Question;
  using memory_type = typename Question::memory_type;
  using body_type = scan::scan_body<PartView, point_span, any_depth, typename Question::answer_type>;

  const PartView* parts;
  const field_view* fields;
  std::uint32_t part_count, configurations;
  std::uint32_t robots;  ///< They take turns: configuration c is one of robot c % robots, each of `part_count` parts.
  const world_transform* poses;
  frames::turn now;
  world_transform world_from_cloud;
  position_error off;
  Question question;
  bool foreseen;       ///< The errors of all clouds were combined before.
  std::uint64_t seen;  ///< Points of all clouds.
  frames::placement* places;
  ball_bounds* bounds;
  configuration_facts* facts;
  memory_type* all;
  margin_reach* near;       ///< Only for a question by margins.
  distance_key* part_best;  ///< Minima of parts, if they decide what is certain, or null;
  const real* extra;        ///< and how much farther each part is looked for: one per part.
  last_place* last;
  cloud_tree::numbered_point* seeds;
  typename Question::result_type* results;
  scan::drop_counts* dropped;
  std::uint32_t* lost;  ///< Becomes 1 if a pose is not rigid.

  CLEARANCE_HD std::uint32_t first_part(std::uint32_t c) const { return c % robots * part_count; }
  CLEARANCE_HD const PartView* its_parts(std::uint32_t c) const { return parts + first_part(c); }
  CLEARANCE_HD frames::placement* its_places(std::uint32_t c) const { return places + std::size_t(c) * part_count; }
  CLEARANCE_HD of_parts minima_of(std::uint32_t c) const {
    if (part_best == nullptr) return {};
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
    const std::size_t first = std::size_t(c) * part_count;
    return {its_parts(c),
            places + first,
            part_count,
            {},
            facts[c].origin,
            now.first,
            nullptr,
            Question::answer(best, near + first, minima_of(c)),
            {}};
  }
};

/// And how blocks search. `Pair` is what a block's stack holds.
template <class PartView, class Question, class Pair = node_pair<typename PartView::hierarchy_type::node_type>>
struct batch_arguments : asked_batch<PartView, Question> {
  using pair_type = Pair;

  batch_pieces<pair_type> left = {};  ///< The pairs that blocks leave.
  /// What earlier blocks have left. If it is set, blocks take these pieces instead of configurations.
  batch_pieces<pair_type> given = {};
  std::uint32_t depth = 0;      ///< Depth of a block's stack, in pairs.
  std::uint32_t rounds = none;  ///< After so many rounds a block leaves its unfinished pairs.
};

}  // namespace clearance::plan
