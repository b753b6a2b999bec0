// SPDX-License-Identifier: BSD-3-Clause
// A solid of one's own, packed without any mesh: a dome by its formula.
#include <clearance/backends/host.hpp>
#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cmath>
#include <cstdio>

// [solid]
/// The upper half of a ball of radius 10 cm. Where two faces meet, the larger of the two distances is never too large.
struct dome {
  double signed_distance(const Eigen::Vector3d& p) const { return std::max(p.norm() - 0.1, -p.z()); }

  Eigen::AlignedBox3d bounds() const { return {Eigen::Vector3d(-0.1, -0.1, 0), Eigen::Vector3d(0.1, 0.1, 0.1)}; }
  double distance(const Eigen::Vector3d& p) const { return std::abs(signed_distance(p)); }
  bool inside(const Eigen::Vector3d& p) const { return signed_distance(p) < 0; }
};

static_assert(clearance::solid<dome>);
// [solid]

int main() {
  // [use]
  const clearance::packing packed = clearance::pack(dome{}, {.count = 60, .gap_tolerance = 0.1});
  const auto part = clearance::make_part<clearance::sphere>(packed);
  // [use]

  std::printf("%zu spheres, certified gap %.2f mm\n", packed.spheres.size(), 1000 * packed.gap);
  for (int k = 0; k < 200; ++k) {
    const clearance::vec3 p{0.001f * k - 0.1f, 0.0005f * k, 0.05f + 0.0005f * k};
    const auto r = clearance::ask(clearance::host{}, part, Eigen::Isometry3d::Identity(), std::vector{p},
                                  clearance::min_distance{});
    const double exact = std::max(0.0, std::hypot(p.x, p.y, p.z) - 0.1);  // above the flat face
    if (!(r.lower <= exact && exact <= r.upper)) return 1;
  }
  return packed.gap < 0.04 ? 0 : 1;
}
