// SPDX-License-Identifier: BSD-3-Clause
// A least distance with a deadline: over all points if there is time, otherwise over those that were looked at.
#include "support/closed.hpp"
#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/deadline.hpp>
#include <clearance/make_model.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <limits>

namespace deadline_test {

using namespace testing;
using namespace std::chrono_literals;
using clearance::host, clearance::min_distance, clearance::min_distance_per_part, clearance::placed,
    clearance::point_label, clearance::point_span;

namespace {

const std::chrono::duration<double> ever{clearance::infinity};

/// Points that remember who was looked at.
struct watched {
  point_span points;
  point_label* labels;  // `own`: nobody has

  std::size_t size() const { return points.size(); }
  clearance::sample operator[](std::size_t i) const {
    labels[i] = point_label::rest;
    return points[i];
  }
};

/// After every number of pieces the answer is that about the points that were looked at, which are all over the cloud.
template <class V, class P>
void cut_everywhere() {
  verdict v;
  std::size_t longest = 0;
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    clearance::query query(host{1}, model, min_distance{});
    for (std::size_t pieces = 0;; ++pieces) {
      std::vector<point_label> labels(s.points.size(), point_label::own);
      const placed cloud{watched{point_span(s.points), labels.data()}, s.cloud_pose};
      const auto r = ask_while(query, s.poses, cloud, [left = pieces]() mutable { return left-- > 0; }, min_distance{},
                               {.piece = 100});
      const std::size_t unseen = std::size_t(std::ranges::count(labels, point_label::own));
      const std::string what = s.name + " after " + std::to_string(pieces) + " pieces";
      v.require(r.unseen == unseen && r.result.seen == s.points.size() - unseen, what, ": other counts");
      auto expected = ask(host{1}, model, s.poses,
                          placed{clearance::masked(point_span(s.points), labels.data()), s.cloud_pose}, min_distance{});
      std::uint64_t bad = 0;
      for (std::size_t i = 0; i < labels.size(); ++i)
        bad += labels[i] == point_label::rest && !point_span(s.points)[i].valid();
      expected.seen -= unseen, expected.valid = expected.seen - bad;
      expected.dropped[int(clearance::drop_reason::masked)] = 0,
      expected.dropped[int(clearance::drop_reason::not_finite)] = bad;
      if (unseen != 0) expected.lower = 0;
      if (unseen != 0 && expected.state == clearance::state::free) expected.state = clearance::state::possible;
      v.require(same_result(r.result, expected), what, ": another answer");
      longest = std::max(longest, pieces);
      if (unseen == 0) break;
      std::size_t run = 0, gap = 0;
      for (const point_label label : labels) run = label == point_label::own ? run + 1 : 0, gap = std::max(gap, run);
      v.require(pieces == 0 || gap <= s.points.size() / std::bit_floor(pieces) + 4, what, ": a gap of", gap);
    }
  }
  CHECK(longest == 64);
}

}  // namespace

TEST_CASE("Cut after any piece it is the answer about the points that were looked at: inner spheres") {
  cut_everywhere<clearance::sphere, inner_sphere>();
}
TEST_CASE("Cut after any piece it is the answer about the points that were looked at: triangles") {
  cut_everywhere<clearance::aabb, triangle>();
}

TEST_CASE("In time it is the least distance, of clouds of any kind and in any pieces") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const std::tuple clouds(placed{all.raw, all.camera_pose}, placed{all.span, s.cloud_pose},
                            placed{all.doubles, s.cloud_pose});
    const auto expected = ask(host{}, model, s.poses, clouds, min_distance{});
    for (const std::size_t piece : {1, 37, 1000, 0}) {
      const auto r = ask_by(host{2}, model, s.poses, clouds, ever, min_distance{}, {.piece = piece});
      v.require(same_result(r.result, expected) && r.unseen == 0, s.name, " in pieces of", piece);
    }
  }
}

