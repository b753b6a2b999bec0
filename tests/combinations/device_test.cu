// SPDX-License-Identifier: BSD-3-Clause
// On a device and on two, each kind of source has the host's answers, and declarations say of real backends what the
// table says.
#include "combinations/enqueued.hpp"
#include "combinations/table.hpp"
#include "support/catch.hpp"
#include "support/product.hpp"

#include <clearance/device.cuh>
#include <clearance/volume/sphere.hpp>

namespace combinations_device_test {

using namespace combinations;
using clearance::device, clearance::devices, clearance::host, clearance::why_not;

namespace {

/// Do declarations say of these backends what they say of those in the table?
template <class Q, class Clouds, class On, class As>
constexpr bool as_in_table = why_not<Q, Clouds, form::once, On>() == why_not<Q, Clouds, form::once, As>() &&
                             why_not<Q, Clouds, form::enqueued, On>() == why_not<Q, Clouds, form::enqueued, As>() &&
                             why_not<Q, Clouds, form::in_chunks, On>() == why_not<Q, Clouds, form::in_chunks, As>() &&
                             why_not<Q, Clouds, form::by_deadline, On>() == why_not<Q, Clouds, form::by_deadline, As>();

using some_kinds = kinds<points, image, balls, room>;

/// Those that Q takes on several devices are asked on both kinds of backend; all are, on one.
template <class Q>
void check_on_device(const char* name, const Q& q, std::size_t configurations) {
  verdict v;
  const device gpu{};
  const devices two{0, 0};
  const scene_before_a_robot before;
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  const auto poses = before.configurations(configurations);
  const auto there = robot.on(gpu);
  const auto everything = [](std::size_t) { return true; };
  using on_one = common<some_kinds, taken<Q, form::once, device>>;
  const auto all = before.all(on_one(), everything, 0.02f);
  const typename Q::result expected = ask(host{}, robot, poses, all, q);
  clearance::query prepared(gpu, there, q);
  for (const char* time : {"cold", "warm"})
    v.require(same_answer(expected, typename Q::result(prepared(poses, all))), name, ": ", time);
  clearance::frames::readable_clouds<device> copies(gpu);
  const auto here = copies(all);
  if constexpr (clearance::planning_question<Q>) {
    prepared.place(poses);
    const auto* const written = prepared.enqueue(here, q);
    v.require(same_answer(gpu.copy_out(written, expected.of.size()), expected.of), name, ": placed and enqueued");
  } else {
    v.require(writes_the_same(gpu, prepared, poses, here, q, expected, robot.size(), count_points(all)), name,
              ": enqueued");
  }
  using on_two = common<some_kinds, taken<Q, form::once, devices>>;
  const auto some = before.all(on_two(), everything, 0.02f);
  v.require(same_answer(typename Q::result(ask(host{}, robot, poses, some, q)),
                        typename Q::result(ask(two, robot.on(two), poses, some, q))),
            name, ": two devices");
}

}  // namespace

TEST_CASE("the table says of stand-ins what is so of a device and of several") {
  bool same = true;
  for_each_question_type([&]<class Q>(const char*) {
    for_each_kind(all_kinds(), [&]<class S>() {
      same = same && as_in_table<Q, S, device, as_device> && as_in_table<Q, S, devices, as_devices>;
    });
  });
  CHECK(same);
}

TEST_CASE("on a device and on two, counted points have the host's answers for each kind of source") {
  check_on_device("zones", clearance::zones{.thresholds = {0.05, 0.2, 0.6}, .radii = {0.02}}, 1);
}
TEST_CASE("on a device and on two, configurations have the host's answers for each kind of source") {
  check_on_device("min_distances", clearance::min_distances{.d_max = 0.3, .radii = {0.02}}, 2);
}

}  // namespace combinations_device_test
