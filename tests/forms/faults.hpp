// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Memory ends at every allocation of a question, in any form. Include it in one source of a program.

#include "forms/forms.hpp"
#include "support/failing_new.hpp"

#include <optional>
#include <string>

namespace testing {

/// Two frames before a robot: what fits the memory of the first does not fit that of the second.
struct two_frames {
  moving_frames few{2, 79}, many{2, 79};
  two_frames() { few.see(30), many.see(1100); }
};

/// Asks an object of `make` about few points, then about many where memory ends, then about both. `call(end, work)`
/// calls `work()`, and throws std::bad_alloc if that was told in another way. Returns how many places there were.
template <class Make, class Asked, class R, class Call>
std::size_t end_memory_of(const Make& make, const Asked& asked, const R& of_few, const R& of_many, const two_frames& f,
                          verdict& v, const std::string& what, const Call& call) {
  const auto attempt = [&](end_of_memory& end) {
    auto object = make();
    v.require(same_answer(asked(object, f.few), of_few), what, ": another answer before");
    std::optional<R> found;
    const bool done = end.during([&] { call(end, [&] { found.emplace(asked(object, f.many)); }); });
    v.require(done || end.reached, what, ": no memory, though there is");
    if (done) v.require(same_answer(*found, of_many), what, ": another answer at allocation", end.k);
    const auto again = [&](const moving_frames& at, const R& expected, const char* how_many) {
      v.require(same_answer(asked(object, at), expected), what, ": another answer of ", how_many, " after allocation",
                end.k);
    };
    if (end.k % 2 == 0) again(f.many, of_many, "many");
    again(f.few, of_few, "few");
    again(f.many, of_many, "many");
  };
  end_of_memory never{failing_allocations::none - 1, false};
  attempt(never);  // libraries keep something from their first use on
  const std::size_t places = end_memory_everywhere(
      attempt, [&](std::size_t k) { v.require(false, what, ": allocation", k, " loses memory"); });
  v.require(places > 0, what, ": nothing was allocated");
  return places;
}
template <class Make, class Asked, class R>
std::size_t end_memory_of(const Make& make, const Asked& asked, const R& of_few, const R& of_many, const two_frames& f,
                          verdict& v, const std::string& what) {
  return end_memory_of(make, asked, of_few, of_many, f, v, what, [](const auto&, const auto& work) { work(); });
}

}  // namespace testing
