// SPDX-License-Identifier: BSD-3-Clause
// expected-error: these points are in a device's memory, which a host cannot read: ask a device{} about them, or copy them
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <thrust/device_vector.h>

clearance::real far(const std::vector<std::vector<clearance::inner_sphere>>& links,
                    const thrust::device_vector<float3>& points) {
  return clearance::ask(clearance::host{}, clearance::make_model<clearance::sphere>(links),
                        std::vector{Eigen::Isometry3d::Identity()}, points, clearance::min_distance{})
      .distance;
}
