// SPDX-License-Identifier: BSD-3-Clause
// The test of kernels against a part's ball, on the host: nothing within reach fails it, and little else passes.
#include "support/laws.hpp"

#include <clearance/frames/root_test.hpp>

namespace root_test_test {

using namespace testing;
using clearance::capsule, clearance::frames::root_test, clearance::frames::capsule_test;

/// A ball and a reach, at least `least`, with their test, and how far from the ball's middle a place may be.
struct tested_ball {
  ball around;
  real reach;
  root_test test;
  double most;
};
tested_ball tested(dice& d, real least) {
  const ball around{d.point(2), d.number(0, 1)};
  const real reach = d.number(least, 1);
  return {around, reach, root_test(around, reach), double(reach) + around.radius};
}

TEST_CASE("What is within reach of a part's ball passes its test, and what is clearly not does not") {
  verdict v;
  dice d(61);
  std::size_t within = 0, beyond = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto [around, reach, test, most] = tested(d, -0.2f);
    for (int k = 0; k < 200; ++k) {
      const capsule c{d.point(3), d.point(k % 2), d.number(0, k % 4 == 3 ? 0.3 : 0)};
      const vec3 far = c.from - around.center, end = far + c.along;
      const double point = length(far);
      double way = std::min<double>(point, length(end));
      if (const real square = dot(c.along, c.along); square > 0) {
        const real share = std::clamp(-dot(far, c.along) / square, 0.0f, 1.0f);
        way = length(far + scaled(share, c.along));
      }
      const bool passes = test.passes(c.from), sweeps = test.passes(capsule_test(c));
      v.require(passes || point > most, "a point at ", point, " of ", most, " fails");
      v.require(!passes || (most >= 0 && point <= most + 0.01), "a point at ", point, " of ", most, " passes");
      v.require(passes == clearance::frames::may_reach(around, reach, c.from) || std::abs(point - most) < 0.01,
                "the tests differ");
      if (most < 0.02) continue;  // a capsule's reach begins at its radius
      v.require(sweeps || way - c.radius > most, "a capsule at ", way, " fails");
      v.require(clearance::frames::may_reach(around, reach, c) || way - c.radius > most, "it is not within reach");
      v.require(!sweeps || way - c.radius <= most + 0.01, "a capsule at ", way, " of ", most, " passes");
      ++(way - c.radius <= most ? within : beyond);
    }
    v.require(!test.passes({clearance::not_a_number, 0, 0}), "no point passes");
  }
  CHECK((within > 1000 && beyond > 1000));
}

TEST_CASE("A line of sight that may hide something within reach of a ball passes its test") {
  verdict v;
  dice d(62);
  std::size_t within = 0, beyond = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto [around, reach, test, most] = tested(d, 0);
    const vec3 origin = trial % 3 == 0 ? vec3{0, 0, 0} : d.point(3);
    for (int k = 0; k < 200; ++k) {
      const vec3 start = scaled(k % 5 == 0 ? 1e-4f : 1, d.point(3));  // from the eye
      const vec3 way = around.center - (start - origin);
      const double far = length(way), along = dot(way, start) / std::max<double>(length(start), 1e-30);
      const double least = along <= 0 ? far : std::sqrt(std::max(far * far - along * along, 0.0));
      const bool passes = test.passes(clearance::frames::sight_test(start - origin, origin));
      v.require(passes || least > most, "a line at ", least, " of ", most, " fails");
      if (length(start) > length(origin) / 16)
        v.require(!passes || least <= most + 0.01, "a line at ", least, " of ", most, " passes");
      ++(least <= most ? within : beyond);
    }
    v.require(!test.passes(clearance::frames::sight_test({clearance::not_a_number, 0, 0}, origin)), "no point passes");
    v.require(test.passes(clearance::frames::sight_test(-origin, origin)), "what begins at the eye fails");
  }
  CHECK((within > 1000 && beyond > 1000));
}

}  // namespace root_test_test
