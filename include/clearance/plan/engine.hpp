// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks about many configurations on one backend, frame after frame.

#include <clearance/cloud_tree/host_tree.hpp>
#include <clearance/frames/bracket.hpp>
#include <clearance/frames/clouds.hpp>
#include <clearance/frames/readable.hpp>
#include <clearance/plan/configurations.hpp>
#include <clearance/plan/tree_search.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/robot/widened.hpp>
#include <clearance/traversal/any_depth.hpp>

#include <algorithm>
#include <vector>

namespace clearance::plan {

/// For a backend without a search of its own: each configuration by itself. As all engines of plans: `begin` or
/// `begin_chain`, and then `finish`, whose result stays valid until the next call. Refused (std::invalid_argument):
/// poses that are no whole configurations, joint vectors as by joint_chain::count, and what the question refuses.
template <class On, class PartView, class Q>
class engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : on_(on), model_(model), widened_(on, model, from...) {}

  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    const std::size_t parts = model_.size(), count = count_configurations(parts, poses.size());
    result_ = {};
    Q::take_counts(result_, {}, parts);
    Q::results(result_).resize(count * (Q::each_part ? parts : 1));
    const auto robot = widened_(q.radii);
    named(parts, poses, [&] {
      for (std::size_t c = 0; c < count; ++c)
        q.ask_one(on_, robot, poses.subspan(c * parts, parts), clouds, result_, c);
    });
  }
  template <class Clouds>
  void begin_chain(const joint_chain<host>& chain, std::span<const double> joints, const Clouds& clouds, const Q& q) {
    begin(checked_chain(chain, model_.size()).poses(joints), clouds, q);
  }
  typename Q::result& finish() { return result_; }

  void forget() const {}

 private:
  On on_;
  model_view<PartView> model_;
  widened_model<On, PartView> widened_;
  typename Q::result result_;
};

/// A pair that is still to be opened. The nearest goes first.
template <class Pair, class Order>
struct pending_pair {
  Order order;
  Pair pair;

  friend bool operator<(const pending_pair& a, const pending_pair& b) { return a.order > b.order; }
};