TEST_CASE("Points inside a closed mesh are found in whatever piece") {
  verdict v;
  dice d(83);
  const auto [meshes, poses] = closed_scene(82);
  const auto model = clearance::make_model<clearance::aabb>(meshes);
  for (int k = 0; k < 20; ++k) {
    auto points = d.points(1000, 4);
    const std::size_t from = d.below(990);
    for (std::size_t i = 0; k % 2 && i < 10; ++i) points[from + i] = d.point(0.3);
    v.require(same_result(ask_by(host{1}, model, poses, points, ever, min_distance{}, {.piece = 50}).result,
                          ask(host{1}, model, poses, points, min_distance{})),
              "cloud", k);
  }
  clearance::query query(host{1}, model, min_distance{});
  const auto crowd = d.points(2000, 0.5);
  const auto some =
      ask_while(query, poses, crowd, [left = 20]() mutable { return left-- > 0; }, min_distance{}, {.piece = 50});
  CHECK((some.result.state == clearance::state::collision && some.result.lower == 0 && some.result.upper == 0 &&
         some.unseen > 0));  // what is certain stays so
  CHECK(same_result(query(poses, crowd), ask(host{1}, model, poses, crowd, min_distance{})));
  // A bound that the query was given for some other frame is none of this one's.
  const std::vector<vec3> two{{9, 0, 0}, {9, 0, 0}, {9, 0, 0}, {9, 0, 0}, {99, 0, 0}};
  query.bound_by(1);
  CHECK(same_result(ask_by(query, poses, two, ever, min_distance{}, {.piece = 4}).result,
                    ask(host{1}, model, poses, two, min_distance{})));
}

TEST_CASE("No time, little time, and deadlines that are none") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const auto model = clearance::make_model<clearance::sphere>(std::vector<std::vector<inner_sphere>>{ball});
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const std::vector<vec3> points(100000, vec3{3, 0, 0});
  const auto none = ask_by(host{}, model, poses, points, 0s, min_distance{});
  CHECK((none.unseen == 100000 && none.result.seen == 0 && none.result.state == clearance::state::no_data &&
         none.result.lower == 0 && none.result.upper == infinity));
  const auto empty = ask_by(host{}, model, poses, std::vector<vec3>{}, 0s, min_distance{});
  CHECK(
      (same_result(empty.result, ask(host{}, model, poses, std::vector<vec3>{}, min_distance{})) && empty.unseen == 0));
  CHECK(same_result(ask_by(host{}, model, poses, points, 1h, min_distance{}).result,
                    ask(host{}, model, poses, points, min_distance{})));
  const auto some = ask_by(host{1}, model, poses, points, 1us, min_distance{}, {.piece = 8});
  CHECK(some.result.seen + some.unseen == 100000);
  CHECK((some.unseen == 0 || !(some.result.lower > 0)));
  for (const double seconds : {-1e-9, -1.0, std::numeric_limits<double>::quiet_NaN()})
    CHECK_THROWS_AS(ask_by(host{}, model, poses, points, std::chrono::duration<double>(seconds), min_distance{}),
                    std::invalid_argument);
  CHECK_THROWS_AS(ask_by(host{}, model, std::vector(2, poses[0]), points, 0s, min_distance{}), std::invalid_argument);
}

TEST_CASE("Asked per part, an answer with time for all is min_distance_per_part's, with its lower end") {
  verdict v;
  std::size_t higher = 0;
  for (const auto& s : scenes<inner_sphere>()) {
    std::vector<clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>> parts;
    for (std::size_t k = 0; k < s.parts.size(); ++k)
      parts.push_back(clearance::make_part(clearance::build<clearance::sphere>(s.parts[k]), 0.01 * double(k) * s.size));
    const clearance::model model{parts};
    const placed cloud{point_span(s.points), s.cloud_pose};
    const auto whole = ask(host{}, model, s.poses, cloud, min_distance_per_part{});
    const auto r = ask_by(host{}, model, s.poses, cloud, ever, min_distance_per_part{}, {.piece = 100});
    v.require(r.unseen == 0 && same_result(r.result.all, whole.all), s.name, ": another answer");
    v.require(std::ranges::equal(r.result.parts, whole.parts, same_minimum), s.name, ": some part's minimum differs");
    const auto one = ask_by(host{}, model, s.poses, cloud, ever, min_distance{}, {.piece = 100}).result;
    v.require(one.lower == r.result.all.lower, s.name, ": other than of min_distance:", one.lower);
    const double widest = 0.01 * double(s.parts.size() - 1) * s.size;  // the gap of the last part
    higher += one.lower > 0 && one.lower > one.distance - 0.999 * widest;
  }
  CHECK(higher > 0);  // a part with a lesser gap decided
}

}  // namespace deadline_test
