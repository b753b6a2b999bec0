// SPDX-License-Identifier: BSD-3-Clause
// The test of kernels against a part's ball, on the host: nothing within reach fails it, and little else passes.
#include "support/laws.hpp"

#include <clearance/frame/root_test.hpp>

namespace root_test_test {

using namespace testing;
using clearance::capsule, clearance::frames::root_test, clearance::frames::capsule_test;

TEST_CASE("What is within reach of a part's ball passes its test, and what is clearly not does not") {
  verdict v;
  dice d(61);
  std::size_t within = 0, beyond = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const ball around{d.point(2), d.number(0, 1)};
    const real reach = d.number(-0.2, 1);
    const root_test test(around, reach);
    const double most = double(reach) + around.radius;
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

}  // namespace root_test_test
