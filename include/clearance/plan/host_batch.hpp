// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A question about many configurations on the CPU. One thread searches for each, from where the last search ended.

#include <clearance/cloud_tree/host_tree.hpp>
#include <clearance/frames/bracket.hpp>
#include <clearance/frames/clouds.hpp>
#include <clearance/minimum/resolve.hpp>
#include <clearance/plan/field_search.hpp>
#include <clearance/plan/tree_search.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/traversal/any_depth.hpp>

#include <algorithm>
#include <vector>

namespace clearance::plan {

// One host thread walks the trees over points and parts, nearest first.

/// A pair that is still to be opened. The nearest goes first.
template <class Pair, class Order>
struct pending_pair {
  Order order;
  Pair pair;

  friend bool operator<(const pending_pair& a, const pending_pair& b) { return a.order > b.order; }
};

/// One configuration against one cloud. `pending` is memory to work with.
template <class Search>
void walk_trees(const Search& search,
                std::vector<pending_pair<typename Search::pair, typename Search::order_type>>& pending) {
  const auto push = [&](const typename Search::pair& p) {
    pending.push_back({search.order(p), p});
    std::push_heap(pending.begin(), pending.end());
  };
  pending.clear();
  typename Search::pair next;
  for (std::uint32_t i = 0, count = search.starts(); i < count; ++i)
    if (search.start(i, next)) push(next);
  while (!pending.empty()) {
    std::pop_heap(pending.begin(), pending.end());
    const typename Search::pair top = pending.back().pair;
    pending.pop_back();
    if (search.settled(top)) continue;
    if (search.is_small(top)) {
      search.look_at_points(top);
      continue;
    }
    for (std::uint32_t j = 0, count = search.children(top); j < count; ++j)
      if (search.child(top, j, next)) push(next);
  }
}

/// A question about many configurations on the CPU, frame after frame: a tree over each cloud, and each configuration
/// searches all of them. It keeps memory and each configuration's last minimum. The next search begins there, and where
/// the previous configuration's ended. That changes only how long it takes.
template <class PartView, class Question>
class host_batch {
 public:
  /// With `each_part` each part of a configuration is a robot of its own.
  host_batch(const host& on, const model_view<PartView>& model, bool each_part)
      : workers_(on),
        model_(model),
        robots_(each_part ? std::max<std::size_t>(model.size(), 1) : 1),
        walk_{stack_need(model.depth, model.width)} {}

  using result_type = typename Question::result_type;

