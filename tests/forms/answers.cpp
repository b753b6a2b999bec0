// SPDX-License-Identifier: BSD-3-Clause
// Prints a hash of every bit of each answer, a line each: scripts/aarch64 compares what two processors print.
#include "forms/forms.hpp"
#include "support/catch.hpp"

#include <clearance/volume/obb.hpp>

#include <cstdio>

namespace answers {

using namespace testing;

/// FNV-1a, 64 bits.
std::uint64_t hash(const std::vector<std::byte>& bits) {
  std::uint64_t h = 0xcbf29ce484222325;
  for (const std::byte b : bits) h = (h ^ std::uint64_t(b)) * 0x100000001b3;
  return h;
}

TEST_CASE("Every question is asked on the host, and its answer's bits are printed") {
  std::size_t asked = 0;
  const auto print = [&](const char* what, std::size_t frame, const auto& answer) {
    const auto bits = bits_of(answer);
    std::printf("%016llx %8zu bytes: %s, frame %zu\n", (unsigned long long)hash(bits), bits.size(), what, frame);
    ++asked;
  };
  ask_everything([&]<class Q>(const char* name, const Q& q, const auto& model, const moving_frames& f) {
    const typename Q::result answer = ask(clearance::host{}, model, f.s.poses, f.here(), q);
    print(name, f.number, answer);
    if constexpr (std::is_same_v<Q, clearance::min_distance_per_part>)
      print("part_witnesses", f.number,
            ask(clearance::host{}, model, f.s.poses, f.here(), clearance::part_witnesses{answer.parts}));
  });
  CHECK(asked == 6 * 19);

  moving_frames f(3, 79);  // triangles, in any position
  scene<triangle> s;
  for (std::size_t part = 0; part < f.s.poses.size(); ++part) s.parts.push_back(random_triangles(f.d, 50, 0.2, 0.1));
  const auto model = make_model<clearance::obb>(s, {}, clearance::wrapped{});
  for (; f.there(); f.next()) {
    print("min_distance of triangles", f.number,
          ask(clearance::host{}, model, f.s.poses, f.here(), clearance::min_distance{}));
    print("distances of triangles", f.number,
          ask(clearance::host{}, model, f.s.poses, f.here(), clearance::distances{.d_max = 0.5}));
  }
  CHECK(asked == 6 * 21);
}

}  // namespace answers