/// One thread searches for one configuration in one cloud, nearest pairs first. `pending` is memory to work with.
template <class Search>
void search_by_thread(const Search& search,
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

/// On the CPU: a tree over each cloud, and each configuration searches all of them. It keeps memory and each
/// configuration's last minimum. The next search begins there, and where the previous configuration's ended. That
/// changes only how long it takes.
template <class PartView, class Q>
class engine<host, PartView, Q> {
  using question_type = typename Q::searched;
  static constexpr bool by_margin = question_type::by_margin;

 public:
  engine(const host& on, const model_view<PartView>& model)
      : workers_(on), widened_(on, model), model_(model), walk_{stack_need(model.depth, model.width)} {}

  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    question_type question = q.checked(model_.size());
    if constexpr (by_margin) question.vague = any_vague(clouds);
    model_ = widened_(q.radii);
    frames::extra_reaches(model_.facts, extra_);
    Q::results(result_).resize(count_configurations(model_.size(), poses.size()) * (Q::each_part ? model_.size() : 1));
    named(model_.size(), poses, [&] {
      point_counts counts;
      if (!poses.empty()) {
        build_trees(poses.first(model_.size()), clouds);
        search_all(poses, clouds, question);
        scan::count(counts, dropped_.dropped, seen_);
      }
      Q::take_counts(result_, counts, model_.size());
    });
  }
  template <class Clouds>
  void begin_chain(const joint_chain<host>& chain, std::span<const double> joints, const Clouds& clouds, const Q& q) {
    begin(checked_chain(chain, model_.size()).poses(joints), clouds, q);
  }
  typename Q::result& finish() { return result_; }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { last_.clear(); }

 private:
  static constexpr std::size_t neighbours = 8;  ///< Configurations that follow one another on one thread.

  using order_type = pair_order<PartView>;
  /// What a thread needs for one configuration.
  struct room {
    frames::cloud_frame frame;
    std::vector<ball_bounds> bounds;
    std::vector<margin_reach> near;
    std::vector<distance_key> best;
    std::vector<pending_pair<node_pair<typename PartView::hierarchy_type::node_type>, order_type>> pending;
    std::vector<pending_pair<field_pair, order_type>> by_field;
  };

  template <class Clouds>
  void build_trees(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds) {
    dropped_ = {};
    frames::cloud_frame frame;
    seen_ = frames::for_each_turn(frame, model_.facts, poses, clouds, [&](const auto& source, const frames::turn& now) {
      if (trees_.size() <= now.cloud) trees_.resize(now.cloud + 1);
      trees_[now.cloud].build(workers_, source, dropped_);
    });
  }

  /// With `each_part` each part of a configuration is a robot of its own.
  template <class Clouds>
  void search_all(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const question_type& question) {
    auto& results = Q::results(result_);
    const std::size_t count = results.size(), robots = Q::each_part ? model_.size() : 1, parts = model_.size() / robots,
                      piece = neighbours * robots;
    if (last_.size() != count) last_.assign(count, {});
    rooms_.resize((count + piece - 1) / piece);
    workers_.for_pieces(count, piece, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) {
        const last_place starts[] = {last_[c], c >= begin + robots ? last_[c - robots] : last_place{}};
        const auto robot = Q::each_part ? model_.part(c % robots) : model_;
        search_one(robot, poses.subspan(c * parts, parts), clouds, question, starts, rooms_[begin / piece], results[c]);
        if constexpr (!by_margin) {
          last_[c] = {results[c].cloud, results[c].point};
          if (results[c].part != none) results[c].part += std::uint32_t(c % robots);
        }
      }
    });
  }

  template <class Clouds>
  void search_one(const model_view<PartView>& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                  const question_type& question, std::span<const last_place> starts, room& own,
                  typename question_type::result_type& result) const {
    const auto parts = std::uint32_t(robot.size());
    typename question_type::memory_type all = question.start();
    result = {};
    of_parts minima;
    if (!by_margin && !Q::each_part && !extra_.empty()) {
      own.best.assign(parts, no_key);
      minima = {own.best.data(), extra_.data()};
    }
    frames::float_error before;  // margins need the errors of all clouds
    if (by_margin && trees_.size() > 1) {
      frames::for_each_turn(own.frame, robot.facts, poses, clouds, [](const auto&, const frames::turn&) {});
      before = own.frame.error;
    }
    frames::for_each_turn(own.frame, robot.facts, poses, clouds, [&](const auto& source, const frames::turn& now) {
      if constexpr (by_margin) {
        before.widen(own.frame.error);
        own.near.clear();
        for (std::uint32_t k = 0; k < parts; ++k) own.near.push_back(question.near(k, robot.facts[k], before));
      }
      const auto answer = question.answer(&all, own.near.data(), minima);
      search_cloud(robot, source, now, answer, starts, own);
      if constexpr (!by_margin) find_witness(robot, source, now, answer, own.frame, result);
    });
    if constexpr (by_margin)
      result = question.told(all, dropped_, seen_);
    else
      question.conclude(result, robot.parts, parts, &dropped_, &all, minima, own.frame, seen_);
  }

  template <point_source S, class Answer>
  void search_cloud(const model_view<PartView>& robot, const S& source, const frames::turn& now, const Answer& answer,
                    std::span<const last_place> starts, room& own) const {
    const auto parts = std::uint32_t(robot.size());
    const auto& places = own.frame.places;
    own.bounds.clear();
    for (std::uint32_t k = 0; k < parts; ++k) own.bounds.emplace_back(robot.facts[k], places[k].part_from_cloud);
    using body_type = scan::scan_body<PartView, S, any_depth, Answer>;
    const body_type body{.parts = robot.parts,
                         .places = places.data(),
                         .part_count = parts,
                         .source = source,
                         .origin = own.frame.origin,
                         .first = now.first,
                         .counts = nullptr,
                         .answer = answer,
                         .walk = walk_};
    const auto tree = trees_[now.cloud].template view_of<S>();
    using tree_type = std::remove_const_t<decltype(tree)>;
    const auto from_starts = [&](const auto& search, auto& pending) {
      for (const last_place& p : starts)
        if (p.cloud == now.cloud && p.point < source.size())
          if (const sample s = source[p.point]; s.valid())
            for (std::uint32_t k = 0; k < parts; ++k) search.seed(numbered(source, p.point, s.position), k);
      with_vectors([&] { search_by_thread(search, pending); });
    };
    const points_search<body_type, tree_type> search{body, tree, own.bounds.data()};
    if (robot.fields != nullptr)
      from_starts(field_search<body_type, tree_type>{search, robot.fields, tree.levels}, own.by_field);
    else
      from_starts(tree_search<body_type, tree_type>{search}, own.pending);
  }
  template <point_source S>
  static auto numbered(const S& source, std::uint32_t i, vec3 at) {
    if constexpr (ball_source<S>)
      return cloud_tree::numbered_ball{{at, i}, source.around(i, at).radius};
    else
      return cloud_tree::numbered_point{at, i};
  }

  template <point_source S>
  void find_witness(const model_view<PartView>& robot, const S& source, const frames::turn& now,
                    const minimum::shared_bounds& answer, const frames::cloud_frame& frame,
                    min_distance_result& result) const {
    const minimum::resolve_body<PartView, S, any_depth> body{.parts = robot.parts,
                                                             .places = frame.places.data(),
                                                             .part_count = std::uint32_t(robot.size()),
                                                             .source = source,
                                                             .origin = frame.origin,
                                                             .world_from_cloud = frame.world_from_cloud,
                                                             .first = now.first,
                                                             .cloud = now.cloud,
                                                             .bounds = answer,
                                                             .walk = walk_,
                                                             .result = &result,
                                                             .minima = nullptr};
    body(robot.size());
  }

  host_workers workers_;
  widened_model<host, PartView> widened_;
  model_view<PartView> model_;  ///< With the radii of the last call.
  any_depth walk_;
  scan::drop_counts dropped_;
  std::uint64_t seen_ = 0;  ///< Points of all clouds.
  std::vector<cloud_tree::host_tree> trees_;
  std::vector<last_place> last_;
  std::vector<real> extra_;  ///< See extra_reaches.
  std::vector<room> rooms_;
  typename Q::result result_;
};

}  // namespace clearance::plan
