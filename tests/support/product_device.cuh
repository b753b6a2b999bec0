// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The product on a GPU. All widths and fits occur; of primitive, volume, traversal and point source, each pair occurs
// (kernels compile slowly, and the host has the whole product).

#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/device.cuh>
#include <clearance/questions/min_distance.hpp>

namespace testing {

/// Raises the recursion limit while it lives.
class deep_stack {
 public:
  explicit deep_stack(std::size_t bytes) {
    clearance::check_cuda(cudaDeviceGetLimit(&before_, cudaLimitStackSize), "cudaDeviceGetLimit");
    clearance::check_cuda(cudaDeviceSetLimit(cudaLimitStackSize, bytes), "cudaDeviceSetLimit");
  }
  ~deep_stack() { cudaDeviceSetLimit(cudaLimitStackSize, before_); }
  deep_stack(const deep_stack&) = delete;

 private:
  std::size_t before_ = 0;
};

/// One primitive, volume, traversal and kind of source on the device: brute force's answer, and all bits of the host's.
template <class P, class V, class Walk, class Pick>
void check_on_device(Pick pick) {
  const clearance::device gpu;
  const deep_stack room(16384);
  verdict v;
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto [source, pose] = pick(all, s);
    const clearance::placed cloud{source, pose};
    const auto expected = brute_force(brute_parts(s), s.poses, {brute_cloud(source, pose)});
    for (const std::uint32_t width : {2, 4, 8})
      for (const bool layered : {false, true}) {
        const clearance::build_options options{.width = width, .leaf_size = width == 4 ? 1u : 4u};
        const auto on_host =
            layered ? make_model<V>(s, options, clearance::layered{}) : make_model<V>(s, options, clearance::wrapped{});
        const auto model = on_host.on(gpu);
        const std::string what = s.name + ", width " + std::to_string(width);
        const auto same = clearance::ask(clearance::host{}, on_host, s.poses, cloud, clearance::min_distance{});
        const auto check = [&](const auto& on, const std::string& how) {
          const auto r = clearance::ask(on, model, s.poses, cloud, clearance::min_distance{});
          require_equal(r, expected, v, what + how);
          v.require(same_result(r, same), what + how, ": something differs from the host's result");
          const auto [each, minima] = clearance::ask(on, model, s.poses, cloud, clearance::min_distance_per_part{});
          require_equal(each, expected, v, what + how + ", per part");
          require_equal(minima, expected, v, what + how);
        };
        check(clearance::plain{gpu, Walk{}}, ", plain");
        check(gpu, ", kernel");
      }
  }
}

struct pick_span {
  template <class A, class S>
  auto operator()(const A& all, const S& s) const {
    return std::pair(all.span, s.cloud_pose);
  }
};
struct pick_floats {
  template <class A, class S>
  auto operator()(const A& all, const S& s) const {
    return std::pair(all.floats, s.cloud_pose);
  }
};
struct pick_doubles {
  template <class A, class S>
  auto operator()(const A& all, const S& s) const {
    return std::pair(all.doubles, s.cloud_pose);
  }
};
struct pick_raw {
  template <class A, class S>
  auto operator()(const A& all, const S&) const {
    return std::pair(all.raw, all.camera_pose);
  }
};
struct pick_metres {
  template <class A, class S>
  auto operator()(const A& all, const S&) const {
    return std::pair(all.metres, all.camera_pose);
  }
};

}  // namespace testing
