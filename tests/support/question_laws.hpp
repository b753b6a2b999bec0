// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Laws of questions about pairs, on any backend. `Cases` (zones_cases is one) says what is asked, what is right by
// definition and where a backend writes it, and counts what it saw: so a test can tell that there was something to see.

#include "support/frames.hpp"

namespace testing {

/// Where a backend writes one list, `Cases::values` of the result, and counts. A question that writes something else
/// has a `written` of its own.
template <class Cases, class On>
struct written_list {
  using result = typename Cases::question::result;
  using value = typename std::remove_cvref_t<decltype(std::declval<result>().*Cases::values)>::value_type;

  const On& on;
  typename On::template buffer<value> values;
  typename On::template buffer<clearance::point_counts> counts = room_on<clearance::point_counts>(on, 1);

  written_list(const On& on, std::size_t parts, std::size_t points)
      : on(on), values(on.copy_in(std::span<const value>(Cases::room(parts, points)))) {}
  typename Cases::question::out out() { return {values.data(), counts.data()}; }
  void require(const result& expected, verdict& v, const std::string& what) const {
    result found = expected;
    found.*Cases::values = on.copy_out(values.data(), (expected.*Cases::values).size());
    found.counts = on.copy_out(counts)[0];
    require_same(found, expected, v, what);
    v.require(found.counts.valid == expected.counts.valid, what, ": counts");
  }
};

/// Where `on` writes the answers to a question, or nullptr if that cannot be enqueued.
template <class Cases, class On>
auto written(const On& on, std::size_t parts, std::size_t points) {
  if constexpr (requires { typename Cases::template written<On>; })
    return typename Cases::template written<On>(on, parts, points);
  else if constexpr (requires { Cases::values; })
    return written_list<Cases, On>(on, parts, points);
  else
    return nullptr;
}

/// In every scene each backend says of two clouds, and of the first alone, what is right by definition.
template <class V, class P, class Cases, class... On>
void hold_in_all_scenes(Cases& cases, const On&... on) {
  using question = typename Cases::question;
  struct one_case {
    clouds all;
    question asked;
    typename question::result expected;
    std::string what;
  };
  verdict v;
  for (const auto& s : scenes<P>()) {
    std::vector<one_case> all;
    const auto add = [&](const clouds& its, const question& q, const std::string& what) {
      all.push_back({its, q, cases.by_definition(s, its, q), s.name + what});
      cases.saw(all.back().expected);
    };
    const auto two = two_clouds(s);
    for (const question& q : cases.of_scene(s)) add(two, q, ", question " + std::to_string(all.size()));
    add({two[0]}, all[0].asked, ", one cloud");
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto hold = [&](const auto& its, const auto& there) {
      for (const one_case& c : all) require_same(ask(its, there, s.poses, c.all, c.asked), c.expected, v, c.what);
    };
    (hold(on, model.on(on)), ...);
  }
}

/// Frame after frame a prepared question says what the host says in one call, waited for and enqueued, and goes on
/// after one that is refused. Then `more(frames, query, model, verdict)` may ask it in other ways.
template <class Cases, class On, class More>
void hold_in_every_frame(Cases& cases, const On& on, std::size_t parts, unsigned seed, const More& more) {
  using question = typename Cases::question;
  verdict v;
  moving_frames f(int(parts), seed);
  const auto model = f.model();
  const auto there = model.on(on);
  clearance::query query(on, there, Cases::of_frame(0, parts));
  for (; f.there(); f.next()) {
    const question q = Cases::of_frame(f.number, parts);
    const std::string what = std::to_string(parts) + " parts, frame " + std::to_string(f.number);
    const auto expected = ask(clearance::host{}, model, f.s.poses, f.here(), q);
    v.require(expected.counts.valid + 1 >= moving_frames::sizes[f.number], what, ": counts");
    cases.saw(expected);
    const frame_there seen(on, f);
    auto to = written<Cases>(on, parts, seen.count());
    if constexpr (!std::is_null_pointer_v<decltype(to)>) {
      query.enqueue(f.s.poses, seen.all, q, to.out());
      to.require(expected, v, what + ", enqueued");
    }
    require_same(query(f.s.poses, f.here(), q), expected, v, what);
    for (const question& none : Cases::refused())
      CHECK_THROWS_AS(query(f.s.poses, f.here(), none), std::invalid_argument);
    CHECK_THROWS_AS(query(std::span(f.s.poses).first(parts - 1), f.here(), q), std::invalid_argument);
  }
  more(f, query, model, v);
}
template <class Cases, class On>
void hold_in_every_frame(Cases& cases, const On& on, std::size_t parts, unsigned seed) {
  hold_in_every_frame(cases, on, parts, seed, [](const auto&...) {});
}

}  // namespace testing
