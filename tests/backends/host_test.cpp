// SPDX-License-Identifier: BSD-3-Clause
#include "support/laws.hpp"

#include <clearance/backends/host.hpp>
#include <clearance/ground/ordered.hpp>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>

namespace host_test {

using namespace testing;
using clearance::host;

TEST_CASE("The host visits every index once, however many threads and indices") {
  static_assert(clearance::backend<host>);
  for (const unsigned threads : {0u, 1u, 2u, 5u})
    for (const std::size_t n : {0, 1, 31, 1023, 1024, 1025, 50000}) {
      std::vector<std::atomic<int>> times(n);
      host{threads}.for_each(n, [&](std::size_t i) { ++times[i]; });
      host{threads}.for_ranges(n, [&](clearance::indices r) {
        for (std::size_t i = r.begin; i < r.end; i += r.step) ++times[i];
      });
      CHECK(std::all_of(times.begin(), times.end(), [](const auto& t) { return t == 2; }));
    }
}

TEST_CASE("The host keeps to the threads it was given") {
  std::mutex guard;
  std::set<std::thread::id> seen;
  host{1}.for_each(20000, [&](std::size_t) {
    const std::lock_guard lock(guard);
    seen.insert(std::this_thread::get_id());
  });
  CHECK(seen.size() == 1);
  CHECK(*seen.begin() == std::this_thread::get_id());
}

TEST_CASE("An exception of a body reaches the caller") {
  CHECK_THROWS_AS(host{}.for_each(50000,
                                  [](std::size_t i) {
                                    if (i == 40000) throw std::out_of_range("body");
                                  }),
                  std::out_of_range);
}

TEST_CASE("Keys order as (distance, index) does, negative distances and zeros included") {
  dice d(1);
  std::vector<real> all = {0.0f, -0.0f, 1e-45f, -1e-45f, infinity, -infinity, 1e18f, -1e18f};
  for (int k = 0; k < 300; ++k) all.push_back(d.number(-2, 2));
  verdict v;
  for (const real a : all)
    for (const real b : all)
      for (const std::uint32_t i : {0u, 7u, 0xfffffffeu})
        for (const std::uint32_t j : {0u, 8u, 0xffffffffu}) {
          const bool less = a < b || (a == b && i < j);
          v.require((clearance::make_key(a, i) < clearance::make_key(b, j)) == less, "keys of", a, " and", b);
          v.require(clearance::key_distance(clearance::make_key(a, i)) == a, "distance", a);
          v.require(clearance::key_index(clearance::make_key(a, i)) == i, "index", i);
          if (a < infinity) v.require(clearance::make_key(a, i) < clearance::no_key, "no key is less than a key");
        }
  CHECK(clearance::key_distance(clearance::no_key) == infinity);
}

TEST_CASE("Many threads lower one word to the least, and count without losing any") {
  clearance::distance_key word = clearance::no_key;
  unsigned long long count = 0;
  host{}.for_each(100000, [&](std::size_t i) {
    const auto scattered = std::uint32_t(i * 2654435761u);
    clearance::lower_to(&word, clearance::make_key(real(scattered % 1000) - 500, scattered));
    clearance::add_to(&count, i % 3);
  });
  clearance::distance_key expected = clearance::no_key;
  unsigned long long sum = 0;
  for (std::size_t i = 0; i < 100000; ++i) {
    const auto scattered = std::uint32_t(i * 2654435761u);
    expected = std::min(expected, clearance::make_key(real(scattered % 1000) - 500, scattered));
    sum += i % 3;
  }
  CHECK(word == expected);
  CHECK(count == sum);
}

}  // namespace host_test
