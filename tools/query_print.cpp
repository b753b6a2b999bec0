// SPDX-License-Identifier: BSD-3-Clause
#include "query_print.hpp"

#include "questions_report.hpp"
#include "report_text.hpp"

using namespace clearance;

namespace {

json part_of(const query_report& report, std::size_t k) {
  const body& made = (*report.bodies)[k];
  const part_minimum& m = report.found.parts[k];
  const bool found = m.point != none;
  json part = {{"name", made.name},
               {"distance", found ? or_null(m.distance) : json(nullptr)},
               {"cloud", found ? json((*report.clouds)[m.cloud].name) : json(nullptr)},
               {"point", found ? json(m.point) : json(nullptr)},
               {"primitive", found && m.primitive != none ? json(m.primitive) : json(nullptr)},
               {"caps", {{"loops", made.closed.caps.loops}, {"area", made.closed.caps.area}}},
               {"inside", made.closed.loaded != 0 ? json(to_string(made.closed.inside)) : json(nullptr)},
               {"tolerance", tolerance_of(made, report.asked->model)}};
  if (report.asked->model == model_kind::spheres) part["gap"] = or_null(made.packed.gap);
  if (const attached_thing* held = report.robot->held_as(k))
    part["attached"] = {{"link", held->from.link}, {"file", held->from.file}, {"pose", pose_of(held->from.pose)}};
  if (report.certain) part["certain"] = certain_of(report.certain->parts[k], report.all_clouds());
  if (report.zones) part["zones"] = zones_of(report, k);
  if (report.nearest) part["nearest"] = nearest_of(report, k);
  if (report.unseen) part["unseen"] = unseen_of(report.of_unseen(), k);
  if (!report.gradients.empty()) part["gradient"] = gradient_of(report, k);
  return part;
}

json distances_of(const query_report& report) {
  return {{"file", report.asked->distances},
          {"points", report.distances->points},
          {"left_out", report.distances->left_out},
          {"beyond", report.distances->beyond},
          {"signed", report.asked->is_signed || report.asked->model == model_kind::spheres},
          {"d_max", or_null(report.asked->d_max)},
          {"blue_at", report.distances->blue_at}};
}

/// The state, and the nearest point with its place on the robot, if there is a valid point.
std::string witness_text(const query_report& report) {
  const min_distance_result& r = report.found.result;
  const observation& cloud = (*report.clouds)[r.cloud];
  std::string out = text("state     %s\n",
                         r.state == state::collision  ? "collision: a point is certainly inside the robot"
                         : r.state == state::possible ? "possible: the bracket contains 0"
                         : report.filter && report.filter->counts.own != 0 ? "free, of the points that are not hidden"
                                                                           : "free");
  out += text("distance  %.6f m; to the solid certainly %.6f to %.6f m\n", double(r.distance), double(r.lower),
              double(r.upper));
  out += "cloud     " + io::printable(cloud.name) + text(", point %u", r.point);
  if (const auto at = pixel(cloud, r.point))
    out += text(", pixel %llu,%llu", (unsigned long long)at->first, (unsigned long long)at->second);
  out += text("\npoint     %.6f %.6f %.6f\n", r.at.x, r.at.y, r.at.z);
  out += "part      " + io::printable((*report.bodies)[r.part].name);
  if (r.primitive != none)
    out += text(", %s %u", report.asked->model == model_kind::spheres ? "sphere" : "triangle", r.primitive);
  out += text("\nnearest   %.6f %.6f %.6f\n", r.nearest.x, r.nearest.y, r.nearest.z);
  if (!(r.normal == vec3{0, 0, 0}))
    out += text("normal    %.6f %.6f %.6f\n", double(r.normal.x), double(r.normal.y), double(r.normal.z));
  return out;
}

/// How the answer came about: what was seen, what was asked, and how long it took.
std::string course_text(const query_report& report) {
  const min_distance_result& r = report.found.result;
  const query_options& asked = *report.asked;
  std::string out = text("points    %llu seen, %llu valid", (unsigned long long)r.seen, (unsigned long long)r.valid);
  for (int k = 1; k < drop_reasons; ++k)
    if (r.dropped[k] != 0) out += text(", %llu %s", (unsigned long long)r.dropped[k], reasons[k]);
  out += text("\nmodel     %s in %s, on the %s\n", to_string(asked.model), to_string(asked.volume),
              asked.on_device ? "device" : "host");
  return out + text("seconds   load %.3f, pack %.3f, build %.3f, upload %.3f, query %.6f\n", report.load, report.pack,
                    report.build, report.upload, report.query);
}

std::string part_text(const query_report& report, std::size_t k) {
  const body& made = (*report.bodies)[k];
  const part_minimum& m = report.found.parts[k];
  std::string out = name_column(made.name);
  out += m.point == none ? "         -" : text("%10.6f m, point %u", double(m.distance), m.point);
  if (m.point != none && report.clouds->size() > 1) out += " of " + io::printable((*report.clouds)[m.cloud].name);
  if (report.asked->model == model_kind::spheres) out += text(", gap %.4f m", made.packed.gap);
  if (const double off = tolerance_of(made, report.asked->model); off > 0) out += text(", to within %.6f m", off);
  if (const attached_thing* held = report.robot->held_as(k)) out += ", held by link " + io::printable(held->from.link);
  if (made.closed.caps.loops != 0)
    out += text(", %u holes closed (%.2g m2)", made.closed.caps.loops, made.closed.caps.area);
  return out + '\n';
}

}  // namespace

