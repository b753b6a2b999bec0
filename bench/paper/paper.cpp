// SPDX-License-Identifier: BSD-3-Clause
// The CPU part of the paper's comparison, for machines without a GPU: the competitors by the size of the cloud, and the
// node tests of Algorithm 1. CSV, as from bench_paper_device.
//
//   bench_paper [FILE.csv [STAMP]]            with CLEARANCE_QUICK=1 a test: small clouds, exact against brute force
#include "host_competitors.hpp"

#include <clearance/volume/sphere.hpp>

int main(int count, char** arguments) try {
  using namespace bench::paper;
  if (quick) host_budget = 0;
  report out(count > 1 ? arguments[1] : nullptr, count > 2 ? arguments[2] : "on the host");
  const bench::scene& robot = bench::the_scene();
  const auto model = bench::sphere_model<clearance::sphere>(robot);
  const auto binary = bench::sphere_model<clearance::sphere>(robot, {.width = 2, .leaf_size = 1});
  for (const scenario& s : scenarios(robot)) {
    for (const std::size_t n : quick ? std::vector{quick_points} : s.sizes) host_competitors(out, s, n, model, binary);
    host_along_motion(out, s, quick ? quick_points : s.along_motion, model, quick ? 5 : 41, quick ? 1 : 5);
  }
  return out.faults() == 0 ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
