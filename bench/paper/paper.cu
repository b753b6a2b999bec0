// SPDX-License-Identifier: BSD-3-Clause
// The design space of Kaluschke et al. (2014) on today's GPU, compared with this library: every axis, on both of the
// paper's scenarios, as CSV. All variants must find the minimum of min_distance, otherwise the exit code is 1.
//
//   bench_paper_device [FILE.csv [STAMP]]     bench/compare-with-paper runs it, and draws the results
//   CLEARANCE_QUICK=1 makes it a test: small clouds, exact against brute force
#include "axes.cuh"
#include "competitors.cuh"
#include "ours.cuh"

#include <tuple>

namespace paper_bench {
namespace {

using namespace bench::paper;

std::string stamp(const char* given) {
  cudaDeviceProp facts{};
  check_cuda(cudaGetDeviceProperties(&facts, 0), "cudaGetDeviceProperties");
  int driver = 0;
  check_cuda(cudaDriverGetVersion(&driver), "cudaDriverGetVersion");
  return std::string(facts.name) + "; CUDA " + std::to_string(driver / 1000) + "." +
         std::to_string(driver % 1000 / 10) + (given == nullptr ? "" : std::string("; ") + given);
}

/// The whole design space for one scenario.
void explore(lab& l, const bench::scene& robot, const scenario& s) {
  using model = decltype(bench::sphere_model<clearance::sphere>(robot));
  std::vector<model> on_host;
  std::vector<decltype(on_host[0].on(l.gpu))> models;
  for (const auto& shape : shapes) {
    on_host.push_back(bench::sphere_model<clearance::sphere>(robot, shape));
    models.push_back(on_host.back().on(l.gpu));
  }

  // The headline's sizes first, because they determine the paper's best width.
  const std::vector<std::size_t> one = {quick_points}, most = {5'000'000, 307'200};
  std::size_t best = 0;
  for (const std::size_t n : quick ? one : most) {
    l.set(s, n);
    best = headline(l, models, l.reference(on_host.back()));
  }
  const auto& paper_model = models[best];

  for (const std::size_t n : quick ? one : s.sizes) {
    l.set(s, n);
    const double reference = l.reference(on_host.back());
    const auto parts = l.parts(paper_model);
    std::fprintf(stderr, "%s, %zu points, %.4f m\n", s.name.c_str(), n, reference);
    l.out.begin("scene", s.name, n);
    l.out.row("distance", "m", reference);
    traversals(l, parts, reference);
    schedules(l, parts, reference);
    transforms(l, paper_model, parts, reference);
    sharing(l, parts, reference);
    caches(l, parts, reference);
    seeds(l, parts, reference);
    if (n == s.sizes.front() || n == s.sizes.back() || quick) culling(l, on_host[best], parts, reference);
    if (n == 307'200 || quick) {
      block_sizes(l, parts, reference);
      layouts(l, on_host.back());
      volumes(l, robot);
      fits(l, robot);
      splits(l, robot);
    }
    device_competitors(l, on_host.back(), models.back(), paper_model, reference);
    host_competitors(l.out, s, n, on_host.back(), on_host[best]);
  }
  l.set(s, quick ? one[0] : s.along_motion);
  along_motion(l, on_host.back(), models.back(), paper_model, quick ? 5 : 41, quick ? 2 : 15);
}

int run(int count, char** arguments) try {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
    std::fprintf(stderr, "SKIPPED: no CUDA device\n");
    return 77;
  }
  if (quick) budget = 0, host_budget = 0;
  report out(count > 1 ? arguments[1] : nullptr, stamp(count > 2 ? arguments[2] : nullptr));
  lab l(out);
  const bench::scene& robot = bench::the_scene();
  for (const scenario& s : scenarios(robot)) explore(l, robot, s);
  return out.faults() == 0 ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}

}  // namespace
}  // namespace paper_bench

int main(int count, char** arguments) { return paper_bench::run(count, arguments); }
