// SPDX-License-Identifier: BSD-3-Clause
// On a device, a compacted cloud is the host's, and can be captured in a graph.
#include "support/catch.hpp"
#include "support/compacts.hpp"
#include "support/held_stream.cuh"

#include <clearance/compacted.cuh>

namespace compacted_test {

using namespace testing;
using clearance::device;

TEST_CASE("On a device, too, what is left of a cloud are its valid points, in their order") {
  check_compacted(device{});
}

TEST_CASE("A graph leaves out what is invalid when it runs") {
  const own_stream stream;
  const device gpu{.stream = stream.handle};
  dice d(5);
  std::vector<vec3> points = d.points(5000, 1);
  const auto there = gpu.copy_in(std::span<const vec3>(points));
  const clearance::device_buffer<vec3> left(5000, gpu.id);
  const clearance::device_buffer<std::uint32_t> numbers(5000, gpu.id), count(1, gpu.id);
  const auto enqueue = [&] {
    clearance::compacted_async(gpu, clearance::point_span(there.data(), 5000), left.data(), numbers.data(),
                               count.data());
  };
  enqueue();  // once, as loading a kernel is not for a graph
  const captured_graph graph(stream.handle, enqueue);
  for (std::uint32_t lost = 0; lost < 3; ++lost) {
    if (lost > 0) points[lost * 7].x = clearance::not_a_number;
    check(cudaMemcpy(there.data(), points.data(), points.size() * sizeof(vec3), cudaMemcpyHostToDevice));
    graph.launch();
    CHECK(gpu.copy_out(count.data(), 1)[0] == 5000 - lost);
    const auto found = gpu.copy_out(left.data(), 5000 - lost);
    CHECK(same_bytes(found.back(), points.back()));
    CHECK(gpu.copy_out(numbers.data(), 5000 - lost).back() == 4999);
  }
}

}  // namespace compacted_test