std::string to_json(const query_report& report) {
  const min_distance_result& r = report.found.result;
  json out = witness(r, r.state != state::no_data ? &(*report.clouds)[r.cloud] : nullptr, r.point, *report.bodies);
  out["parts"] = json::array();
  for (std::size_t k = 0; k < report.bodies->size(); ++k) out["parts"].push_back(part_of(report, k));
  out["points"] = counts(r);
  out["model"] = to_string(report.asked->model);
  out["volume"] = to_string(report.asked->volume);
  if (report.cells > 0) out["cells"] = {{"links", report.cells}, {"bytes", report.cells_bytes}};
  out["backend"] = report.asked->on_device ? "device" : "host";
  out["seconds"] = {{"load", report.load},
                    {"pack", report.pack},
                    {"build", report.build},
                    {"upload", report.upload},
                    {"query", report.query}};
  if (report.asked->margin) out["check"] = {{"margin", *report.asked->margin}, {"passes", report.passes()}};
  add_questions(report, out);
  if (report.distances) out["distances"] = distances_of(report);
  out["clouds"] = json::array();
  for (const observation& cloud : *report.clouds) out["clouds"].push_back(about_cloud(cloud));
  out["notes"] = json::array();
  for (const auto& note : report.notes) out["notes"].push_back(io::sentence(note));
  return json_text(out, 2);
}

std::string to_text(const query_report& report) {
  const query_options& asked = *report.asked;
  std::string out;
  if (report.found.result.state != state::no_data)
    out = witness_text(report);
  else
    out = std::string("state     no data: ") +
          (report.found.unseen != 0 ? "no valid point was seen in time" : "there is no valid point") +
          ", so nothing is known about the robot's surroundings\n";
  out += course_text(report);
  if (asked.margin)
    out += text("check     lower end %s %g m: %s\n", report.passes() ? "above" : "not above", *asked.margin,
                report.passes() ? "passes" : "fails");
  out += questions_text(report);
  if (report.distances) {
    const distances_written& d = *report.distances;
    out += "distances " + io::printable(asked.distances) +
           text(": %zu points, %zu left out, %zu beyond %g m; red at 0 m, blue at %g m\n", d.points, d.left_out,
                d.beyond, asked.d_max, d.blue_at);
  }
  out += "\nparts\n";
  for (std::size_t k = 0; k < report.bodies->size(); ++k) out += part_text(report, k);
  return out + parts_text(report);
}
