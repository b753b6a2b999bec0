// SPDX-License-Identifier: BSD-3-Clause
// Every point source, and every question's options, with each member wrong: refused by a sentence before a point is
// read, by every engine.
#include "doors/refusals.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/compacted.hpp>
#include <clearance/deadline.hpp>
#include <clearance/frames/cropped_clouds.hpp>
#include <clearance/make_model.hpp>
#include <clearance/points/camera.hpp>
#include <clearance/points/strided_points.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

namespace sources_test {

using namespace testing;
using namespace clearance;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
const std::vector poses(2, Eigen::Isometry3d::Identity());
const auto& robot() {
  static const auto part = make_part<sphere>(std::vector{inner_sphere{{0, 0, 0}, 0.5f}});
  static const model both{std::vector{part, part}};
  return both;
}

/// With `set(wrong)` in place of what it should be.
template <class T>
struct spoilt {
  const char* what;
  std::function<void(T&)> set;
};

}  // namespace

TEST_CASE("a point source whose members contradict one another is refused before a point is read") {
  refused_doors r;
  const auto asked = [&]<class S>(const S& right, const std::vector<spoilt<S>>& all) {
    for (const auto& [what, set] : all) {
      r.check(what, right, [](const S& s) { ask(host{}, robot(), poses, s, min_distance{}); }, set);
      r.check(what, right, [](const S& s) { ask(host{}, robot(), poses, std::tuple(s), in_collision{}); }, set);
      r.check(what, right, [](const S& s) { return rounding_of(s); }, set);
    }
  };
  std::vector<vec3> points(8, vec3{2, 0, 0});
  asked(point_span(points), {
                                {"null", [](auto& s) { s.points = nullptr; }},
                                {"a nearest", [](auto& s) { s.filter.nearest = not_a_number; }},
                                {"a farthest", [](auto& s) { s.filter.farthest = not_a_number; }},
                                {"a range that falls", [](auto& s) { s.filter.nearest = 3, s.filter.farthest = 1; }},
                                {"a sensor", [](auto& s) { s.filter.sensor.y = infinity; }},
                                {"a negative error", [](auto& s) { s.off.absolute = -1; }},
                                {"an infinite error", [](auto& s) { s.off.relative = inf; }},
                                {"an error", [](auto& s) { s.off.absolute = nan; }},
                            });
  strided_points<float> records;
  records.data = reinterpret_cast<const std::byte*>(points.data()), records.count = 8, records.step = 12;
  records.width = 4, records.row_step = 48;
  asked(records, {
                     {"null", [](auto& s) { s.data = nullptr; }},
                     {"no step", [](auto& s) { s.step = 0; }},
                     {"no row_step", [](auto& s) { s.row_step = 0; }},
                     {"an origin", [](auto& s) { s.origin.x = not_a_number; }},
                     {"a negative error", [](auto& s) { s.off = -1; }},
                     {"a nearest", [](auto& s) { s.filter.nearest = not_a_number; }},
                 });
  const std::vector<std::uint16_t> pixels(12, 2000);
  const depth_image<std::uint16_t> image(pixels.data(), 4, 3, {2, 2, 1.5, 1});
  asked(image, {
                   {"null", [](auto& s) { s.pixels = nullptr; }},
                   {"rows in one another", [](auto& s) { s.row = 3; }},
                   {"no scale", [](auto& s) { s.scale = 0; }},
                   {"a negative scale", [](auto& s) { s.scale = -0.001f; }},
                   {"a scale", [](auto& s) { s.scale = not_a_number; }},
                   {"a nearest", [](auto& s) { s.nearest = not_a_number; }},
                   {"a range that falls", [](auto& s) { s.nearest = 3, s.farthest = 1; }},
                   {"an infinite focal length", [](auto& s) { s.inverse_fx = 0; }},
                   {"no focal length", [](auto& s) { s.inverse_fy = infinity; }},
                   {"a focal length", [](auto& s) { s.inverse_fy = not_a_number; }},
                   {"a centre", [](auto& s) { s.cx = not_a_number; }},
               });
  const auto unseen_of = [](const auto& s) { ask(host{}, robot(), poses, s, unseen{}); };
  r.check("rows in one another", image, unseen_of, [](auto& s) { s.row = 3; });
  r.check("no scale", image, unseen_of, [](auto& s) { s.scale = 0; });
  const std::vector<ray> rays(12, ray{0, 0});
  asked(ray_image<std::uint16_t>(pixels.data(), rays.data(), 4, 3),
        {
            {"null", [](auto& s) { s.pixels = nullptr; }},
            {"no rays", [](auto& s) { s.rays = nullptr; }},
            {"rows in one another", [](auto& s) { s.row = 3; }},
            {"a scale", [](auto& s) { s.scale = not_a_number; }},
            {"a range that falls", [](auto& s) { s.nearest = 3, s.farthest = 1; }},
        });
  const std::vector<point_label> labels(8);
  asked(masked<point_span>(points, labels.data()), {
                                                       {"no labels", [](auto& s) { s.labels = nullptr; }},
                                                       {"no points", [](auto& s) { s.source.points = nullptr; }},
                                                   });
  asked(cropped(point_span(points), crop().height(-1, 1).seen_from(poses[0])),
        {
            {"too many boxes", [](auto& s) { s.boxes.count = 9; }},
            {"a corner", [](auto& s) { s.boxes.box[0].upper.z = not_a_number; }},
            {"a box at no place", [](auto& s) { s.boxes.box[0].box_from_cloud.translation.x = infinity; }},
            {"no points to crop", [](auto& s) { s.source.points = nullptr; }},
        });
  const std::vector<real> radii(8, 0.01f);
  any_noise noise;
  noise.kind = noise_kind::radii, noise.radii = point_radii(radii);
  asked(uncertain(point_span(points), noise), {
                                                  {"a shift", [](auto& s) { s.shift = -1; }},
                                                  {"a turn", [](auto& s) { s.turn = not_a_number; }},
                                                  {"a drift", [](auto& s) { s.drift = infinity; }},
                                                  {"a kind of noise", [](auto& s) { s.noise.kind = noise_kind(9); }},
                                                  {"no radii", [](auto& s) { s.noise.radii.radii = nullptr; }},
                                                  {"fewer radii", [](auto& s) { s.noise.radii.count = 7; }},
                                                  {"a noise", [](auto& s) { s.noise.tof.square = -1; }},
                                                  {"no points", [](auto& s) { s.source.points = nullptr; }},
                                              });
  CHECK(r.checked() == 3 * 44 + 2);
  // Other engines and forms, with one source.
  const auto null = [](point_span& s) { s.points = nullptr; };
  const auto by = [&](const char* what, const auto& q) {
    r.check(what, point_span(points), [&](point_span s) { ask(host{}, robot(), poses, s, q); }, null);
  };
  by("certain_distance", certain_distance{}), by("distances", distances{}), by("min_distances", min_distances{});
  by("in_collisions", in_collisions{}), by("zones", zones{{0.1}}), by("self_filter", self_filter{});
  by("nearest_k", nearest_k{}), by("min_distance_supported", min_distance_supported{});
  r.check("compacted", point_span(points), [](point_span s) { compacted(host{}, s); }, null);
  r.check(
      "a deadline", point_span(points),
      [](point_span s) { ask_by(host{}, robot(), poses, s, std::chrono::hours(1), min_distance{}); }, null);
  chunked_query in_chunks(host{}, robot(), zones{{0.1}});
  r.check(
      "chunks", point_span(points),
      [&](point_span s) {
        chunked cloud(s);
        in_chunks(poses, cloud);
      },
      null);
}

