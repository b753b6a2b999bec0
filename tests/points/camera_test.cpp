// SPDX-License-Identifier: BSD-3-Clause
#include "support/laws.hpp"

#include <clearance/points/camera.hpp>

#include <limits>
#include <stdexcept>

namespace camera_test {

using namespace testing;
using clearance::at_one, clearance::camera, clearance::camera_info;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct lens {
  const char* model;
  std::vector<double> d;
  at_one opencv[5];  ///< What it undistorts `places` to.
};
/// By OpenCV 5.0.0: cv2.undistortPoints and cv2.fisheye.undistortPoints of these pixels with the K of `seen_by`, after
/// up to 500 iterations or to 1e-14.
constexpr at_one places[] = {{0, 0}, {639, 0}, {17, 400}, {333, 50}, {600, 470}};
const lens lenses[] = {
    {"plumb_bob",
     {-0.28, 0.07, 0.0005, -0.0008, 0},
     {{-1.32543211992, -1.03999886721},
      {1.3470731163, -1.03728145178},
      {-1.32865156002, 0.701967431981},
      {0.059188401509, -0.732383851117},
      {1.23725482713, 1.00146422373}}},
    {"plumb_bob",
     {0.13, -0.02, 0.001, 0.002},
     {{-0.906338654009, -0.707664672901},
      {0.909026083016, -0.703213675419},
      {-0.877433040175, 0.461904178717},
      {0.0480732172929, -0.60889914535},
      {0.810640407563, 0.659343866288}}},
    {"rational_polynomial",
     {0.55, 0.06, -1e-4, 2e-4, 0.002, 0.88, 0.12, 0.01},
     {{-1.8490778197, -1.44254785242},
      {1.8802599498, -1.44900915612},
      {-1.45980987884, 0.771502226465},
      {0.0584284271095, -0.73027382427},
      {1.45709557874, 1.18553348814}}},
    {"rational_polynomial",
     {0.5, 0.06, 0, 0, 0.002, 0.8, 0.12, 0.01, 1e-3, 2e-4, -1e-3, 1e-4},
     {{-1.91027096878, -1.47031739141},
      {1.87420408093, -1.45615415529},
      {-1.458665739, 0.770560457916},
      {0.0572865908121, -0.722214079553},
      {1.4465244973, 1.18681411832}}},
    {"equidistant",
     {0.02, -0.006, 0.001, -0.0002},
     {{-2.57405141985, -2.01167442378},
      {2.69672148776, -2.07741714096},
      {-1.64529187359, 0.869554931192},
      {0.0586683365225, -0.731789798719},
      {1.75759324176, 1.42824063705}}},
};

camera_info seen_by(const char* model, std::span<const double> d) {
  return {.width = 640, .height = 480, .distortion_model = model, .d = d, .k = {310, 0, 317.2, 0, 305, 243.9, 0, 0, 1}};
}

/// Where a lens shows a ray, written from OpenCV's documentation, with powers and in long double.
std::array<wide, 2> shown(const std::string& model, std::vector<double> d, wide x, wide y) {
  const wide r2 = x * x + y * y, r = std::sqrt(r2);
  if (model == "equidistant") {
    const wide t = std::atan(r);
    const wide far =
        t * (1 + d[0] * std::pow(t, 2) + d[1] * std::pow(t, 4) + d[2] * std::pow(t, 6) + d[3] * std::pow(t, 8));
    return r == 0 ? std::array<wide, 2>{0, 0} : std::array<wide, 2>{far / r * x, far / r * y};
  }
  d.resize(12);
  const wide radial = (1 + d[0] * r2 + d[1] * std::pow(r, 4) + d[4] * std::pow(r, 6)) /
                      (1 + d[5] * r2 + d[6] * std::pow(r, 4) + d[7] * std::pow(r, 6));
  return {x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x) + d[8] * r2 + d[9] * r2 * r2,
          y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y + d[10] * r2 + d[11] * r2 * r2};
}

template <class F>
std::string refusal(F f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "not refused";
}

}  // namespace

TEST_CASE("Rays are those that OpenCV undistorts pixels to") {
  verdict v;
  for (const lens& l : lenses) {
    const camera seen(seen_by(l.model, l.d));
    CHECK(!seen.pinhole());
    for (int k = 0; k < 5; ++k) {
      const auto ray = seen.ray_of(places[k].x, places[k].y);
      v.require(ray && std::hypot(ray->x - l.opencv[k].x, ray->y - l.opencv[k].y) < 1e-7, l.model, " at place", k);
    }
  }
}

