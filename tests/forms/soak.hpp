// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Frames of random poses, sizes and clouds, some of which must be refused, to one prepared question of each kind.

#include "forms/forms.hpp"
#include "support/brute_force.hpp"

#include <malloc.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>

namespace testing {

/// Bytes of memory: what is allocated now, and what the process holds.
struct memory_now {
  double allocated = 0, resident = 0;

  static memory_now look() {
    memory_now m;
#if __GLIBC_PREREQ(2, 33)
    const auto heap = mallinfo2();
    m.allocated = double(heap.uordblks + heap.hblkhd);
#endif
    unsigned long long all = 0, resident = 0;
    if (std::FILE* const file = std::fopen("/proc/self/statm", "r")) {
      if (std::fscanf(file, "%llu %llu", &all, &resident) == 2) m.resident = 4096.0 * double(resident);
      std::fclose(file);
    }
    return m;
  }
};

/// A frame of a soak. Some poses are none: NaN, sheared, or one too few.
struct soak_frame {
  scene<inner_sphere> s;
  std::vector<std::vector<vec3>> points;
  bool refused = false;

  soak_frame(const scene<inner_sphere>& robot, dice& d) : s(robot) {
    for (auto& pose : s.poses) pose = d.pose(1);
    for (unsigned c = d.below(4); c > 0; --c) {
      const unsigned kind = d.below(8);
      points.push_back(d.points(kind == 0 ? 0 : kind == 1 ? d.below(4000) : d.below(400), 1.5));
      for (vec3& p : points.back())
        if (kind == 2 || d.below(50) == 0) p.y = clearance::not_a_number;
    }
    if (d.below(10) != 0) return;
    refused = true;
    const unsigned how = d.below(3);
    if (how == 0)
      s.poses.pop_back();
    else if (how == 1)
      s.poses[d.below(unsigned(s.poses.size()))].translation().x() = std::nan("");
    else
      s.poses[0].linear() *= 1.5;
  }
  clouds here() const {
    clouds all;
    for (const auto& p : points) all.push_back({clearance::point_span(p), shifted(0.1 * double(all.size()), 0, 0)});
    return all;
  }
};

struct soak_counts {
  std::uint64_t frames = 0, refused = 0, answers = 0, once = 0, by_brute_force = 0;
  memory_now begin, end;  ///< After a fifth of the time, and at last.
};

/// For so many seconds every question is asked in every frame. Each tenth frame is compared with one call on the host;
/// each hundredth with all pairs. `again(frame)` is called after each.
template <class On, class Again, class... Memory>
soak_counts soak(const On& on, double seconds, unsigned seed, verdict& v, const Again& again, Memory... memory) {
  moving_frames robot(4, seed);
  const auto here = robot.model();
  const auto there = here.on(on);
  const auto brute = brute_parts(robot.s);
  soak_counts count;
  std::vector<std::function<void(const soak_frame&)>> all;
  for_each_question([&]<class Q>(const char* name, const Q& q) {
    const auto prepared =
        std::make_shared<decltype(clearance::query(on, there, q, memory...))>(on, there, q, memory...);
    all.push_back([&, prepared, name = std::string(name), q](const soak_frame& f) {
      const std::string what = name + ", frame " + std::to_string(count.frames);
      typename Q::result answer{};
      bool refused = false;
      try {
        answer = (*prepared)(f.s.poses, f.here());
      } catch (const std::invalid_argument&) {
        refused = true;
      }
      v.require(refused == f.refused, what, f.refused ? ": is not refused" : ": is refused");
      ++count.answers;
      if (f.refused) return;
      if (count.frames % 10 == 0) {
        v.require(same_answer(answer, typename Q::result(ask(clearance::host{1}, here, f.s.poses, f.here(), q))), what,
                  ": differs from one call");
        ++count.once;
      }
      if constexpr (std::is_same_v<Q, clearance::min_distance_per_part>) {
        if (count.frames % 100 != 0) return;
        std::vector<brute_cloud> clouds;
        for (const auto& c : f.here()) clouds.emplace_back(c.source, c.pose);
        const brute_answer expected = brute_force(brute, f.s.poses, clouds);
        require_equal(answer.all, expected, v, what);
        require_equal(answer.parts, expected, v, what);
        ++count.by_brute_force;
      }
    });
  });
  const auto start = std::chrono::steady_clock::now();
  const auto passed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / seconds;
  };
  dice d(seed + 1);
  bool warm = false;
  for (; count.frames < 200 || passed() < 1; ++count.frames) {
    {
      const soak_frame f(robot.s, d);
      count.refused += f.refused;
      for (const auto& each : all) each(f);
      again(f);
    }
    if (!warm && count.frames >= 100 && passed() > 0.2) warm = true, count.begin = memory_now::look();
  }
  if (!warm) count.begin = memory_now::look();
  count.end = memory_now::look();
  return count;
}

/// A sanitizer keeps what is freed, and an emulator (scripts/aarch64) what it has translated.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__x86_64__)
inline constexpr bool keeps_freed_memory = true;
#elif defined(__has_feature)
inline constexpr bool keeps_freed_memory = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool keeps_freed_memory = false;
#endif

/// From the environment, or a few.
inline double soak_seconds() {
  const char* const said = std::getenv("CLEARANCE_SOAK_SECONDS");
  return said == nullptr ? 7 : std::atof(said);
}

inline void print(const soak_counts& n, double seconds) {
  std::printf(
      "%.0f s: %llu frames (%llu refused), %llu answers, %llu compared with one call, %llu frames with all pairs\n",
      seconds, static_cast<unsigned long long>(n.frames), static_cast<unsigned long long>(n.refused),
      static_cast<unsigned long long>(n.answers), static_cast<unsigned long long>(n.once),
      static_cast<unsigned long long>(n.by_brute_force));
  std::printf("memory after a fifth of the time and at last: allocated %.2f and %.2f MB, resident %.1f and %.1f MB\n",
              n.begin.allocated / 1e6, n.end.allocated / 1e6, n.begin.resident / 1e6, n.end.resident / 1e6);
}

}  // namespace testing
