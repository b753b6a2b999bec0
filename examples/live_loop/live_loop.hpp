// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A control loop of 1 kHz beside a sensor of 30 Hz: each tick asks about the newest whole cloud, and none waits for the
// next.

#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <thread>

// [buffers]
/// Two clouds: the sensor writes one while the loop reads the other.
class double_buffer {
 public:
  /// The sensor's callback.
  void deliver(const std::vector<clearance::vec3>& cloud) {
    const std::lock_guard lock(mutex_);
    back_ = cloud;
    fresh_ = true;
  }

  /// Swaps if there is a new cloud; if one is just being written, the next tick will have it. Never waits.
  bool take() {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || !fresh_) return false;
    std::swap(front_, back_);
    fresh_ = false;
    return true;
  }

  /// The loop's cloud: as it is until the loop itself takes another.
  const std::vector<clearance::vec3>& front() const { return front_; }

 private:
  std::mutex mutex_;
  std::vector<clearance::vec3> back_, front_;
  bool fresh_ = false;
};
// [buffers]

/// A wall before the robot that comes and goes.
inline std::vector<clearance::vec3> wall_at(double seconds) {
  const float x = 0.55f + 0.2f * float(std::cos(20 * seconds));
  std::vector<clearance::vec3> wall;
  for (int k = 0; k < 10000; ++k) wall.push_back({x, 0.01f * (k % 100) - 0.5f, 0.01f * (k / 100) - 0.5f});
  return wall;
}

template <clearance::backend Backend>
int example(const Backend& on) {
  using namespace std::chrono;
  std::vector<clearance::inner_sphere> row;
  for (int k = 0; k < 64; ++k) row.push_back({{0.004f * k, 0, 0}, 0.03f});
  const auto link = clearance::make_part(clearance::build<clearance::sphere>(row));
  const clearance::model same{std::vector{link, link}};
  const auto start = steady_clock::now();
  int taken = 0, stops = 0, wrong = 0, tick = 0;

  // [loop]
  double_buffer clouds;
  std::jthread sensor([&](std::stop_token done) {  // stands for a driver that calls back
    for (int frame = 0; !done.stop_requested(); ++frame) {
      clouds.deliver(wall_at(frame / 30.0));
      std::this_thread::sleep_until(start + frame * microseconds(33333));
    }
  });
  const auto arm = clearance::model(std::vector{link, link}).on(on);
  clearance::query ask(on, arm, clearance::min_distance{});
  for (; tick < 300 || taken < 3; ++tick) {
    std::this_thread::sleep_until(start + tick * milliseconds(1));
    taken += clouds.take();
    if (taken == 0) continue;                                                      // nothing is known yet
    Eigen::Isometry3d shoulder = Eigen::Isometry3d::Identity(), elbow = shoulder;  // from the robot's encoders
    elbow.translate(Eigen::Vector3d(0.25, 0, 0)).rotate(Eigen::AngleAxisd(0.002 * tick, Eigen::Vector3d::UnitZ()));
    const std::vector poses{shoulder, elbow};
    const clearance::min_distance_result r = ask(poses, clouds.front());
    stops += !(r.lower > 0.05);  // also if there was no valid point
    // [loop]
    const auto plain = clearance::ask(clearance::host{}, same, poses, clouds.front(), clearance::min_distance{});
    wrong += r.distance != plain.distance || r.point != plain.point || r.part != plain.part ||
             r.primitive != plain.primitive;
  }
  std::printf("%d ticks, %d clouds; %d ticks were too close, %d wrong\n", tick, taken, stops, wrong);
  return wrong == 0 ? 0 : 1;
}
