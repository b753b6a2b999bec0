// SPDX-License-Identifier: BSD-3-Clause
// Distances to full balls are those of a plain loop over all pairs, and brackets hold for whatever the balls fill.
#include "points/solid_balls_scenes.hpp"
#include "questions/uncertain_scenes.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace solid_balls_test {

using namespace testing;
using clearance::balls_of, clearance::host, clearance::min_distance, clearance::min_distance_per_part,
    clearance::placed, clearance::state;

namespace {

/// A user's own full balls, which cannot be asked for larger ones.
struct own_balls {
  using can = clearance::can<clearance::sources::capsules, clearance::sources::rounded>;
  static constexpr bool vague = false, balls = true;

  double gap;

  std::size_t size() const { return 1; }
  clearance::sample operator[](std::size_t) const { return {{3, 0, 0}, clearance::drop_reason::none}; }
  clearance::capsule around(std::size_t, vec3 p) const { return {p, {0, 0, 0}, 0.25f}; }
  clearance::position_error rounding() const { return {0, 0, gap}; }
};

template <class V, class P>
void all_scenes(std::size_t most_points) {
  verdict v;
  std::size_t free = 0, deep = 0;
  unsigned seed = 0;
  for (const auto& s : scenes<P>()) {
    if (s.points.size() > most_points) continue;
    for (const double gap : {0.0, 0.05}) {
      dice d(++seed);
      const auto radii = ball_radii_of(d, s.points.size(), 0.3 * s.size),
                 other = ball_radii_of(d, s.points.size(), 0.1);
      const auto near = balls_of(s.points, radii, gap * s.size), beside = balls_of(s.points, other, 2 * gap * s.size);
      const std::vector<placed<std::remove_const_t<decltype(near)>>> all{{near, s.cloud_pose},
                                                                         {beside, shifted(0.1, 0, 0) * s.cloud_pose}};
      const std::string what = s.name + ", gap " + std::to_string(gap);
      const auto model = make_model<V>(s, {}, clearance::wrapped{});
      const auto r = ask(host{}, model, s.poses, all, min_distance_per_part{});
      v.require(same_result(r.all, ask(host{2}, model, s.poses, all, min_distance{})), what, ": the least distance");
      const auto least = least_certain(s, all);
      for (std::uint32_t k = 0; k < least.size(); ++k) {
        const auto &got = r.parts[k], &its = least[k];
        v.require(got.cloud == its.cloud && (its.cloud == none) == !(got.distance < infinity), what, ": part", k);
        if (its.cloud == none) continue;
        const real size = clearance::absolute(its.distance) + radii[its.point] + other[its.point];
        v.require(clearance::absolute(got.distance - its.distance) <= 0x1p-20f * (size + real(s.size)), what, ": part",
                  k, " is at", got.distance, " and by the loop at", its.distance);
      }
      const auto certain = ask(host{}, model, s.poses, all, certain_distance{});
      v.require(same_result(certain.nominal, r.all), what, ": nominal");
      if (r.all.part == none) continue;
      const wide is = true_distance(s, all, d);
      v.require(r.all.lower <= is && is <= r.all.upper, what, ": ", r.all.lower, " to", r.all.upper, " misses", is);
      v.require(certain.lower <= is && is <= certain.upper, what, ": ", certain.lower, " to", certain.upper,
                ", certainly, misses", is);
      v.require(certain.lower >= r.all.lower - 1e-5 * s.size, what, ": less is certain of each pair than of all");
      free += r.all.state == state::free;
      deep += r.all.state == state::collision;
    }
  }
  CHECK((free > 1 && deep > 1));
}

}  // namespace

TEST_CASE("Distances of spheres to balls are those of all pairs, and the brackets hold for what the balls fill") {
  all_scenes<clearance::sphere, inner_sphere>(320);
}
TEST_CASE("Distances of triangles to balls are those of all pairs, and the brackets hold for what the balls fill") {
  all_scenes<clearance::aabb, triangle>(200);
}

TEST_CASE("What is certain takes from each ball its own gap, and the least distance the largest of all clouds") {
  const std::vector<vec3> at{{0.5f, 0, 0}}, far{{0, 0, 3}};
  const std::vector<real> radius{0.1f}, wide{1};
  const std::tuple clouds{placed{balls_of(at, radius)}, placed{balls_of(far, wide, 0.5)}};
  const auto part =
      clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 0.1f}}));
  const Eigen::Isometry3d pose = shifted(0, 0, 0);
  const auto near = [](double a, double b) { return std::abs(a - b) < 1e-5; };
  const auto r = ask(host{}, part, pose, clouds, min_distance{});
  CHECK((near(r.distance, 0.3) && near(r.upper, 0.3) && r.lower == 0 && r.state == state::possible));
  const auto certain = ask(host{}, part, pose, clouds, certain_distance{});
  CHECK((near(certain.lower, 0.3) && certain.state == state::free && certain.certain.shares.balls == 0));
  const auto alone = ask(host{}, part, pose, placed{balls_of(far, wide, 0.5)}, certain_distance{});
  CHECK((near(alone.lower, 1.4) && near(alone.upper, 1.9) && near(alone.certain.shares.balls, 0.5)));
  CHECK(near(alone.certain.distance - alone.certain.shares.sum(), alone.lower));
}

