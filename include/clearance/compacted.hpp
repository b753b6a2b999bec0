// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The valid points of a cloud, and nothing else. Runs on the host; include compacted.cuh for a device.

#include <clearance/backends/readback.hpp>
#include <clearance/frames/readable.hpp>
#include <clearance/query/combination.hpp>

#include <stdexcept>
#include <string>

namespace clearance {

/// A cloud's valid points in their order, in its frame, and their numbers in the cloud.
struct compacted_points {
  arriving<vec3> points;
  arriving<std::uint32_t> numbers;
};

namespace detail {

template <point_source S>
struct compact_body {
  static_assert(points_alone<S>());

  S source;
  vec3* points;
  std::uint32_t *numbers, *count;

  CLEARANCE_HD void operator()(std::size_t) const {
    std::uint32_t n = 0;
    const std::size_t size = source.size();
    for (std::size_t i = 0; i < size; ++i)
      if (const sample s = source[i]; s.valid()) {
        points[n] = s.position;
        numbers[n++] = std::uint32_t(i);
      }
    *count = n;
  }
};

/// On a backend without a scan of its own. One thread is as fast as memory.
template <class On>
struct compacts_on {
  static_assert(!requires { typename On::own_scan; }, "a device does it otherwise: include <clearance/compacted.cuh>");

  template <point_source S>
  static void enqueue(const On& on, const S& source, vec3* points, std::uint32_t* numbers, std::uint32_t* count) {
    on.for_each(1, compact_body<S>{source, points, numbers, count});
  }
};

}  // namespace detail

/// Enqueues it. `on` must be able to write the output, which needs room for all points of the source, and to read the
/// source. Throws std::invalid_argument if there are 2^31 points or more.
template <class On, point_source S>
void compacted_async(const On& on, const S& source, vec3* points, std::uint32_t* numbers, std::uint32_t* count) {
  if (source.size() >= std::size_t(1) << 31)
    throw std::invalid_argument("clearance: " + std::to_string(source.size()) +
                                " points are too many for one call; it takes 2^31 - 1");
  if constexpr (std::derived_from<On, host> && detail::some_on_device<S>) refusals::device_memory::explain<S>();
  rounding_of(source);  // refuses what cannot be read
  detail::compacts_on<On>::enqueue(on, source, points, numbers, count);
}

/// Use it for points that leave the library, such as `masked(cloud, labels)` without the robot. For a question here ask
/// about the cloud itself, or about masked_clouds: a source knows how far off its points can be, and which were too
/// close to be measured; positions do not.
template <class On, point_source S>
compacted_points compacted(const On& on, const S& source) {
  auto points = on.template make_scratch<vec3>(source.size());
  auto numbers = on.template make_scratch<std::uint32_t>(source.size());
  auto count = on.template make_scratch<std::uint32_t>(1);
  frames::cloud_copies<On> copies;
  compacted_async(on, frames::readable_on<On>{on, copies}(source, 0), points.data(), numbers.data(), count.data());
  const std::size_t n = on.copy_out(count.data(), 1)[0];
  backends::readback<On> back(on);
  compacted_points all{.points = arriving<vec3>(back.memory()), .numbers = arriving<std::uint32_t>(back.memory())};
  back(backends::read_array{all.points, points.data(), n}, backends::read_array{all.numbers, numbers.data(), n});
  return all;
}

}  // namespace clearance
