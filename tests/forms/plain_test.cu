// SPDX-License-Identifier: BSD-3-Clause
// On a device a traversal of one's own walks under every question, and changes no bit of any answer.
#include "forms/plain.hpp"
#include "support/catch.hpp"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/traversal/recursive.hpp>

namespace plain_device_test {

using namespace testing;
using clearance::device;

TEST_CASE("On a device a traversal of one's own walks under every question, and changes no bit") {
  verdict v;
  check_every_question(device{}, v);
}
TEST_CASE("On a device, enqueued, too") {
  verdict v;
  check_enqueued(device{}, v);
}
TEST_CASE("On a device images, clouds with radii, and helpers that ask several questions take it, too") {
  verdict v;
  check_what_is_made_of_questions(device{}, v);
}

TEST_CASE("On a device a recursion that may need more call stack than there is is refused, whatever is asked") {
  const device gpu;
  const plain on{gpu, clearance::recursive{}};
  moving_frames f(4, 82);
  const auto model = f.model();
  const auto there = model.on(gpu);
  const clearance::zones zones{.thresholds = {0.1, 0.4}};
  const clearance::distances distances{};
  {
    const deep_stack small(512);
    CHECK_THROWS_AS(ask(on, there, f.s.poses, f.here(), zones), std::invalid_argument);
    CHECK_THROWS_AS(ask(on, there, f.s.poses, f.here(), distances), std::invalid_argument);
  }
  const deep_stack enough(16384);
  CHECK(same_answer(ask(on, there, f.s.poses, f.here(), zones), ask(host{}, model, f.s.poses, f.here(), zones)));
  CHECK(
      same_answer(ask(on, there, f.s.poses, f.here(), distances), ask(host{}, model, f.s.poses, f.here(), distances)));
}

}  // namespace plain_device_test
