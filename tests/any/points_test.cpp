// SPDX-License-Identifier: BSD-3-Clause
// A view of any source gives what the source gives, and its answers have the same bits.
#include "support/laws.hpp"
#include "support/same_answer.hpp"

#include <clearance/make_model.hpp>
#include <clearance/points/any_points.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/sensor_noise.hpp>
#include <clearance/points/slice.hpp>
#include <clearance/points/strided_points.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

namespace any_of_points_test {

using namespace testing;
using namespace clearance;

namespace {

const auto& robot() {
  static const model made{std::vector{make_part<sphere>(std::vector{inner_sphere{{0, 0, 0}, 0.5f}}),
                                      make_part<sphere>(std::vector{inner_sphere{{0, 0.4f, 0.1f}, 0.2f}})}};
  return made;
}

bool same(const sample& a, const sample& b) {
  return a.dropped == b.dropped && std::memcmp(&a.position, &b.position, sizeof a.position) == 0;
}
bool same(const point_tile& a, const point_tile& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

template <class S>
void check_views(const S& source) {
  const any_points any = source;
  const any_points copied = any;
  REQUIRE(copied.size() == source.size());
  REQUIRE(source.size() > 3 * surveyed_points);
  for (std::size_t i = 0; i < source.size(); ++i) {
    const sample its = source[i];
    REQUIRE(same(copied[i], its));
    const real a = beyond_range(copied, i, its.position), b = beyond_range(source, i, its.position);
    REQUIRE((a == b || (a != a && b != b)));
  }
  CHECK(rounding_of(copied).absolute == rounding_of(source).absolute);
  CHECK(rounding_of(copied).relative == rounding_of(source).relative);
  CHECK(sensor_of(copied) == sensor_of(source));
  const any_points piece = slice(slice(copied, 8, source.size()), 4, 300);
  REQUIRE(piece.size() == 296);
  for (std::size_t i = 0; i < piece.size(); ++i) REQUIRE(same(piece[i], source[12 + i]));
  for (const std::size_t begin : {std::size_t(0), surveyed_points, surveyed_points + 4}) {
    extent box, its_box;
    std::uint32_t dropped[drop_reasons] = {}, its_dropped[drop_reasons] = {};
    const bool told = copied.survey(begin, box, dropped);
    if constexpr (surveyed_source<S>) {
      CHECK(told == source.survey(begin, its_box, its_dropped));
      CHECK((!told || (box.lower == its_box.lower && box.upper == its_box.upper)));
    } else {
      CHECK_FALSE(told);
    }
    for (const auto& [count, stride] : {std::pair(surveyed_points, 1), std::pair(surveyed_points / 3, 2)}) {
      point_tile tile, its;
      copied.read(begin, count, std::size_t(stride), tile, dropped);
      its.read(source, begin, count, std::size_t(stride), its_dropped);
      CHECK(same(tile, its));
    }
    CHECK(std::ranges::equal(dropped, its_dropped));
  }
}

/// Both as they are and uncertain.
template <class S>
void check_answers(const S& source) {
  const std::vector poses(robot().size(), Eigen::Isometry3d::Identity());
  const auto asked = [&]<class Q>(const Q& question, const auto& typed, const auto& any) {
    const auto one = ask(host{}, robot(), poses, typed, question), other = ask(host{}, robot(), poses, any, question);
    CHECK(same_answer(one, other));
  };
  const auto both = [&](const auto& typed, const auto& any) { asked(min_distance_per_part{}, typed, any); };
  both(source, any_points(source));
  any_noise noise;
  noise.kind = noise_kind::tof, noise.tof = {0.001f, 0.002f};
  const cloud_uncertainty off{.shift = 0.01, .turn = 0.002};
  const uncertain typed(source, noise, off);
  const uncertain any(any_points(source), noise, off);
  CHECK(any.spread == typed.spread);
  both(typed, any);
}

}  // namespace

TEST_CASE("A view of any source gives what the source gives, and answers keep their bits") {
  dice d(7);
  auto points = d.points(5 * surveyed_points + 31, 3);
  for (std::size_t k = 3; k < points.size(); k += 11) points[k].y = not_a_number;
  const auto check = [](const auto& source) { check_views(source), check_answers(source); };
  check(point_span(points));
  check(point_span(points, point_filter{.nearest = 1, .farthest = 2.5f, .sensor = {0.1f, 0, 0}}));
  std::vector<double> doubles;
  for (const vec3 p : points) doubles.insert(doubles.end(), {p.x + 1000.0, double(p.y), double(p.z)});
  strided_points<double> records;
  records.data = reinterpret_cast<const std::byte*>(doubles.data()), records.count = points.size(), records.step = 24;
  records.offset[1] = 8, records.offset[2] = 16, records.origin = {1000, 0, 0};
  check(records);
  constexpr std::uint32_t width = 100, height = 9;
  std::vector<std::uint16_t> pixels(width * height);
  std::vector<float> metres(pixels.size());
  std::vector<ray> rays(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = std::uint16_t(i % 7 == 0 ? 0 : 600 + i), metres[i] = i % 9 == 0 ? -infinity : 0.001f * pixels[i];
    rays[i] = {real(i % width) / width - 0.5f, real(i / width) / height - 0.5f};
  }
  depth_image<std::uint16_t> image(pixels.data(), width, height, {80, 80, 50, 4});
  check(image);
  image.nearest = 0.8f, image.farthest = 1.2f;
  check(image);
  check(depth_image<float>(metres.data(), width, height, {80, 80, 50, 4}));
  check(ray_image<std::uint16_t>(pixels.data(), rays.data(), width, height));
  std::vector<point_label> labels(points.size());
  for (std::size_t i = 0; i < labels.size(); i += 5) labels[i] = point_label::own;
  check_views(masked<point_span>(points, labels.data()));
  check_views(slice(point_span(points), 2, points.size()));
  // A source that contradicts itself is refused through the view, too.
  image.scale = -1;
  CHECK_THROWS_AS(rounding_of(any_points(image)), std::invalid_argument);
}

}  // namespace any_of_points_test
