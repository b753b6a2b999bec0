// SPDX-License-Identifier: BSD-3-Clause
#include "questions_report.hpp"

#include "filter_report.hpp"
#include "report_text.hpp"

#include <cmath>

using namespace clearance;

namespace {

/// The cloud and number of a point in a zone.
json place(const query_report& report, std::uint32_t cloud, std::uint32_t point) {
  return {{"cloud", (*report.clouds)[cloud].name}, {"point", point}};
}

}  // namespace

json zones_of(const query_report& report, std::size_t part) {
  json zones = json::array();
  for (std::size_t z = 0; z < report.zones->per_part; ++z) {
    const zone& found = report.zones->of(part, z);
    json one = {{"within", report.asked->zones[z]}, {"points", found.points}, {"nearest", nullptr}, {"first", nullptr}};
    if (found.points != 0) {
      one["nearest"] = {{"distance", or_null(found.nearest)}};
      one["nearest"].update(place(report, found.nearest_cloud, found.nearest_point));
      one["first"] = place(report, found.first_cloud, found.first_point);
    }
    zones.push_back(std::move(one));
  }
  return zones;
}

json nearest_of(const query_report& report, std::size_t part) {
  json pairs = json::array();
  for (const pair_distance& pair : report.nearest->of(part)) {
    if (pair.point == none) break;  // the list has ended
    json one = place(report, pair.cloud, pair.point);
    const auto at = pixel((*report.clouds)[pair.cloud], pair.point);
    one["pixel"] = at ? json{at->first, at->second} : json(nullptr);
    one["distance"] = or_null(pair.distance);
    one["lower"] = report.nearest->certain.lower(pair);
    one["primitive"] = pair.primitive == none ? json(nullptr) : json(pair.primitive);
    pairs.push_back(std::move(one));
  }
  return pairs;
}

json gradient_of(const query_report& report, std::size_t part) {
  const part_gradient& g = report.gradients[part];
  const auto known = [&](json value) { return g.of_pose ? value : json(nullptr); };
  const auto xyz = [](const vec3& v) { return json{v.x + 0, v.y + 0, v.z + 0}; };  // no -0
  json out = {{"state", to_string(g.of_pose.state)},
              {"about", {g.of_pose.about.x, g.of_pose.about.y, g.of_pose.about.z}},
              {"linear", known(xyz(g.of_pose.linear))},
              {"angular", known(xyz(g.of_pose.angular))}};
  const io::kinematic_tree& tree = report.robot->description.kinematics();
  if (tree.size() == 0) return out;
  out["joints"] = g.of_joints ? json::object() : json(nullptr);
  if (g.of_joints)
    for (std::size_t i = 0; i < tree.size(); ++i) out["joints"][tree.movable(i).name] = (*g.of_joints)[Eigen::Index(i)];
  return out;
}

