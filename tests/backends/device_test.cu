// SPDX-License-Identifier: BSD-3-Clause
#include "support/laws.hpp"

#include <clearance/backends/device.cuh>

namespace device_test {

using namespace testing;
using clearance::device;

namespace {

struct count_visits {
  unsigned* times;
  __host__ __device__ void operator()(clearance::indices r) const {
    for (std::size_t i = r.begin; i < r.end; i += r.step) ++times[i];
  }
};
struct square {
  int* data;
  __host__ __device__ void operator()(std::size_t i) const { data[i] *= data[i]; }
};
/// The rough length of a vector of length about 2^(i / 64 - 20), over its own length.
struct roughness {
  float* ratio;
  __host__ __device__ void operator()(std::size_t i) const {
    const float x = (1 + static_cast<float>(i % 64) / 64) * std::exp2f(static_cast<float>(i / 64) - 20);
    const clearance::vec3 v{x, -0.7f * x, 0.3f * x};
    ratio[i] = clearance::rough_length(v) / clearance::length(v);
  }
};
struct deep_body {
  std::size_t need;
  __host__ __device__ void operator()(clearance::indices) const {}
  std::size_t device_stack() const { return need; }
};

int current_device() {
  int id = -1;
  cudaGetDevice(&id);
  return id;
}

}  // namespace

TEST_CASE("The device visits every index once, in the order of its stream") {
  static_assert(clearance::backend<device>);
  const device gpu;
  for (const std::size_t n : {0, 1, 31, 32, 33, 127, 128, 129, 100000, 3000000}) {
    auto times = gpu.copy_in(std::span<const unsigned>(std::vector<unsigned>(n, 0)));
    gpu.for_ranges(n, count_visits{times.data()});
    const auto seen = gpu.copy_out(times);
    REQUIRE(seen.size() == n);
    CHECK(std::all_of(seen.begin(), seen.end(), [](unsigned t) { return t == 1; }));
  }
  std::vector<int> numbers(1000);
  for (int k = 0; k < 1000; ++k) numbers[k] = k % 5;
  auto there = gpu.copy_in(std::span<const int>(numbers));
  gpu.for_each(1000, square{there.data()});
  gpu.for_each(1000, square{there.data()});
  gpu.wait();
  const auto back = gpu.copy_out(there);
  for (int k = 0; k < 1000; ++k) REQUIRE(back[k] == numbers[k] * numbers[k] * numbers[k] * numbers[k]);
}

TEST_CASE("A rough length is wrong by far less than the slack of the bounds that use it") {
  const device gpu;
  const std::size_t n = 64 * 50;
  const auto ratio = gpu.make_scratch<float>(n);
  gpu.for_each(n, roughness{ratio.data()});
  gpu.wait();
  for (const float r : gpu.copy_out(ratio.data(), n)) REQUIRE(std::abs(r - 1) <= clearance::slack / 8);
}

TEST_CASE("Staged bytes arrive whole, whatever happens to the source afterwards") {
  const device gpu;
  for (const std::size_t n : {0, 1, 3967, 3968, 3969, 10000}) {
    auto room = gpu.make_scratch<unsigned char>(n);
    std::vector<unsigned char> bytes(n);
    for (std::size_t k = 0; k < n; ++k) bytes[k] = static_cast<unsigned char>(k * 7);
    const auto expected = bytes;
    gpu.stage(std::span<const unsigned char>(bytes), room.data());
    std::fill(bytes.begin(), bytes.end(), static_cast<unsigned char>(0));
    CHECK(gpu.copy_out(room.data(), n) == expected);
  }
}

TEST_CASE("Pageable memory is not read in place; pinned and device memory are") {
  const device gpu;
  const std::vector<int> pageable(100);
  CHECK_FALSE(gpu.reads(pageable.data()));
  int* pinned = nullptr;
  REQUIRE(cudaMallocHost(&pinned, 400) == cudaSuccess);
  CHECK(gpu.reads(pinned));
  cudaFreeHost(pinned);
  const auto there = gpu.copy_in(std::span<const int>(pageable));
  CHECK(gpu.reads(there.data()));
  CHECK(cudaGetLastError() == cudaSuccess);
}

TEST_CASE("The caller's current device is left as it was, on success and on failure") {
  int devices = 0;
  cudaGetDeviceCount(&devices);
  for (int current = 0; current < devices; ++current)
    for (int used = 0; used < devices; ++used) {
      REQUIRE(cudaSetDevice(current) == cudaSuccess);
      {
        const device gpu{used};
        auto there = gpu.copy_in(std::span<const int>(std::vector<int>(1000, 3)));
        CHECK(current_device() == current);
        gpu.for_each(1000, square{there.data()});
        gpu.wait();
        CHECK(gpu.copy_out(there)[999] == 9);
        CHECK(current_device() == current);
        CHECK_THROWS_AS(gpu.for_ranges(1, deep_body{std::size_t(1) << 40}), std::invalid_argument);
      }
      CHECK(current_device() == current);
    }
  cudaSetDevice(0);
}

TEST_CASE("A device that does not exist is an error that says so, and leaves no error behind") {
  int devices = 0;
  cudaGetDeviceCount(&devices);
  const device none{devices + 3};
  CHECK_THROWS_AS(none.copy_in(std::span<const int>(std::vector<int>(3))), clearance::cuda_error);
  CHECK_THROWS_AS(none.wait(), clearance::cuda_error);
  CHECK(cudaGetLastError() == cudaSuccess);
  CHECK(current_device() == 0);
  try {
    none.wait();
  } catch (const clearance::cuda_error& e) {
    CHECK(std::string(e.what()).find("clearance: cudaSetDevice: ") == 0);
    CHECK(e.code == cudaErrorInvalidDevice);
  }
}

TEST_CASE("A recursion that needs more call stack than the device allows is refused with both numbers") {
  const device gpu;
  std::size_t limit = 0;
  REQUIRE(cudaDeviceGetLimit(&limit, cudaLimitStackSize) == cudaSuccess);
  gpu.for_ranges(1, deep_body{limit});
  gpu.wait();
  try {
    gpu.for_ranges(1, deep_body{limit + 1});
    FAIL("not refused");
  } catch (const std::invalid_argument& e) {
    CHECK(std::string(e.what()).find(std::to_string(limit + 1) + " bytes") != std::string::npos);
    CHECK(std::string(e.what()).find("limit is " + std::to_string(limit)) != std::string::npos);
  }
  std::size_t after = 0;
  cudaDeviceGetLimit(&after, cudaLimitStackSize);
  CHECK(after == limit);
}

TEST_CASE("A buffer that was moved from is empty, and one that is replaced is given back") {
  const device gpu;
  auto a = gpu.copy_in(std::span<const int>(std::vector<int>(10, 1)));
  auto b = std::move(a);
  CHECK(b.size() == 10);
  CHECK(a.data() == nullptr);
  a = gpu.copy_in(std::span<const int>(std::vector<int>(20, 2)));
  b = std::move(a);
  CHECK(gpu.copy_out(b)[19] == 2);
}

}  // namespace device_test