TEST_CASE("A lens shows each ray of its table at its pixel") {
  verdict v;
  for (const lens& l : lenses) {
    const camera seen(seen_by(l.model, l.d));
    const clearance::ray_table table = seen.rays();
    CHECK(table.blind == 0);
    REQUIRE(table.rays.size() == 640 * 480);
    for (std::uint32_t y = 0; y < 480; y += 7)
      for (std::uint32_t x = 0; x < 640; x += 9) {
        const clearance::ray ray = table.rays[y * 640 + x];
        const auto at = shown(l.model, l.d, ray.x, ray.y);
        const at_one also = seen.pixel({ray.x, ray.y});
        const wide u = at[0] * 310 + 317.2L, w = at[1] * 305 + 243.9L;
        v.require(std::hypot(u - x, w - y) < 1e-3, l.model, " misses the pixel", x, y);
        v.require(std::hypot(u - also.x, w - also.y) < 1e-9, l.model, " is shown elsewhere", x, y);
      }
  }
}

TEST_CASE("Without distortion a camera is a pinhole, and its table has the same rays") {
  const std::vector<double> zeros(5);
  for (const char* model : {"plumb_bob", "rational_polynomial", "", "none"})
    for (const std::span<const double> d : {std::span<const double>{}, std::span<const double>(zeros)}) {
      const camera seen(seen_by(model, d));
      const auto pinhole = seen.pinhole();
      REQUIRE(pinhole);
      CHECK((pinhole->fx == 310 && pinhole->fy == 305 && pinhole->cx == 317.2 && pinhole->cy == 243.9));
    }
  const auto table = camera(seen_by("", {})).rays();
  CHECK(table.rays[3 * 640 + 5].x == real((5 - 317.2) / 310));
  CHECK(table.rays[3 * 640 + 5].y == real((3 - 243.9) / 305));
  camera_info skewed = seen_by("", {});
  skewed.k[1] = 2;
  CHECK(!camera(skewed).pinhole());
  const auto ray = camera(skewed).ray_of(100, 50);
  REQUIRE(ray);
  CHECK(std::abs(310 * ray->x + 2 * ray->y + 317.2 - 100) < 1e-9);
}

TEST_CASE("A pixel of a binned region is its pixel of the sensor") {
  camera_info info = seen_by(lenses[0].model, lenses[0].d);
  const camera whole(info);
  info.binning_x = 2, info.binning_y = 3, info.roi = {100, 40, 401, 200};
  const camera part(info);
  CHECK((part.width() == 200 && part.height() == 66));
  verdict v;
  for (const double u : {0.0, 7.0, 199.0})
    for (const double w : {0.0, 30.0, 65.0}) {
      const auto a = part.ray_of(u, w), b = whole.ray_of(2 * u + 100, 3 * w + 40);
      v.require(a && b && std::hypot(a->x - b->x, a->y - b->y) < 1e-10, "pixel", u, w);
    }
}

TEST_CASE("A pixel that a folded lens shows several rays at has none, is counted, and drops its depth") {
  // The radius r (1 - r^2 / 2) grows up to r = sqrt(2 / 3), where it is 0.5443.
  const double d[] = {-0.5, 0, 0, 0, 0};
  const camera_info info{
      .width = 64, .height = 48, .distortion_model = "plumb_bob", .d = d, .k = {50, 0, 32, 0, 50, 24, 0, 0, 1}};
  const auto table = camera(info).rays();
  std::vector<float> metres(64 * 48, 2.0f);
  const clearance::ray_image<float> image(metres.data(), table.rays.data(), table.width, table.height);
  std::size_t blind = 0;
  verdict v;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const double far = std::hypot(x - 32, y - 24) / 50;
      const bool none = far > 2 / 3.0 * std::sqrt(2 / 3.0);
      blind += none;
      const auto sample = image[std::size_t(y * 64 + x)];
      v.require(sample.dropped == (none ? clearance::drop_reason::not_finite : clearance::drop_reason::none), "pixel",
                x, y);
    }
  CHECK(blind > 0);
  CHECK(table.blind == blind);

  // A fisheye sees wider than depth along the axis makes sense.
  const double straight[4] = {};
  const camera_info wide_one{.width = 64,
                             .height = 48,
                             .distortion_model = "equidistant",
                             .d = straight,
                             .k = {20, 0, 32, 0, 20, 24, 0, 0, 1}};
  const camera fisheye(wide_one);
  CHECK(fisheye.ray_of(32 + 20 * 1.54, 24));
  CHECK(!fisheye.ray_of(32 + 20 * 1.56, 24));
  CHECK(fisheye.rays().blind > 0);
  // One that folds: a (1 - a^2 / 3) grows up to a = 1.
  const double folding[4] = {-1 / 3.0, 0, 0, 0};
  camera_info folded = wide_one;
  folded.d = folding;
  CHECK(camera(folded).ray_of(32 + 20 * 0.66, 24));
  CHECK(!camera(folded).ray_of(32 + 20 * 0.67, 24));

  // Only corners that see nothing are left of this region.
  camera_info corner = info;
  corner.roi = {0, 0, 2, 2};
  CHECK(refusal([&] { camera(corner).rays(); }) ==
        "clearance: the camera has a lens whose distortion leaves no pixel a ray");
}