namespace {

/// For --check: is the nearest confirmed point certainly farther away than the margin?
bool passes(const query_report& report) {
  return report.support->state != state::no_data && report.support->lower > *report.asked->margin;
}

json support_of(const query_report& report) {
  const supported_distance& s = *report.support;
  const bool any = s.point != none;
  const auto given = [](bool there, json value) { return there ? value : json(nullptr); };
  json out = {{"min_points", report.asked->support->min_points},
              {"radius", report.asked->support->radius},
              {"state", to_string(s.state)},
              {"distance", given(any, or_null(s.distance))},
              {"lower", given(s.state != state::no_data, or_null(s.lower))}};
  out.update(any ? place(report, s.cloud, s.point) : json{{"cloud", nullptr}, {"point", nullptr}});
  out["part"] = any ? json((*report.bodies)[s.part].name) : json(nullptr);
  out["primitive"] = given(any && s.primitive != none, s.primitive);
  out["complete"] =
      !(s.state == state::possible && std::isnan(s.distance));  // false: only the nearest points were asked
  out["isolated"] = s.isolated;
  out["nearest_isolated"] = nullptr;
  if (s.isolated != 0) {
    json& alone = out["nearest_isolated"] = {{"distance", or_null(s.nearest_isolated.distance)}};
    alone.update(place(report, s.nearest_isolated.cloud, s.nearest_isolated.point));
    alone["part"] = (*report.bodies)[s.nearest_isolated.part].name;
  }
  if (report.asked->margin) out["passes"] = passes(report);
  return out;
}

std::string support_text(const query_report& report) {
  const supported_distance& s = *report.support;
  const auto named = [&](std::uint32_t cloud, std::uint32_t point, std::uint32_t part) {
    const std::string of = report.clouds->size() > 1 ? " of " + io::printable((*report.clouds)[cloud].name) : "";
    return text("point %u", point) + of + " and part " + io::printable((*report.bodies)[part].name);
  };
  const std::string enough =
      text("%u points within %g m", report.asked->support->min_points, report.asked->support->radius);
  std::string out = "support   ";
  if (s.state == state::no_data) return out + "nothing is known\n";
  if (s.point != none)
    out += text("%.6f m, certainly at least %.6f m: the nearest point that has ", double(s.distance), double(s.lower)) +
           enough + ", " + named(s.cloud, s.point, s.part);
  else
    out += (std::isnan(s.distance) ? "none of the nearest points has " : "no point has ") + enough;
  out += text("; %llu %spoints are alone", (unsigned long long)s.isolated, s.point != none ? "nearer " : "");
  if (s.isolated != 0)
    out += text(", the first at %.6f m, ", double(s.nearest_isolated.distance)) +
           named(s.nearest_isolated.cloud, s.nearest_isolated.point, s.nearest_isolated.part);
  if (report.asked->margin) out += text("; %s %g m", passes(report) ? "above" : "not above", *report.asked->margin);
  return out + '\n';
}

std::string zones_text(const query_report& report) {
  const auto named = [&](std::uint32_t cloud, std::uint32_t point) {
    const std::string of = report.clouds->size() > 1 ? " of " + io::printable((*report.clouds)[cloud].name) : "";
    return text("point %u", point) + of;
  };
  std::string out =
      "\nzones" +
      (report.asked->min_points > 1 ? text(" (fewer than %zu points do not count)", report.asked->min_points) : "") +
      '\n';
  for (std::size_t k = 0; k < report.bodies->size(); ++k) {
    for (std::size_t z = 0; z < report.zones->per_part; ++z) {
      const zone& found = report.zones->of(k, z);
      out += name_column(z == 0 ? (*report.bodies)[k].name : "");
      out += text("%10g m, %8llu points", report.asked->zones[z], (unsigned long long)found.points);
      if (found.points != 0)
        out += text(", nearest %.6f m, ", double(found.nearest)) + named(found.nearest_cloud, found.nearest_point) +
               "; first " + named(found.first_cloud, found.first_point);
      out += '\n';
    }
  }
  return out;
}

std::string nearest_text(const query_report& report) {
  std::string out = "\nnearest points (of each link up to " + std::to_string(report.asked->nearest);
  if (std::isfinite(report.asked->d_max)) out += text(", within %g m", report.asked->d_max);
  out += ")\n";
  for (std::size_t k = 0; k < report.bodies->size(); ++k) {
    const std::string& name = (*report.bodies)[k].name;
    std::size_t listed = 0;
    for (const pair_distance& pair : report.nearest->of(k)) {
      if (pair.point == none) break;
      out += name_column(listed++ == 0 ? name : "");
      out += text("%.6f m, certainly at least %.6f m: point %u", double(pair.distance),
                  double(report.nearest->certain.lower(pair)), pair.point);
      out += (report.clouds->size() > 1 ? " of " + io::printable((*report.clouds)[pair.cloud].name) : "") + '\n';
    }
    if (listed == 0) out += name_column(name) + "none\n";
  }
  return out;
}

std::string gradients_text(const query_report& report) {
  const io::kinematic_tree& tree = report.robot->description.kinematics();
  std::string out =
      "\ngradients (of each distance, by a twist of its part at its origin, in world axes: m/m and m/rad; and by "
      "joints: m/m or m/rad)\n";
  for (std::size_t k = 0; k < report.bodies->size(); ++k) {
    const part_gradient& g = report.gradients[k];
    out += name_column((*report.bodies)[k].name);
    if (!g.of_pose) {
      out += text("none: %s\n", to_string(g.of_pose.state));
      continue;
    }
    for (const auto& [what, v] : {std::pair("linear", g.of_pose.linear), {", angular", g.of_pose.angular}})
      out += what + text(" %.6f %.6f %.6f", double(v.x + 0), double(v.y + 0), double(v.z + 0));  // no -0
    for (std::size_t i = 0; i < tree.size(); ++i)
      out += (i ? ", " : "; ") + io::printable(tree.movable(i).name) + text(" %+.6f", (*g.of_joints)[Eigen::Index(i)]);
    out += '\n';
  }
  return out;
}

std::string deadline_text(const query_report& report) {
  const reply& found = report.found;
  const std::string by = text("deadline  %g ms: ", *report.asked->deadline);
  if (found.unseen == 0) return by + "all points were looked at\n";
  return by + text("%llu of %llu points were not looked at, and may be anywhere\n", (unsigned long long)found.unseen,
                   (unsigned long long)(found.unseen + found.result.seen));
}

/// What the zones say about the robot.
std::string innermost_text(const query_report& report) {
  if (report.zones->counts.valid == 0) return "nothing is known, which counts as the first";
  if (report.zones->counts.dropped[int(drop_reason::too_close)] != 0)
    return "something is too close to be measured, which counts as the first";
  const std::size_t z = report.zones->innermost();
  return (z < report.zones->per_part ? text("the innermost is within %g m", report.asked->zones[z]) : "all are empty") +
         (report.certain ? ", wherever points and links may be" : "");
}

}  // namespace