  /// `poses` are rigid, one configuration after another; there is one result per configuration and robot. Returns the
  /// point counts.
  template <class Clouds>
  point_counts operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Question& question,
                          std::span<result_type> results) {
    if (results.empty()) return {};
    const std::size_t parts = model_.size(), count = results.size();
    dropped_ = {};
    frames::cloud_frame first;
    seen_ = frames::for_each_turn(first, model_.facts, poses.first(parts), clouds,
                                  [&](const auto& source, const frames::turn& now) {
                                    if (trees_.size() <= now.cloud) trees_.resize(now.cloud + 1);
                                    trees_[now.cloud].build(workers_, source, dropped_);
                                  });
    if (last_.size() != count) last_.assign(count, {});
    const std::size_t piece = neighbours * robots_, each = parts / robots_;
    rooms_.resize((count + piece - 1) / piece);
    workers_.for_pieces(count, piece, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) {
        const place starts[] = {last_[c], c >= begin + robots_ ? last_[c - robots_] : place{}};
        ask(robots_ == 1 ? model_ : model_.part(c % robots_), poses.subspan(c * each, each), clouds, question, starts,
            rooms_[begin / piece], results[c]);
        if constexpr (!Question::by_margin) {
          last_[c] = {results[c].cloud, results[c].point};
          if (results[c].part != none) results[c].part += std::uint32_t(c % robots_);
        }
      }
    });
    point_counts counts;
    scan::count(counts, dropped_.dropped, seen_);
    return counts;
  }

  /// The same robot, whose parts may be elsewhere.
  void set_robot(const model_view<PartView>& robot) { model_ = robot, frames::extra_reaches(robot.facts, extra_); }
  void forget() { last_.clear(); }
  std::size_t parts() const { return model_.size(); }

 private:
  static constexpr std::size_t neighbours = 8;  ///< Configurations that follow one another on one thread.

  struct place {
    std::uint32_t cloud = none, point = none;
  };
  struct room {
    frames::cloud_frame frame;
    std::vector<ball_bounds> bounds;
    std::vector<margin_reach> near;
    std::vector<distance_key> best;
    std::vector<pending_pair<node_pair<typename PartView::hierarchy_type::node_type>, pair_order<PartView>>> pending;
    std::vector<pending_pair<field_pair, pair_order<PartView>>> by_field;
  };

  template <point_source S>
  static auto numbered(const S& source, std::uint32_t i, vec3 at) {
    if constexpr (ball_source<S>)
      return cloud_tree::numbered_ball{{at, i}, source.around(i, at).radius};
    else
      return cloud_tree::numbered_point{at, i};
  }

  template <class Clouds>
  void ask(const model_view<PartView>& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
           const Question& question, std::span<const place> starts, room& own, result_type& result) const {
    const auto parts = std::uint32_t(robot.size());
    typename Question::memory_type all = question.start();
    result = {};
    of_parts minima;
    if (!Question::by_margin && robots_ == 1 && !extra_.empty()) {
      own.best.assign(parts, no_key);
      minima = {own.best.data(), extra_.data()};
    }
    frames::float_error before;  // margins need the errors of all clouds
    if (Question::by_margin && trees_.size() > 1) {
      frames::for_each_turn(own.frame, robot.facts, poses, clouds, [](const auto&, const frames::turn&) {});
      before = own.frame.error;
    }
    frames::for_each_turn(
        own.frame, robot.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          const auto& places = own.frame.places;
          if constexpr (Question::by_margin) {
            before.widen(own.frame.error);
            own.near.clear();
            for (std::uint32_t k = 0; k < parts; ++k) own.near.push_back(question.near(k, robot.facts[k], before));
          }
          const auto answer = question.answer(&all, own.near.data(), minima);
          const scan::scan_body<PartView, S, any_depth, typename Question::answer_type> body{
              robot.parts, places.data(), parts, source, own.frame.origin, now.first, nullptr, answer, walk_};
          own.bounds.clear();
          for (std::uint32_t k = 0; k < parts; ++k) own.bounds.emplace_back(robot.facts[k], places[k].part_from_cloud);
          const auto tree = trees_[now.cloud].template view_of<S>();
          using body_type = std::remove_const_t<decltype(body)>;
          using tree_type = std::remove_const_t<decltype(tree)>;
          const auto walk = [&](const auto& search, auto& pending) {
            for (const place& p : starts)
              if (p.cloud == now.cloud && p.point < source.size())
                if (const sample s = source[p.point]; s.valid())
                  for (std::uint32_t k = 0; k < parts; ++k) search.seed(numbered(source, p.point, s.position), k);
            with_vectors([&] { walk_trees(search, pending); });
          };
          if (robot.fields != nullptr)
            walk(field_search<body_type, tree_type>{body, tree, own.bounds.data(), robot.fields, tree.levels},
                 own.by_field);
          else
            walk(tree_search<body_type, tree_type>{body, tree, own.bounds.data()}, own.pending);
          if constexpr (!Question::by_margin)
            minimum::resolve_body<PartView, S, any_depth>{
                robot.parts, places.data(), parts,  source, own.frame.origin, own.frame.world_from_cloud,
                now.first,   now.cloud,     answer, walk_,  &result,          nullptr}(parts);
        });
    if constexpr (Question::by_margin) {
      point_counts counts;
      scan::count(counts, dropped_.dropped, seen_);
      result = question.told(all, counts.valid, counts.dropped[int(drop_reason::too_close)] != 0);
    } else {
      minimum::conclude_body<PartView>{robot.parts,     parts,          &dropped_, {&all, minima.best, minima.extra},
                                       own.frame.error, own.frame.slop, seen_,     &result}(0);
      if (parts != 0) frames::beyond(result, question.d_max, own.frame.slop, own.frame.error);
    }
  }

  host_workers workers_;
  model_view<PartView> model_;
  std::size_t robots_;
  any_depth walk_;
  scan::drop_counts dropped_;
  std::uint64_t seen_ = 0;
  std::vector<cloud_tree::host_tree> trees_;
  std::vector<place> last_;
  std::vector<real> extra_;  ///< See extra_reaches.
  std::vector<room> rooms_;
};

}  // namespace clearance::plan
