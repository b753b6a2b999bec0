// SPDX-License-Identifier: BSD-3-Clause
// On a device and on several, every question has every form that its declarations allow, with the bits of the host.
#include "forms/digest.hpp"
#include "forms/soak.hpp"
#include "support/catch.hpp"
#include "support/counted_memory.cuh"

#include <clearance/device.cuh>

namespace forms_device_test {

using namespace testing;
using clearance::host, clearance::device, clearance::devices;

TEST_CASE("One call, prepared questions and two devices give the bits of the host") {
  verdict v;
  const device gpu{};
  const devices two{0, 0};
  std::size_t asked = 0;
  const auto ask_all_forms = [&]<class Q>(const char* name, const Q& q, const auto& model, const moving_frames& f) {
    const std::string what = std::string(name) + ", frame " + std::to_string(f.number);
    const auto there = model.on(gpu);
    const auto expected = ask(host{}, model, f.s.poses, f.here(), q);
    v.require(same_answer(expected, ask(gpu, there, f.s.poses, f.here(), q)), what, ": once");
    check_forms(gpu, there, model, q, f, expected, v, what);
    if constexpr (forms_of<Q>::in_pieces) {
      const auto on_both = model.on(two);
      v.require(same_answer(expected, ask(two, on_both, f.s.poses, f.here(), q)), what, ": two devices");
    }
    ++asked;
  };
  for (const bool maps : {false, true})
    ask_everything(ask_all_forms, [&](const auto& model) { return maps ? with_near_maps(model) : model; });
  CHECK(asked == 2 * 6 * 18);
}

TEST_CASE("On a device near maps change no bit of any answer") {
  verdict v;
  const device gpu{};
  check_near_maps_change_nothing(v, [&]<class Q>(const auto& model, const Q& q, const moving_frames& f) {
    const auto there = model.on(gpu);
    clearance::query prepared(gpu, there, q);
    if (f.number % 2 == 1) prepared(f.s.poses, f.here());
    return typename Q::result(prepared(f.s.poses, f.here()));
  });
}

TEST_CASE("On a device, on any stream, on two and in chunks every answer has the bits that are kept") {
  cudaStream_t streams[3] = {};  // the first is the device's own
  for (int k : {1, 2}) REQUIRE(cudaStreamCreateWithFlags(&streams[k], cudaStreamNonBlocking) == cudaSuccess);
  for (int run = 0; run < digest_runs(); ++run) {
    const device gpu{.id = 0, .stream = streams[run % 3]};
    const digests all = digests_of([&]<class Q>(const Q& q, const auto& model, const moving_frames& f) {
      const auto there = model.on(gpu);
      clearance::query its(gpu, there, q);
      if (run % 2 == 1) its(f.s.poses, f.here());
      return typename Q::result(its(f.s.poses, f.here()));
    });
    INFO("run " << run << ": the digests are\n" << text_of(all));
    REQUIRE(all == kept_digests);
    const digests by_chunks = digests_of([&]<class Q>(const Q& q, const auto& model, const moving_frames& f) {
      if constexpr (forms_of<Q>::in_pieces) {
        const auto there = model.on(gpu);
        clearance::chunked chunks(clearance::point_span(f.points[0]), 1000 + run % 500);
        clearance::chunked_query its(gpu, there, q);
        return its(f.s.poses, chunks, f.here()[0].pose);
      }
    });
    INFO("in chunks: the digests are\n" << text_of(by_chunks));
    REQUIRE(by_chunks == kept_digests_of_chunks);
  }
  for (int k : {1, 2}) cudaStreamDestroy(streams[k]);
}

TEST_CASE("Frame after frame a device's prepared questions are right, and take no more memory") {
  verdict v;
  counted_memory own;
  std::size_t room = 0, all = 0, first_room = 0, first_held = 0, frames = 0;
  const auto look = [&](const soak_frame&) {
    if (++frames % 50 != 0) return;
    REQUIRE(cudaMemGetInfo(&room, &all) == cudaSuccess);
    if (frames == 150) first_room = room, first_held = own.held;
  };
  std::pmr::memory_resource* const memory = &own;
  const soak_counts n = soak(device{}, soak_seconds(), 19, v, look, memory);
  print(n, soak_seconds());
  std::printf("device memory after 150 frames and later: held %.2f and at most %.2f MB, free %.1f and %.1f MB\n",
              double(first_held) / 1e6, double(own.most) / 1e6, double(first_room) / 1e6, double(room) / 1e6);
  CHECK(n.refused > 0);
  CHECK(n.by_brute_force > 0);
  CHECK(own.held == 0);
  CHECK(double(own.most) - double(first_held) < 64e6);
  CHECK(double(first_room) - double(room) < 64e6);
  CHECK(n.end.resident - n.begin.resident < 48e6);
}

TEST_CASE("Answer after answer, a device counts every valid point", "[slow]") {
  moving_frames f(4, 19);
  f.see(2600);
  for (auto& cloud : f.points)
    for (std::size_t i = 0; i < cloud.size(); i += 37) cloud[i].y = clearance::not_a_number;
  const auto here = f.model();
  const auto there = here.on(device{});
  const clearance::nearest_k q{.k = 7};
  const auto valid = ask(host{}, here, f.s.poses, f.here(), q).counts.valid;
  clearance::query prepared(device{}, there, q);
  std::size_t wrong = 0;
  for (int k = 0; k < 5000; ++k) wrong += prepared(f.s.poses, f.here()).counts.valid != valid;
  CHECK(wrong == 0);
}

}  // namespace forms_device_test
