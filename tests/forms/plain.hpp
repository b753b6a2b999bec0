// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every question with a traversal of one's own has the bits of the host's answer, in every form; and that traversal
// walks.

#include "forms/forms.hpp"
#include "support/same_result.hpp"
#include "support/tallied.hpp"

#include <clearance/motion_clearance.hpp>
#include <clearance/questions/collect.hpp>
#include <clearance/questions/min_distance_filtered.hpp>
#include <clearance/seen_and_unseen.hpp>

#include <array>
#include <map>

namespace testing {

using clearance::plain, clearance::host;

/// A traversal of one's own: with a stack, the last child first. It counts its walks.
struct last_first {
  static constexpr std::uint32_t capacity = 64;

  unsigned long long* walks;

  template <clearance::hierarchy H, clearance::visitor Q>
  CLEARANCE_HD void operator()(const H& tree, vec3 p, Q& q) const {
    clearance::add_to(walks, 1);
    typename H::node_type pending[capacity];
    std::uint32_t count = 0;
    pending[count++] = tree.root();
    while (count > 0) {
      const auto n = pending[--count];
      if (!(clearance::bound_for(q, tree.volume(n), p) <= q.reach())) continue;
      if (tree.is_leaf(n)) {
        clearance::offer_leaf(tree, n, p, q);
        continue;
      }
      for (std::uint32_t k = 0; k < tree.size(n); ++k) pending[count++] = tree.child(n, k);
    }
  }
};

/// A backend with `last_first`, and how often it has walked there.
template <class B>
struct counted_walks {
  B on;
  typename B::template buffer<unsigned long long> walks =
      on.copy_in(std::span<const unsigned long long>(std::array{0ull}));

