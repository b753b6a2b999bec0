// SPDX-License-Identifier: BSD-3-Clause
// Every question has every form that its declarations allow, with the bits of one call.
#include "forms/forms.hpp"
#include "support/catch.hpp"

#include <array>
#include <atomic>
#include <thread>
#include <vector>

namespace forms_test {

using namespace testing;
using clearance::host;

TEST_CASE("On the host, prepared questions, chunks and complete deadlines give the bits of one call") {
  verdict v;
  std::size_t asked = 0;
  ask_everything([&]<class Q>(const char* name, const Q& q, const auto& model, const moving_frames& f) {
    const std::string what = std::string(name) + ", frame " + std::to_string(f.number);
    check_forms(host{2}, model, model, q, f, ask(host{}, model, f.s.poses, f.here(), q), v, what);
    ++asked;
  });
  CHECK(asked == 6 * 18);
}

TEST_CASE("Near maps change no bit of any answer") {
  verdict v;
  check_near_maps_change_nothing(v, []<class Q>(const auto& model, const Q& q, const moving_frames& f) {
    clearance::query prepared(host{2}, model, q);
    prepared(f.s.poses, f.here());
    return typename Q::result(prepared(f.s.poses, f.here()));
  });
}

TEST_CASE("While points are unseen, nothing is said that another point could make false") {
  verdict v;
  moving_frames f(4, 78);
  const auto model = f.model();
  for (; f.there(); f.next()) {
    if (f.points[0].size() < 2000) continue;
    for_each_question([&]<class Q>(const char* name, const Q& q) {
      if constexpr (forms_of<Q>::by_deadline) {
        clearance::query prepared(host{}, model, q);
        const auto whole = ask(host{}, model, f.s.poses, f.here(), q);
        for (int pieces = 0; pieces < 6; ++pieces) {
          int left = pieces;
          const auto known = ask_while(prepared, f.s.poses, f.here(), [&] { return left-- > 0; }, q, {.piece = 1000});
          const std::string what = std::string(name) + " after " + std::to_string(pieces) + " pieces";
          v.require(known.unseen > 0, what, ": ", known.unseen, " unseen");
          const auto state_holds = [&](clearance::state now, clearance::state then) {
            v.require(now != clearance::state::free, what, ": free");
            v.require(now != clearance::state::collision || then == clearance::state::collision, what, ": collision");
          };
          if constexpr (std::is_same_v<Q, clearance::zones>) {
            v.require(known.result.innermost() == 0, what, ": innermost");
            for (std::size_t i = 0; i < whole.zones.size(); ++i)
              v.require(known.result.zones[i].points <= whole.zones[i].points, what, ": zone ", i);
          } else if constexpr (std::is_same_v<Q, clearance::in_collision>) {
            state_holds(known.result.state, whole.state);
          } else if constexpr (std::is_same_v<Q, clearance::in_collisions>) {
            for (std::size_t c = 0; c < whole.of.size(); ++c) state_holds(known.result.of[c], whole.of[c]);
          } else if constexpr (std::is_same_v<Q, clearance::min_distance>) {
            state_holds(known.result.state, whole.state);
            v.require(known.result.lower == 0 && known.result.upper >= whole.upper, what, ": bracket");
          }
        }
      }
    });
  }
}

TEST_CASE("Threads that share a robot, each with a prepared question of its own, get the bits of one") {
  verdict v;
  ask_everything([&]<class Q>(const char* name, const Q& q, const auto& model, const moving_frames& f) {
    const auto once = ask(host{}, model, f.s.poses, f.here(), q);
    std::array<std::atomic<bool>, 4> same{};
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < same.size(); ++k)
      threads.emplace_back([&, k] {
        const host on{std::array{0u, 1u, 2u, 1u}[k]};  // all threads of TBB, this one alone, two
        clearance::query prepared(on, model, q);
        bool all = same_answer(once, ask(on, model, f.s.poses, f.here(), q));
        for (int time = 0; time < 2; ++time)
          all = all && same_answer(once, typename Q::result(prepared(f.s.poses, f.here())));
        same[k] = all;
      });
    for (std::thread& each : threads) each.join();
    for (const auto& each : same) v.require(each, name, ", frame ", f.number);
  });
}

}  // namespace forms_test
