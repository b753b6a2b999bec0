// SPDX-License-Identifier: BSD-3-Clause
// A debug build notices a prepared object that is asked while it is being asked.
#include "support/catch.hpp"
#include "support/product.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

#include <functional>
#include <thread>

namespace in_use_test {

using namespace testing;
using clearance::host;

namespace {

/// A source that does something when a point is read.
struct busy_points {
  clearance::point_span points;
  const std::function<void()>* meanwhile;

  std::size_t size() const { return points.size(); }
  clearance::sample operator[](std::size_t i) const {
    (*meanwhile)();
    return points[i];
  }
};
static_assert(clearance::point_source<busy_points>);

/// What it throws when another thread asks; empty if it answers.
std::string refusal(const std::function<void()>& ask) {
  std::string said;
  std::thread([&] {
    try {
      ask();
    } catch (const std::logic_error& e) {
      said = e.what();
    }
  }).join();
  return said;
}

const std::string sentence =
    "clearance: a prepared question is asked while it is being asked; give each thread its own";

template <class Q>
void ask_twice(const Q& q) {
  dice d(91);
  scene<inner_sphere> s{"", {random_spheres(d, 20), random_spheres(d, 20)}, {d.pose(1), d.pose(1)}, d.points(500, 2)};
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clearance::point_span cloud(s.points);
  clearance::query prepared(host{1}, model, q);
  clearance::query copy = prepared;
  std::string same, other, enqueued;
  const std::function<void()> meanwhile = [&] {
    if (!other.empty()) return;
    same = refusal([&] { prepared(s.poses, cloud); });
    other = "answered" + refusal([&] { copy(s.poses, cloud); });
    if constexpr (requires(typename Q::out to) { prepared.enqueue(s.poses, cloud, to); })
      enqueued = refusal([&] { prepared.enqueue(s.poses, cloud, typename Q::out{}); });
  };
  prepared(s.poses, busy_points{cloud, &meanwhile}, s.cloud_pose);
  CHECK(same == sentence);
  CHECK((enqueued.empty() || enqueued == sentence));
  CHECK(other == "answered");
  CHECK(refusal([&] { prepared(s.poses, cloud); }).empty());  // afterwards another thread may have it
  s.poses.pop_back();
  CHECK_THROWS_AS(prepared(s.poses, cloud), std::invalid_argument);
  s.poses.push_back(s.poses[0]);
  CHECK_NOTHROW(prepared(s.poses, cloud));  // also after a refusal
}

}  // namespace

TEST_CASE("A debug build refuses a question asked twice at once") {
#if defined(NDEBUG)
  WARN("SKIPPED: a release build does not look");
  return;
#endif
  ask_twice(clearance::min_distance{});
  ask_twice(clearance::zones{.thresholds = {0.5}});
}

TEST_CASE("A debug build refuses chunks asked twice at once") {
#if defined(NDEBUG)
  WARN("SKIPPED: a release build does not look");
  return;
#endif
  dice d(92);
  scene<inner_sphere> s{"", {random_spheres(d, 20)}, {d.pose(1)}, d.points(500, 2)};
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  clearance::chunked_query by_chunks(host{1}, model, clearance::min_distance{});
  std::string same;
  const std::function<void()> meanwhile = [&] {
    clearance::chunked again(clearance::point_span(s.points), 100);
    if (same.empty()) same = refusal([&] { by_chunks(s.poses, again); });
  };
  clearance::chunked chunks(busy_points{clearance::point_span(s.points), &meanwhile}, 100);
  by_chunks(s.poses, chunks);
  CHECK(same == sentence);
}

}  // namespace in_use_test
