// SPDX-License-Identifier: BSD-3-Clause
// How a host reads each kind of cloud that Python may pass: all as any_points, also behind masks. It is compiled here
// for all questions.
#include "asker.hpp"

using namespace clearance;

namespace {

template <class S>
auto behind(const point_label* labels, const S& source) {
  return any_points(masked<S>(source, labels));
}
template <class S, class N>
auto behind(const point_label* labels, const uncertain<S, N>& source) {
  return source.around_same(behind(labels, source.source), source.noise);
}

}  // namespace

template <class Cloud>
read_clouds<Cloud> read_behind(std::span<const point_label* const> labels, const std::vector<Cloud>& clouds) {
  read_clouds<Cloud> all = any::detail::read_as_one(clouds);
  for (std::size_t k = 0; k < clouds.size(); ++k)
    if (labels[k])
      std::visit([&](const auto& cloud) { all[k] = placed{behind(labels[k], cloud.source), cloud.pose}; }, clouds[k]);
  return all;
}

template read_clouds<any_cloud> any::detail::read_as_one(const std::vector<any_cloud>&);
template read_clouds<uncertain_cloud_too> any::detail::read_as_one(const std::vector<uncertain_cloud_too>&);
template read_clouds<any_cloud> read_behind(std::span<const point_label* const>, const std::vector<any_cloud>&);
template read_clouds<uncertain_cloud_too> read_behind(std::span<const point_label* const>,
                                                      const std::vector<uncertain_cloud_too>&);
