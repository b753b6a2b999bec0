// SPDX-License-Identifier: BSD-3-Clause
// Uncertain clouds in slices, in chunks and by a deadline have the answers of one call, in every bit.
#include "questions/uncertain_forms.hpp"

#include <clearance/points/depth_image.hpp>
#include <clearance/questions/nearest_points.hpp>

namespace uncertain_forms_test {

using namespace testing;
using clearance::chunked, clearance::host, clearance::placed, clearance::point_span, clearance::uncertain;

namespace {

/// Points of a record each, with a radius beside the place.
struct record {
  vec3 at;
  real radius;
};
struct beside {
  const record* records;
  real operator()(std::size_t i, vec3) const { return records[i].radius; }
};
struct places {
  const record* records;
  std::size_t count;
  std::size_t size() const { return count; }
  clearance::sample operator[](std::size_t i) const {
    const vec3 p = records[i].at;
    return {p, is_finite(p) ? clearance::drop_reason::none : clearance::drop_reason::not_finite};
  }
};

template <class Whole, class Part>
void same_points(const Whole& whole, const Part& part, std::size_t first, verdict& v, const std::string& what) {
  for (std::size_t i = 0; i < part.size(); ++i) {
    const clearance::sample a = part[i], b = whole[first + i];
    v.require(a.dropped == b.dropped, what, ": point", first + i, " is dropped, or not");
    if (!a.valid() || !b.valid()) continue;
    v.require(same_bytes(part.around(i, a.position), whole.around(first + i, b.position)), what, ": the ball of point",
              first + i);
    const auto its = part.shares(i, a.position), own = whole.shares(first + i, b.position);
    v.require(same_bytes(its, own), what, ": the shares of point", first + i);
  }
}

template <class S>
void deal(const S& whole, verdict& v, const std::string& what) {
  static_assert(clearance::ball_source<S>);
  dice d(31);
  for (int k = 0; k < 20; ++k) {
    const std::size_t begin = d.below(unsigned(whole.size())),
                      end = begin + d.below(unsigned(whole.size() - begin) + 1);
    const auto some = clearance::slice(whole, begin, end);
    v.require(some.size() == end - begin, what, ": a slice of another size");
    same_points(whole, some, begin, v, what + ", a slice");
    const std::size_t more = d.below(unsigned(end - begin) + 1);
    same_points(whole, clearance::slice(some, more, end - begin), begin + more, v, what + ", a slice of a slice");
    if constexpr (requires(clearance::extent& e, real& r, std::uint32_t(&n)[clearance::drop_reasons]) {
                    some.survey_capsules(0, e, e, r, n);
                  })
      for (std::size_t i = 0; i + 128 <= some.size(); i += 128) {
        clearance::extent box, ends;
        std::uint32_t dropped[clearance::drop_reasons] = {};
        real widest = 0;
        if (!some.survey_capsules(i, box, ends, widest, dropped)) continue;
        for (std::size_t j = i; j < i + 128; ++j)
          if (const auto p = some[j]; p.valid())
            v.require(some.around(j, p.position).radius <= widest, what, ": a ball is wider than a survey says");
      }
  }
  const clearance::thinned<std::remove_cvref_t<decltype(whole)>> some{whole, 3};  // a device's first look
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (const auto p = some[i]; p.valid())
      v.require(i % 3 == 0 && same_bits(some.around(i, p.position).radius, whole.around(i, p.position).radius), what,
                ": another ball in a sample");
  std::vector<decltype(clearance::piece_of(whole, 0, 1))> pieces;
  for (std::size_t k = 0; k < 3; ++k) pieces.push_back(clearance::piece_of(whole, k, 3));
  const clearance::sharded again(pieces);
  static_assert(clearance::ball_source<std::remove_const_t<decltype(again)>>);
  same_points(whole, again, 0, v, what + ", in pieces");
}

}  // namespace

TEST_CASE("In slices and in pieces every point keeps its ball, whatever its radius depends on") {
  verdict v;
  const wall_of_balls w(3000, -1);
  const clearance::cloud_uncertainty off{0.01, 0.02, 1, 0.05};
  const point_span seen(w.points, {.sensor = {0.5f, 0.2f, -1}});  // a slice is seen from there, too
  deal(uncertain(seen, clearance::lidar_noise{0.01f, 0.002f}, off), v, "lidar");
  deal(uncertain(seen, clearance::no_noise{}, off), v, "no noise");
  deal(uncertain(seen, by_number{}, off), v, "a formula of the number");
  deal(w.source(), v, "radii");
  clearance::any_noise any{.kind = clearance::noise_kind::radii, .radii = {w.radii.data(), w.radii.size()}};
  deal(uncertain(seen, any, off), v, "radii, chosen late");
  any.kind = clearance::noise_kind::tof, any.tof = {0.01f, 0.001f};
  deal(uncertain(seen, any, off), v, "time of flight, chosen late");
  std::vector<float> pixels(3000);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = i % 97 == 0 ? 0 : real(1 + i % 13);
  const clearance::depth_image<float> image(pixels.data(), 60, 50, {60, 60, 30, 25});
  deal(uncertain(image, clearance::kinect_noise{}, off), v, "an image");
  deal(uncertain(image, clearance::stereo_noise{60, 0.05f, 0.08f}, off), v, "an image of two eyes");
  deal(uncertain(image, by_number{}, off), v, "an image and a formula of the number");

  const clearance::sharded halves(std::vector{seen.slice(0, 1000), seen.slice(1000, 3000)});
  const uncertain around(halves, clearance::point_radii(w.radii.data(), w.radii.size()), off);
  const uncertain whole(seen, clearance::point_radii(w.radii.data(), w.radii.size()), off);
  same_points(whole, around, 0, v, "around pieces");
  same_points(whole, clearance::piece_of(around, 1, 2), 1000, v, "the second of them");
  const point_span elsewhere(w.points, {.sensor = {0.5f, 0.2f, 1}});
  CHECK_THROWS_WITH(uncertain(clearance::sharded(std::vector{seen, elsewhere})),
                    Catch::Matchers::Contains("piece 1 of an uncertain cloud is seen from another place"));
}

TEST_CASE("Uncertain clouds in chunks have the answer of one call, whatever is skipped") {
  verdict v;
  const auto model = arm();
  const auto pose = shifted(0.1, 0, 0);
  const auto check = [&](const auto& source, auto& chunks, const std::string& what) {
    chunks.forget();
    for_each_question_of_balls(arm_poses, [&]<class Q>(const char* name, const Q& q, auto poses) {
      // Points that are read are compiled for a few questions alone.
      if constexpr (!std::is_same_v<decltype(source.source), places> || !requires { typename Q::searched; }) {
        clearance::chunked_query ask_it(host{}, model, q);
        for (int round = 0; round < 3; ++round, poses[0].translation().x() += round == 2 ? 3 : 0.02)
          v.require(same_answer(ask(host{}, model, poses, source, pose, q), ask_it(poses, chunks, pose)), what, ": ",
                    name, ", round ", round);
      }
    });
  };
  for (const std::size_t n : {0, 1, 4097, 30000})
    for (const real bad : {0.0f, -1.0f}) {
      const wall_of_balls w(n, bad);
      const std::string what = std::to_string(n) + (bad == 0 ? "" : ", some of which may be anywhere");
      for (const std::size_t chunk : {1, 20000}) {
        chunked chunks(w.source(), chunk);
        check(w.source(), chunks, what + " in chunks of " + std::to_string(chunk));
      }
    }
  const wall_of_balls w(20000);
  std::vector<record> records;
  for (std::size_t i = 0; i < w.points.size(); ++i) records.push_back({w.points[i], w.radii[i]});
  const auto read = [&](std::size_t offset, std::span<std::byte> to) {
    std::memcpy(to.data(), reinterpret_cast<const std::byte*>(records.data()) + offset, to.size());
  };
  const auto view = [](const std::byte* memory, std::size_t count) {
    const auto* const its = reinterpret_cast<const record*>(memory);
    return uncertain(places{its, count}, beside{its}, {.shift = 0.002});
  };
  chunked chunks(clearance::read_records(records.size(), sizeof(record), read, view), 4096);
  check(view(reinterpret_cast<const std::byte*>(records.data()), records.size()), chunks, "read");
}

TEST_CASE("The second question about an uncertain cloud reads what can matter, which is decided by the balls") {
  const wall_of_balls w(400000);
  const auto model = arm();
  chunked chunks(w.source(), 16384);
  const auto second = [&](const auto& q) {
    clearance::chunked_query query(host{}, model, q);
    chunks.forget();
    query(arm_poses, chunks);
    CHECK(query.loaded() == w.points.size());
    query(arm_poses, chunks);
    return query.loaded();
  };
  CHECK(second(clearance::min_distance{}) < w.points.size() / 2);
  CHECK(second(clearance::zones{.thresholds = {0.1}}) < w.points.size() / 2);
  CHECK(second(clearance::certain_distance{}) == w.points.size());
}

TEST_CASE("By a deadline an uncertain cloud has the answer of one call, or what holds wherever the unseen points are") {
  verdict v;
  const auto model = arm();
  const wall_of_balls first(9000), second(5000);
  std::vector<float> pixels(64 * 48, 3.0f);
  const clearance::depth_image<float> image(pixels.data(), 64, 48, {60, 60, 32, 24});
  const std::tuple clouds{placed{first.source(), shifted(0.1, 0, 0)}, placed{point_span(second.points)},
                          placed{uncertain(image, by_number{}, {.shift = 0.01}), shifted(0, 0, -2)}};
  using clearance::state;
  for_each_question_of_balls(arm_poses, [&]<class Q>(const char* name, const Q& q, const auto& poses) {
    if constexpr (clearance::partial_question<Q>) {
      clearance::query query(host{}, model, q);
      const auto whole = ask(host{}, model, poses, clouds, q);
      for (const std::size_t piece : {37, 2000})
        v.require(same_answer(ask_by(query, poses, clouds, std::chrono::hours(1), q, {.piece = piece}).result, whole),
                  name, ": by a deadline, in pieces of ", piece);
      const auto cut = [&](int pieces) {
        const auto known = ask_while(query, poses, clouds, [&] { return pieces-- > 0; }, q, {.piece = 1000});
        v.require(known.unseen > 0, name, ": nothing is unseen");
        return known.result;
      };
      for (int pieces = 0; pieces < 5; ++pieces) {
        const auto holds = [&](const auto& now, const auto& then) {
          v.require(now.lower == 0 && now.upper >= then.upper && now.state != state::free, name, " after ", pieces);
        };
        const auto known = cut(pieces);
        if constexpr (std::is_same_v<Q, clearance::min_distance>) holds(known, whole);
        if constexpr (std::is_same_v<Q, clearance::min_distance_per_part>) holds(known.all, whole.all);
        if constexpr (std::is_same_v<Q, clearance::certain_distance>) {
          holds(known, whole), holds(known.nominal, whole.nominal);
          v.require(known.certain.lower == 0 && (pieces == 0 || known.parts.at(1).to_ball >= whole.parts.at(1).to_ball),
                    name, ": a part after ", pieces);
          for (const auto& part : known.parts) v.require(part.lower == 0, name, ": a part is free after ", pieces);
        }
        if constexpr (std::is_same_v<Q, clearance::in_collision>)
          v.require(known.state == (pieces == 0 ? state::no_data : state::possible) || known.state == state::possible,
                    name, ": after ", pieces);
        if constexpr (std::is_same_v<Q, clearance::zones>)
          v.require(known.innermost() == 0, name, ": innermost after ", pieces);
        if constexpr (std::is_same_v<Q, clearance::in_collisions>)
          for (const state its : known.of) v.require(its != state::free && its != state::collision, name);
      }
    }
  });
}

}  // namespace uncertain_forms_test
