// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace bench::paper {

/// A check that everything is right (CLEARANCE_QUICK=1): small clouds and few runs, each compared with a plain loop
/// over all points and primitives.
inline const bool quick = std::getenv("CLEARANCE_QUICK") != nullptr;
inline constexpr std::size_t quick_points = 5'003;

/// The CSV, one value per line: axis, scene, points, x (if the axis has one), variant, metric, value.
class report {
 public:
  report(const char* path, const std::string& stamp) : file_(path == nullptr ? stdout : std::fopen(path, "w")) {
    if (file_ == nullptr) throw std::runtime_error(std::string("cannot write ") + path);
    std::fprintf(file_, "# %s\naxis,scene,points,x,variant,metric,value\n", stamp.c_str());
  }
  report(const report&) = delete;
  report& operator=(const report&) = delete;
  ~report() {
    if (file_ != stdout) std::fclose(file_);
  }

  void begin(std::string axis, std::string scene, std::size_t points, double x = 0) {
    axis_ = std::move(axis), scene_ = std::move(scene), points_ = points, x_ = x;
  }
  void row(const std::string& variant, const char* metric, double value) {
    std::fprintf(file_, "%s,%s,%zu,%.6g,\"%s\",%s,%.7g\n", axis_.c_str(), scene_.c_str(), points_, x_, variant.c_str(),
                 metric, value);
    std::fflush(file_);
  }
  /// Median, 10th and 90th percentile.
  void times(const std::string& variant, std::vector<double> microseconds) {
    std::sort(microseconds.begin(), microseconds.end());
    const auto at = [&](double part) {
      return microseconds[std::size_t(part * double(microseconds.size() - 1) + 0.5)];
    };
    row(variant, "us", at(0.5));
    row(variant, "us_p10", at(0.1));
    row(variant, "us_p90", at(0.9));
  }

  /// Every variant must give the minimum of min_distance, to the bit unless there is a tolerance.
  void expect(const std::string& variant, double distance, double reference, double tolerance = 0) {
    if (std::abs(distance - reference) <= tolerance) return;
    std::fprintf(stderr, "WRONG: %s, %s, %zu points, %s: %.9g instead of %.9g\n", axis_.c_str(), scene_.c_str(),
                 points_, variant.c_str(), distance, reference);
    ++faults_;
  }
  int faults() const { return faults_; }

 private:
  std::FILE* file_;
  std::string axis_, scene_;
  std::size_t points_ = 0;
  double x_ = 0;
  int faults_ = 0;
};

/// Runs `once` (which returns microseconds) for about `budget` seconds, at least `least` and at most 300 times. Before
/// that, a third as long uncounted, so that clocks and caches settle.
template <class F>
std::vector<double> repeat(F once, double budget, int least = 3) {
  for (double spent = 0; spent < budget / 3 * 1e6;) spent += once();
  std::vector<double> all;
  double spent = 0;
  while (int(all.size()) < least || (spent < budget * 1e6 && all.size() < 300)) spent += all.emplace_back(once());
  return all;
}

/// Microseconds on the host's clock.
template <class F>
double host_time(F work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace bench::paper
