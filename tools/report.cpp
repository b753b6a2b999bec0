// SPDX-License-Identifier: BSD-3-Clause
#include "report.hpp"

#include "json_text.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>

using namespace clearance;
using json = nlohmann::ordered_json;  // keys in the order in which the manual names them

namespace {

constexpr const char* reasons[drop_reasons] = {"none", "not_finite", "missing", "saturated", "out_of_range", "masked", "too_close"};

std::string text(const char* format, ...) {
  char line[1024];
  va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  return line;
}

/// The pixel of a point of an image.
std::optional<std::pair<std::uint64_t, std::uint64_t>> pixel(const observation& cloud, std::uint32_t point) {
  if (!cloud.image()) return std::nullopt;
  return std::pair{point % cloud.image()->width, point / cloud.image()->width};
}

json xyz(const position& p) { return {p.x, p.y, p.z}; }

/// What a number is when there is none: infinity and NaN have no place in JSON.
json or_null(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

/// State, distance, bracket and witness, which is `point` of `cloud`.
json witness(const min_distance_result& r, const observation* cloud, std::uint32_t point, const std::vector<body>& bodies) {
  const bool any = r.state != state::no_data;
  const auto given = [&](json value) { return any ? value : json(nullptr); };
  json out;
  out["state"] = to_string(r.state);
  out["distance"] = given(any ? or_null(r.distance) : nullptr);
  out["lower"] = given(or_null(r.lower));
  out["upper"] = given(or_null(r.upper));
  out["cloud"] = any ? json(cloud->from.file) : json(nullptr);
  out["point"] = given(point);
  out["pixel"] = nullptr;
  if (any)
    if (const auto at = pixel(*cloud, point)) out["pixel"] = {at->first, at->second};
  out["point_xyz"] = given(xyz(r.at));
  out["part"] = any ? json(bodies[r.part].name) : json(nullptr);
  out["primitive"] = any && r.primitive != none ? json(r.primitive) : json(nullptr);
  out["nearest_xyz"] = given(xyz(r.nearest));
  const bool direction = any && !(r.normal == vec3{0, 0, 0});
  out["normal"] = direction ? json({r.normal.x, r.normal.y, r.normal.z}) : json(nullptr);
  return out;
}

json counts(const min_distance_result& r) {
  json dropped = json::object();
  for (int k = 1; k < drop_reasons; ++k) dropped[reasons[k]] = r.dropped[k];
  return {{"seen", r.seen}, {"valid", r.valid}, {"dropped", dropped}};
}

}  // namespace

std::string to_json(const frame_report& report) {
  json out = {{"frame", report.frame}, {"file", report.file}};
  out.update(witness(report.found.result, report.cloud, report.point, *report.bodies));
  out["points"] = counts(report.found.result);
  out["upload_us"] = std::round(1e9 * report.found.upload) / 1e3;  // the clock's nanoseconds
  out["latency_us"] = std::round(1e9 * report.found.query) / 1e3;
  return json_text(out, -1);
}

std::string to_json(const query_report& report) {
  const min_distance_result& r = report.found.result;
  const bool any = r.state != state::no_data;
  const auto cloud_name = [&](std::uint32_t cloud) { return (*report.clouds)[cloud].from.file; };
  json out = witness(r, any ? &(*report.clouds)[r.cloud] : nullptr, r.point, *report.bodies);
  out["parts"] = json::array();
  for (std::size_t k = 0; k < report.bodies->size(); ++k) {
    const body& made = (*report.bodies)[k];
    const part_minimum& m = report.found.parts[k];
    const bool found = m.point != none;
    json part = {{"name", made.name},
                 {"distance", found ? or_null(m.distance) : json(nullptr)},
                 {"cloud", found ? json(cloud_name(m.cloud)) : json(nullptr)},
                 {"point", found ? json(m.point) : json(nullptr)},
                 {"primitive", found && m.primitive != none ? json(m.primitive) : json(nullptr)},
                 {"caps", {{"loops", made.closed.caps.loops}, {"area", made.closed.caps.area}}}};
    if (report.asked->model == model_kind::spheres) part["gap"] = or_null(made.packed.gap);
    out["parts"].push_back(std::move(part));
  }
  out["points"] = counts(r);
  out["model"] = to_string(report.asked->model);
  out["volume"] = to_string(report.asked->volume);
  out["backend"] = report.asked->on_device ? "device" : "host";
  out["seconds"] = {{"load", report.load}, {"pack", report.pack}, {"build", report.found.build},
                    {"upload", report.found.upload}, {"query", report.found.query}};
  if (report.asked->margin) out["check"] = {{"margin", *report.asked->margin}, {"passes", any && r.lower > *report.asked->margin}};
  out["clouds"] = json::array();
  for (const observation& cloud : *report.clouds) {
    json one = {{"file", cloud.from.file}, {"points", cloud.size()}, {"viewpoint", nullptr}};
    if (cloud.points() && cloud.points()->viewpoint) {
      const auto& [t, q] = *cloud.points()->viewpoint;
      one["viewpoint"] = {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
    }
    out["clouds"].push_back(std::move(one));
  }
  out["notes"] = json::array();
  for (const auto& note : report.notes) out["notes"].push_back(io::sentence(note));
  return json_text(out, 2);
}

std::string to_text(const query_report& report) {
  const min_distance_result& r = report.found.result;
  const query_options& asked = *report.asked;
  std::string out;
  if (r.state == state::no_data) {
    out += "state     no data: there is no valid point, so nothing is known about the robot's surroundings\n";
  } else {
    const observation& cloud = (*report.clouds)[r.cloud];
    const body& part = (*report.bodies)[r.part];
    out += text("state     %s\n", r.state == state::collision ? "collision: a point is certainly inside the robot"
                                  : r.state == state::possible ? "possible: the bracket contains 0"
                                                               : "free");
    out += text("distance  %.6f m; to the solid certainly %.6f to %.6f m\n", double(r.distance), double(r.lower), double(r.upper));
    out += "cloud     " + io::printable(cloud.from.file) + text(", point %u", r.point);
    if (const auto at = pixel(cloud, r.point)) out += text(", pixel %llu,%llu", (unsigned long long)at->first, (unsigned long long)at->second);
    out += text("\npoint     %.6f %.6f %.6f\n", r.at.x, r.at.y, r.at.z);
    out += "part      " + io::printable(part.name);
    if (r.primitive != none) out += text(", %s %u", asked.model == model_kind::spheres ? "sphere" : "triangle", r.primitive);
    out += text("\nnearest   %.6f %.6f %.6f\n", r.nearest.x, r.nearest.y, r.nearest.z);
    if (!(r.normal == vec3{0, 0, 0}))
      out += text("normal    %.6f %.6f %.6f\n", double(r.normal.x), double(r.normal.y), double(r.normal.z));
  }
  out += text("points    %llu seen, %llu valid", (unsigned long long)r.seen, (unsigned long long)r.valid);
  for (int k = 1; k < drop_reasons; ++k)
    if (r.dropped[k] != 0) out += text(", %llu %s", (unsigned long long)r.dropped[k], reasons[k]);
  out += text("\nmodel     %s in %s, on the %s\n", to_string(asked.model), to_string(asked.volume), asked.on_device ? "device" : "host");
  out += text("seconds   load %.3f, pack %.3f, build %.3f, upload %.3f, query %.6f\n", report.load, report.pack,
              report.found.build, report.found.upload, report.found.query);
  if (asked.margin)
    out += text("check     lower end %s %g m: %s\n", r.state != state::no_data && r.lower > *asked.margin ? "above" : "not above",
                *asked.margin, r.state != state::no_data && r.lower > *asked.margin ? "passes" : "fails");
  out += "\nparts\n";
  for (std::size_t k = 0; k < report.bodies->size(); ++k) {
    const body& made = (*report.bodies)[k];
    const part_minimum& m = report.found.parts[k];
    const std::string name = io::printable(made.name);
    out += "  " + name + std::string(name.size() < 28 ? 28 - name.size() : 1, ' ');
    out += m.point == none ? "         -" : text("%10.6f m, point %u", double(m.distance), m.point);
    if (m.point != none && report.clouds->size() > 1) out += " of " + io::printable((*report.clouds)[m.cloud].from.file);
    if (asked.model == model_kind::spheres) out += text(", gap %.4f m", made.packed.gap);
    if (made.closed.caps.loops != 0) out += text(", %u holes closed (%.2g m2)", made.closed.caps.loops, made.closed.caps.area);
    out += '\n';
  }
  return out;
}
