// SPDX-License-Identifier: BSD-3-Clause
// On a device and on several, every question has every form that its declarations allow, with the bits of the host.
#include "forms/forms.hpp"
#include "support/catch.hpp"

#include <clearance/device.cuh>

namespace forms_device_test {

using namespace testing;
using clearance::host, clearance::device, clearance::devices;

TEST_CASE("One call, prepared questions and two devices give the bits of the host") {
  verdict v;
  const device gpu{};
  const devices two{0, 0};
  std::size_t asked = 0;
  ask_everything([&]<class Q>(const char* name, const Q& q, const auto& model, const moving_frames& f) {
    const std::string what = std::string(name) + ", frame " + std::to_string(f.number);
    const auto there = model.on(gpu);
    const auto expected = ask(host{}, model, f.s.poses, f.here(), q);
    v.require(same_answer(expected, ask(gpu, there, f.s.poses, f.here(), q)), what, ": once");
    clearance::query prepared(gpu, there, q);
    for (const char* time : {"cold", "warm"})
      v.require(same_answer(expected, typename Q::result(prepared(f.s.poses, f.here()))), what, ": ", time);
    if constexpr (forms_of<Q>::in_pieces) {
      const auto on_both = model.on(two);
      v.require(same_answer(expected, ask(two, on_both, f.s.poses, f.here(), q)), what, ": two devices");
      clearance::chunked chunks(clearance::point_span(f.points[0]), 4096);
      clearance::chunked_query by_chunks(gpu, there, q);
      const auto of_one = ask(host{}, model, f.s.poses, clearance::point_span(f.points[0]), f.here()[0].pose, q);
      for (const char* time : {"first", "second"})
        v.require(same_answer(of_one, by_chunks(f.s.poses, chunks, f.here()[0].pose)), what, ": in chunks, the ", time,
                  " time");
    }
    if constexpr (forms_of<Q>::by_deadline) {
      auto known = ask_by(prepared, f.s.poses, f.here(), std::chrono::hours(1), q, {.piece = 999});
      v.require(known.unseen == 0 && same_answer(expected, known.result), what, ": by a deadline");
    }
    ++asked;
  });
  CHECK(asked == 6 * 18);
}

}  // namespace forms_device_test