TEST_CASE("An image that is not of its table's size is refused, and one with padded rows is not") {
  const clearance::ray_table table = camera(seen_by(lenses[0].model, lenses[0].d)).rays();
  const std::vector<std::uint16_t> pixels(480 * 700, 1000);
  const auto says = [&](std::uint32_t width, std::uint32_t height, std::size_t row) {
    return refusal([&] { table.image(pixels, width, height, row); });
  };
  CHECK(says(320, 240, 0) == "clearance: the camera has rays for 640 x 480 pixels, but the image has 320 x 240");
  CHECK(says(480, 640, 0) == "clearance: the camera has rays for 640 x 480 pixels, but the image has 480 x 640");
  CHECK(says(640, 480, 701) ==
        "clearance: the camera has an image of 640 x 480 pixels in rows of 701, but it holds 336000");
  CHECK(says(640, 480, 639).find("in rows of 639") != std::string::npos);
  CHECK(says(640, 480, std::size_t(1) << 33).find("in rows of 8589934592") != std::string::npos);
  CHECK(says(640, 480, 0) == "not refused");
  const auto padded = table.image(pixels, 640, 480, 700);
  CHECK((padded.row == 700 && padded.width == 640 && padded.pixels == pixels.data()));
  CHECK(padded[640 * 2 + 5].position.x == float(table.rays[640 * 2 + 5].x * padded[640 * 2 + 5].position.z));
}

TEST_CASE("A CameraInfo that contradicts itself is refused in a sentence") {
  const double d[14] = {0.1, 0.2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0.1}, not_finite[] = {0.1, nan, 0, 0};
  const auto says = [&](auto change) {
    camera_info info = seen_by("plumb_bob", {d, 5});
    change(info);
    return refusal([&] { camera seen(info); });
  };
  CHECK(says([](camera_info&) {}) == "not refused");
  CHECK(says([](camera_info& c) { c.width = -640; }) == "clearance: the camera has -640 x 480 pixels");
  CHECK(says([](camera_info& c) { c.height = 0; }) == "clearance: the camera has 640 x 0 pixels");
  CHECK(says([](camera_info& c) { c.width = 1 << 20; }) == "clearance: the camera has 1048576 x 480 pixels");
  CHECK(says([](camera_info& c) { c.binning_x = -1; }) == "clearance: the camera bins -1 x 0 pixels");
  CHECK(says([](camera_info& c) { c.binning_y = 481; }) == "clearance: the camera bins 0 x 481 pixels");
  CHECK(says([](camera_info& c) { c.binning_y = 100, c.roi = {0, 0, 10, 10}; }) ==
        "clearance: the camera bins more pixels than its region has");
  CHECK(says([](camera_info& c) { c.roi = {600, 0, 41, 480}; }) ==
        "clearance: the camera has a region of 41 x 480 pixels at 600 x 0 that reaches beyond its 640 x 480");
  CHECK(says([](camera_info& c) { c.roi.y_offset = 1; }).find("reaches beyond") != std::string::npos);
  CHECK(says([](camera_info& c) { c.roi.width = -1; }).find("reaches beyond") != std::string::npos);
  CHECK(says([](camera_info& c) { c.k[2] = nan; }) == "clearance: the camera has a number in K that is not finite");
  CHECK(says([](camera_info& c) { c.k = {}; }) ==
        "clearance: the camera is not calibrated: its focal lengths are 0.000000 and 0.000000");
  CHECK(says([](camera_info& c) { c.k[4] = -305; }).find("is not calibrated") != std::string::npos);
  CHECK(says([](camera_info& c) { c.k[8] = 0; }).find("has a K that is not") != std::string::npos);
  CHECK(says([&](camera_info& c) { c.d = not_finite; }) ==
        "clearance: the camera has a number in D that is not finite");
  CHECK(
      says([](camera_info& c) { c.distortion_model = "double_sphere"; }) ==
      "clearance: the camera has a lens 'double_sphere' with 5 coefficients; known are plumb_bob, rational_polynomial "
      "and equidistant");
  CHECK(says([](camera_info& c) { c.distortion_model = ""; }).find("has a lens '' with 5") != std::string::npos);
  CHECK(says([&](camera_info& c) { c.d = d; }).find("with 14 coefficients; known are 0, 4, 5, 8 and 12") !=
        std::string::npos);
  const std::vector<double> upright = {0.1, 0.2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  CHECK(says([&](camera_info& c) { c.d = upright; }) == "not refused");
  CHECK(says([&](camera_info& c) { c.distortion_model = "fisheye"; }) ==
        "clearance: the camera has a lens 'fisheye' with 5 coefficients; known are 4");
}

}  // namespace camera_test