void add_questions(const query_report& report, json& out) {
  if (report.asked->deadline)
    out["deadline"] = {{"milliseconds", *report.asked->deadline},
                       {"unseen", report.found.unseen},
                       {"complete", report.found.unseen == 0}};
  if (report.filter) out["filter"] = filter_of(*report.asked, *report.filter, report.found.result);
  if (report.zones) {
    const std::size_t z = report.zones->innermost();
    out["zones"] = {{"thresholds", report.asked->zones},
                    {"min_points", report.zones->min_points},
                    {"innermost", z < report.zones->per_part ? json(z) : json(nullptr)}};
  }
  if (report.certain) out["certain"] = certain_of(*report.certain, report.all_clouds(), *report.bodies);
  if (report.support) out["support"] = support_of(report);
  if (report.unseen) out["unseen"] = unseen_of(report.of_unseen());
  if (report.gradients.empty()) return;
  const std::uint32_t part = report.found.result.part;
  out["gradient"] = {{"part", part == none ? json(nullptr) : json((*report.bodies)[part].name)}};
  if (part != none) out["gradient"].update(gradient_of(report, part));
}

std::string questions_text(const query_report& report) {
  std::string out;
  if (report.asked->deadline) out += deadline_text(report);
  if (report.filter) out += filter_text(*report.asked, *report.filter, report.found.result);
  if (report.certain) out += certain_text(*report.certain, *report.bodies);
  if (report.zones) out += "zones     " + innermost_text(report) + '\n';
  if (report.support) out += support_text(report);
  if (report.unseen) out += unseen_text(report.of_unseen());
  return out;
}

std::string parts_text(const query_report& report) {
  std::string out;
  if (report.zones) out += zones_text(report);
  if (report.nearest) out += nearest_text(report);
  if (report.unseen) out += unseen_parts_text(report.of_unseen());
  if (!report.gradients.empty()) out += gradients_text(report);
  return out;
}