TEST_CASE("A ball that overlaps a part is as deep as their spheres, and a place of it inside is a collision") {
  const auto part =
      clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 0.5f}}));
  const std::vector<inner_sphere> balls{{{1, 0, 0}, 0.75f}};
  const auto r = ask(host{}, part, shifted(0, 0, 0), balls_of(balls, 0.1), min_distance{});
  CHECK((r.distance == -0.25f && r.state == state::collision && r.lower == 0 && r.upper == 0));
  CHECK((r.at.x == 1 && r.nearest.x == 0.5 && r.normal == vec3{1, 0, 0}));
  const auto around = clearance::uncertain(balls_of(balls), clearance::no_noise{}, {.shift = 0.125});
  const auto possible = ask(host{}, part, shifted(0, 0, 0), around, clearance::in_collision{});
  CHECK(possible.state == state::possible);
  CHECK(ask(host{}, part, shifted(0, 0, 0), balls_of(balls), clearance::in_collision{}).state == state::collision);
  CHECK(std::abs(around.around(0, {1, 0, 0}).radius - 0.875f) < 1e-5f);
}

namespace {

struct alignas(16) record_w {
  float x, y, z, w;
};
struct record_r {
  double before;
  float r, x, y, z;
};

template <class C>
void same_balls(const C& records, const std::vector<vec3>& at, const std::vector<real>& radii) {
  const auto its = balls_of(records);
  const auto own = balls_of(at, radii);
  REQUIRE(its.size() == own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    CHECK(its[i].position == own[i].position);
    CHECK(same_bytes(its.around(i, its[i].position), own.around(i, own[i].position)));
  }
}

}  // namespace

TEST_CASE("Records of a centre and a radius are balls, wherever they have them") {
  dice d(7);
  const auto at = d.points(50, 1);
  const auto radii = ball_radii_of(d, 50, 1);
  std::vector<record_w> w;
  std::vector<record_r> r;
  std::vector<ball> balls;
  std::vector<inner_sphere> spheres;
  for (std::size_t i = 0; i < at.size(); ++i) {
    w.push_back({at[i].x, at[i].y, at[i].z, radii[i]});
    r.push_back({1, radii[i], at[i].x, at[i].y, at[i].z});
    balls.push_back({at[i], radii[i]});
    spheres.push_back({at[i], radii[i]});
  }
  same_balls(w, at, radii);
  same_balls(r, at, radii);
  same_balls(balls, at, radii);
  same_balls(spheres, at, radii);
  same_balls(std::span<const inner_sphere>(spheres), at, radii);
  const auto slice = clearance::slice(balls_of(w), 10, 20);
  for (std::size_t i = 0; i < slice.size(); ++i)
    CHECK((slice[i].position == at[10 + i] && same_bits(slice.radius(i), radii[10 + i])));
}

TEST_CASE("Balls that cannot be are refused, and those that may be anywhere are counted") {
  std::vector<vec3> at{{3, 0, 0}, {4, 0, 0}};
  std::vector<real> radii{0.1f, -0.1f};
  using Catch::Matchers::Contains;
  CHECK_THROWS_WITH(balls_of(at, radii), Contains("the radius of ball 1 is -0.1"));
  CHECK_THROWS_WITH(balls_of(at, std::span(radii).first(1)), Contains("there are 2 balls, but 1 radii"));
  CHECK_THROWS_WITH(balls_of(at, std::span(radii), -1), Contains("the gap and the tolerance of balls are -1"));
  const auto part =
      clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 0.5f}}));
  for (const real bad : {-0.1f, clearance::not_a_number, 1e7f}) {
    radii[1] = bad;
    const auto r = ask(host{}, part, shifted(0, 0, 0), balls_of(at, std::span(radii)), min_distance{});
    CHECK((r.valid == 1 && r.dropped[int(clearance::drop_reason::too_close)] == 1 && r.state == state::possible));
  }
  auto unlike = balls_of(at, std::span(radii));
  unlike.source.count = 1;
  CHECK_THROWS_WITH(ask(host{}, part, shifted(0, 0, 0), unlike, min_distance{}), Contains("2 balls, but 1 radii"));
  CHECK(ask(host{}, part, shifted(0, 0, 0), own_balls{0}, clearance::certain_distance{}).lower > 2.2f);
  CHECK_THROWS_WITH(ask(host{}, part, shifted(0, 0, 0), own_balls{0.1}, clearance::certain_distance{}),
                    Contains("a cloud of full balls has a gap, and its source has no filled()"));
  const auto nothing = balls_of(at, std::span(radii), double(infinity));
  CHECK(ask(host{}, part, shifted(0, 0, 0), nothing, min_distance{}).lower == 0);
}

}  // namespace solid_balls_test