  auto backend() const { return plain{on, last_first{const_cast<unsigned long long*>(walks.data())}}; }
  unsigned long long count() const { return on.copy_out(walks)[0]; }
};

/// Each question once, prepared, in chunks and by a deadline. Its forms are those of `B` alone.
template <class B>
void check_every_question(const B& there, verdict& v) {
  const counted_walks<B> counted{there};
  const auto on = counted.backend();
  std::map<std::string, unsigned long long> walks;
  std::size_t asked = 0;
  ask_everything([&]<class Q>(const char* name, const Q& q, const auto& model, const moving_frames& f) {
    const std::string what = std::string(name) + ", frame " + std::to_string(f.number);
    const unsigned long long before = counted.count();
    const auto robot = model.on(there);
    const auto expected = ask(host{}, model, f.s.poses, f.here(), q);
    v.require(same_answer(expected, ask(on, robot, f.s.poses, f.here(), q)), what, ": once");
    walks[name] += counted.count() - before;
    check_forms(on, robot, model, q, f, expected, v, what);
    ++asked;
  });
  v.require(asked == 6 * 18, asked, " questions");
  for (const auto& [name, times] : walks) v.require(times > 0, name, ": the traversal never walked");
}

/// Enqueued: `out` lies where `B` writes.
template <class B>
void check_enqueued(const B& there, verdict& v) {
  const counted_walks<B> counted{there};
  const auto on = counted.backend();
  moving_frames f(4, 79);
  const auto model = f.model();
  const auto robot = model.on(there);
  const auto& poses = f.s.poses;
  std::vector<typename B::template buffer<std::byte>> copies;
  clouds readable = f.here();
  for (auto& cloud : readable) {
    const auto bytes = cloud.source.bytes();
    copies.push_back(there.copy_in(bytes));
    cloud.source = cloud.source.at(copies.back().data());
  }
  std::size_t points = 0;
  for (const auto& cloud : readable) points += cloud.source.size();
  const std::size_t parts = model.size();
  const auto room = [&]<class T>(const T&, std::size_t n) { return there.template make_scratch<T>(n); };
  auto counts = room(clearance::point_counts{}, 1);
  unsigned long long before = 0;
  const auto enqueue = [&](const char* name, const auto& q, const auto& to) {
    clearance::query prepared(on, robot, q);
    for (int time = 0; time < 2; ++time) prepared.enqueue(poses, readable, to);
    v.require(counted.count() > before, name, ": the traversal never walked");
    before = counted.count();
    return ask(host{}, model, poses, f.here(), q);
  };
  const auto same_counts = [&](const char* name, const clearance::point_counts& expected) {
    v.require(same_bytes(there.copy_out(counts.data(), 1)[0], expected), name, ": other counts");
  };
  {
    auto to = room(clearance::min_distance_result{}, 1);
    const auto expected = enqueue("min_distance", clearance::min_distance{}, to.data());
    v.require(same_result(there.copy_out(to.data(), 1)[0], expected), "min_distance, enqueued");
  }
  {
    auto all = room(clearance::min_distance_result{}, 1);
    auto minima = room(clearance::part_minimum{}, parts);
    const auto expected = enqueue("min_distance_per_part", clearance::min_distance_per_part{},
                                  clearance::min_distance_per_part::out{all.data(), minima.data()});
    v.require(same_result(there.copy_out(all.data(), 1)[0], expected.all) &&
                  same_answer(there.copy_out(minima.data(), parts), expected.parts),
              "min_distance_per_part, enqueued");
    auto witnesses = room(clearance::part_witness{}, parts);
    const auto places = enqueue("part_witnesses", clearance::part_witnesses{expected.parts},
                                clearance::part_witnesses::out{minima.data(), witnesses.data()});
    const auto found = there.copy_out(witnesses.data(), parts);
    for (std::size_t k = 0; k < parts; ++k) v.require(same_witness(found[k], places[k]), "part_witnesses, enqueued");
  }
  {
    auto distance = room(real(0), points);
    auto which = room(std::uint32_t(0), 2 * points);
    const auto expected =
        enqueue("distances", clearance::distances{.d_max = 0.4, .which = true},
                clearance::distances::out{{distance.data(), which.data(), which.data() + points}, counts.data()});
    v.require(same_answer(there.copy_out(distance.data(), points), expected.distance) &&
                  same_answer(there.copy_out(which.data(), points), expected.part) &&
                  same_answer(there.copy_out(which.data() + points, points), expected.primitive),
              "distances, enqueued");
    same_counts("distances", expected.counts);
  }
  {
    auto distance = room(real(0), parts * points);
    const auto expected = enqueue("distances_per_part", clearance::distances_per_part{.d_max = 0.4},
                                  clearance::distances_per_part::out{distance.data(), counts.data()});
    v.require(same_answer(there.copy_out(distance.data(), parts * points), expected.distance),
              "distances_per_part, enqueued");
    same_counts("distances_per_part", expected.counts);
  }
  {
    const clearance::zones q{.thresholds = {0.1, 0.3}};
    auto zones = room(clearance::zone{}, 2 * parts);
    const auto expected = enqueue("zones", q, clearance::zones::out{zones.data(), counts.data()});
    v.require(same_answer(there.copy_out(zones.data(), 2 * parts), expected.zones), "zones, enqueued");
    same_counts("zones", expected.counts);
  }
  {
    auto to = room(clearance::collision_result{}, 1);
    const auto expected = enqueue("in_collision", clearance::in_collision{{0.1}}, to.data());
    v.require(same_answer(there.copy_out(to.data(), 1)[0], expected), "in_collision, enqueued");
  }
  const auto listed = [&](const char* name, const auto& q) {
    auto pairs = room(clearance::pair_distance{}, 1 << 14);
    auto count = room(0ull, 1);
    const auto expected = enqueue(name, q, clearance::within::out{pairs.data(), 1 << 14, count.data(), counts.data()});
    clearance::within_result found;
    found.pairs = there.copy_out(pairs.data(), std::size_t(there.copy_out(count.data(), 1)[0]));
    clearance::pairwise::put_in_order(found, parts);
    v.require(same_answer(found.pairs, expected.pairs), name, ", enqueued");
    same_counts(name, expected.counts);
  };
  listed("within", clearance::within{{0.2}}), listed("nearest_k", clearance::nearest_k{.k = 9});
  {
    auto labels = room(clearance::point_label{}, points);
    auto own = room(clearance::self_filter_counts{}, 1);
    const auto expected = enqueue("self_filter", clearance::self_filter{.padding = {0.1}},
                                  clearance::self_filter::out{labels.data(), own.data()});
    v.require(same_answer(there.copy_out(labels.data(), points), expected.labels) &&
                  same_bytes(there.copy_out(own.data(), 1)[0], expected.counts),
              "self_filter, enqueued");
  }
  {
    tally_of_pairs expected;
    clearance::ask(host{}, model, poses, f.here(), clearance::collect{tallied{0.5f, expected.words}});
    const auto words = there.copy_in(std::span<const unsigned long long>(std::array{0ull, 0ull}));
    clearance::query prepared(on, robot,
                              clearance::collect{tallied{0.5f, const_cast<unsigned long long*>(words.data())}});
    prepared.enqueue(poses, readable, clearance::collect<tallied>::out{counts.data()});
    v.require(there.copy_out(words) == std::vector(expected.words, expected.words + 2), "collect, enqueued");
  }
}

/// What else takes a backend: images, clouds with radii, and helpers that ask several questions.
template <class B>
void check_what_is_made_of_questions(const B& there, verdict& v) {
  const counted_walks<B> counted{there};
  const auto on = counted.backend();
  moving_frames f(4, 80);
  f.see(4000);
  const auto model = f.model();
  const auto robot = model.on(there);
  const auto& poses = f.s.poses;
  unsigned long long before = 0;
  const auto walked = [&](const char* name, bool same) {
    v.require(same, name, ": another answer");
    v.require(counted.count() > before, name, ": the traversal never walked");
    before = counted.count();
  };

  std::vector<float> depth;
  for (int i = 0; i < 64 * 48; ++i) depth.push_back(0.3f + 0.01f * real(f.d.below(150)));
  std::vector<clearance::point_label> labels(depth.size());
  for (auto& its : labels) its = f.d.below(5) == 0 ? clearance::point_label::own : clearance::point_label::rest;
  const clearance::placed image{clearance::depth_image(depth.data(), 64, 48, {40, 40, 31.5, 23.5}), shifted(0, 0, -1)};
  clearance::seen_and_unseen both;
  both.room = {.nearest = 0.2f, .farthest = 3}, both.labels = labels, both.places = true;
  const auto same_unseen = [](const clearance::unseen_result& a, const clearance::unseen_result& b) {
    return same_result(a.all, b.all) && same_result(a.own_shadow, b.own_shadow) &&
           std::ranges::equal(a.parts, b.parts, [](const auto& x, const auto& y) {
             return same_witness(x, y) && same_bits(x.lower, y.lower) && same_bits(x.out_of_view, y.out_of_view);
           });
  };
  {
    const auto mine = ask(on, robot, poses, image, both), theirs = ask(host{}, model, poses, image, both);
    walked("seen_and_unseen", same_unseen(mine, theirs) && same_result(mine.seen, theirs.seen));
  }
  const clearance::unseen hidden = both;
  walked("unseen", same_unseen(ask(on, robot, poses, image, hidden), ask(host{}, model, poses, image, hidden)));

  const clearance::placed vague{
      clearance::uncertain(clearance::point_span(f.points[0]), clearance::no_noise{}, {.shift = 0.02, .turn = 0.01}),
      shifted(0, 0, 0)};
  const clearance::certain_distance certain{{{0.01, 0.02}, {}, {0, 0.03}, {}}};
  walked("certain_distance",
         same_answer(ask(on, robot, poses, vague, certain), ask(host{}, model, poses, vague, certain)));
  const clearance::zones zones{.thresholds = {0.1, 0.3}};
  walked("zones, uncertain", same_answer(ask(on, robot, poses, vague, zones), ask(host{}, model, poses, vague, zones)));

  {
    const clearance::self_filter filter{.padding = {0.05}};
    const auto mine = clearance::min_distance_filtered(on, robot, poses, f.here(), filter),
               theirs = clearance::min_distance_filtered(host{}, model, poses, f.here(), filter);
    walked("min_distance_filtered", same_answer(mine.filter, theirs.filter) && same_result(mine.rest, theirs.rest));
  }
  {
    const std::vector robots{robot.view(), robot.view()};
    const std::vector models{model.view(), model.view()};
    const std::vector all{poses, poses};
    const auto mine = clearance::min_distance_per_robot(on, robots, all, f.here()),
               theirs = clearance::min_distance_per_robot(host{}, models, all, f.here());
    walked("min_distance_per_robot", std::ranges::equal(mine, theirs, same_result));
  }
  {
    std::vector<clearance::chain_link> links(4);
    for (auto& link : links) link.value = 0, link.factor = 1;
    const clearance::joint_chain<host> chain(links, {0, 1, 2, 3}, {{"turn", {-3, 3}}});
    const std::vector<double> joints{-1, 0, 0.5, 2};
    clearance::query mine(on, robot, clearance::min_distances{});
    clearance::query theirs(host{}, model, clearance::min_distances{});
    const clearance::min_distances_result expected = theirs(chain, joints, f.here());
    walked("min_distances of joint vectors", same_answer(mine(chain, joints, f.here()), expected));
  }
  {  // a part alone
    const auto part = model.parts()[0];
    const auto its = part.on(there);
    walked("a part alone",
           same_answer(ask(on, its, poses[0], f.here(), zones), ask(host{}, part, poses[0], f.here(), zones)));
  }
}

}  // namespace testing
