// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a host or a device reads a cloud in chunks, no other backend
// and no other error
#include <clearance/chunked_query.hpp>
#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

void ask(const std::vector<std::vector<clearance::inner_sphere>>& links) {
  const clearance::devices on{0, 1};
  const auto robot = clearance::make_model<clearance::sphere>(links).on(on);
  clearance::chunked_query prepared(on, robot, clearance::zones{{0.1}});
}