TEST_CASE("a ray table without a ray for each pixel is refused") {
  refused_doors r;
  const std::vector<float> pixels(12, 1.0f);
  const ray_table table{4, 3, std::vector<ray>(12), 0};
  const auto image = [&](const ray_table& t) { t.image(pixels, t.width, t.height); };
  r.check("fewer rays", table, image, [](auto& t) { t.rays.pop_back(); });
  r.check("more pixels", table, image, [](auto& t) { t.height = 4; });
}

TEST_CASE("options that no frame could mend are refused when the question is prepared") {
  refused_doors r;
  const auto of = [&]<class Q>(const Q& right, const std::vector<spoilt<Q>>& all) {
    for (const auto& [what, set] : all) {
      r.check(what, right, [](const Q& q) { query(host{}, robot(), q); }, set);
      r.check(what, right, [](const Q& q) { ask(host{}, robot(), poses, std::vector{vec3{2, 0, 0}}, q); }, set);
    }
  };
  const auto radii_of = []<class Q>(const Q&) {
    return std::vector<spoilt<Q>>{{"a radius", [](auto& q) { q.radii = {nan}; }},
                                  {"a negative radius", [](auto& q) { q.radii = {0, -0.1}; }},
                                  {"three radii", [](auto& q) { q.radii = {0, 0, 0}; }}};
  };
  const zones two{{0.1, 0.3}};
  of(two, {
              {"no zone", [](auto& q) { q.thresholds.clear(); }},
              {"zones that fall", [](auto& q) { q.thresholds = {0.3, 0.1}; }},
              {"a zone", [](auto& q) { q.thresholds = {0.1, nan}; }},
              {"a negative zone", [](auto& q) { q.thresholds = {-0.1, 0.1}; }},
              {"zones of three parts", [](auto& q) { q.thresholds = {0, 1, 2}, q.each_part = true; }},
              {"a part's zones that fall", [](auto& q) { q.thresholds = {0, 1, 1, 0}, q.each_part = true; }},
              {"no points", [](auto& q) { q.min_points = 0; }},
          });
  of(two, radii_of(two));
  of(within{{0.1}}, {
                        {"none", [](auto& q) { q.radius.clear(); }},
                        {"one", [](auto& q) { q.radius = {nan}; }},
                        {"three", [](auto& q) { q.radius = {1, 1, 1}; }},
                    });
  of(in_collision{}, {
                         {"no margin", [](auto& q) { q.margins.clear(); }},
                         {"a margin", [](auto& q) { q.margins = {0, nan}; }},
                         {"three margins", [](auto& q) { q.margins = {0, 0, 0}; }},
                     });
  of(in_collision{}, radii_of(in_collision{}));
  of(in_collisions{}, {
                          {"no margin", [](auto& q) { q.margins.clear(); }},
                          {"a margin", [](auto& q) { q.margins = {nan}; }},
                      });
  of(in_collisions{}, radii_of(in_collisions{}));
  of(self_filter{}, {
                        {"no padding", [](auto& q) { q.padding.clear(); }},
                        {"a padding", [](auto& q) { q.padding = {nan}; }},
                        {"a negative padding", [](auto& q) { q.padding = {0.1, -0.1}; }},
                        {"an infinite padding", [](auto& q) { q.padding = {inf}; }},
                        {"three paddings", [](auto& q) { q.padding = {0, 0, 0}; }},
                    });
  of(nearest_k{}, {
                      {"none", [](auto& q) { q.k = 0; }},
                      {"too many", [](auto& q) { q.k = (1 << 20) + 1; }},
                      {"d_max", [](auto& q) { q.d_max = nan; }},
                  });
  of(min_distance_supported{}, {
                                   {"no point", [](auto& q) { q.min_points = 0; }},
                                   {"a radius", [](auto& q) { q.radius = nan; }},
                                   {"a negative radius", [](auto& q) { q.radius = -1; }},
                                   {"none asked", [](auto& q) { q.most = 0; }},
                               });
  of(distances{}, {{"d_max", [](auto& q) { q.d_max = nan; }}});
  of(distances_per_part{}, {{"d_max", [](auto& q) { q.d_max = nan; }}});
  of(min_distances{}, {{"d_max", [](auto& q) { q.d_max = nan; }}});
  of(min_distances{}, radii_of(min_distances{}));
  of(min_distances_per_part{}, {{"d_max", [](auto& q) { q.d_max = nan; }}});
  of(min_distances_per_part{}, radii_of(min_distances_per_part{}));
  of(certain_distance{}, {
                             {"a radius by joints", [](auto& q) { q.parts = {{nan, 0}, {0, 0}}; }},
                             {"a radius by a delay", [](auto& q) { q.parts = {{0, 0}, {0, -1}}; }},
                             {"three radii", [](auto& q) { q.parts.resize(3); }},
                         });
  const auto unseen_by = [&](const char* what, const auto& set) {
    r.check(what, unseen{}, [](const unseen& q) { query(host{}, robot(), q); }, set);
  };
  for (const real bad : {not_a_number, real(0), real(20), infinity})
    unseen_by("nearest", [&](unseen& q) { q.room.nearest = bad; });
  for (const real bad : {not_a_number, real(0), real(2e6)})
    unseen_by("farthest", [&](unseen& q) { q.room.farthest = bad; });
  for (const double bad : {nan, -0.1, 0.25}) unseen_by("half_pixel", [&](unseen& q) { q.half_pixel = bad; });
  for (const auto& [what, set] : radii_of(unseen{})) unseen_by(what, set);
}

}  // namespace sources_test
