// SPDX-License-Identifier: BSD-3-Clause
// How far a robot is from itself, in one configuration or in many.
#include "command_line.hpp"
#include "messages.hpp"
#include "recording.hpp"
#include "report_csv.hpp"
#include "report_text.hpp"
#include "stopwatch.hpp"

#include <clearance/io/srdf.hpp>
#include <clearance/make_model.hpp>
#include <clearance/self_distances.hpp>
#include <clearance/volume/sphere.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>
#include <ranges>

using namespace clearance;

namespace {

/// The robot with what it holds as further links, each fixed to the one that holds it.
io::robot with_held(const asked_robot& robot) {
  const io::kinematic_tree& tree = robot.description.kinematics();
  std::vector<std::string> links = tree.links();
  std::vector<io::joint> joints = tree.joints();
  std::vector<io::robot_part> parts;
  for (const io::robot_part& part : robot.description.parts())
    parts.push_back({.name = part.name, .mesh = {}, .link = part.link});
  for (const attached_thing& thing : robot.held) {
    parts.push_back({.name = thing.name, .mesh = {}, .link = links.size()});
    links.push_back(thing.name);
    joints.push_back({.name = "attached " + thing.name,
                      .parent = tree.links()[thing.link],
                      .child = thing.name,
                      .origin = thing.from.pose,
                      .follows = {}});
  }
  return {robot.description.name(), io::kinematic_tree(std::move(links), std::move(joints)), std::move(parts), {}};
}

/// The pairs of parts that can meet. Throws usage_error if --allow names none, or if none is left.
part_pairs pairs_of(const query_options& asked, const asked_robot& robot, std::vector<std::string>& notes) {
  const io::robot described = with_held(robot);
  part_pairs pairs = io::pairs_without_neighbours(described);
  if (!asked.srdf.empty()) {
    io::srdf_pairs read =
        io::within_memory(asked.srdf, [&] { return io::load_srdf(asked.srdf, described, asked.limits); });
    pairs = std::move(read.pairs);
    notes.insert(notes.end(), read.notes.begin(), read.notes.end());
    std::vector<std::size_t> held(robot.held.size());
    for (std::size_t k = 0; k < held.size(); ++k) held[k] = robot.description.parts().size() + k;
    io::remove_pairs_of_held(pairs, described, held);
  }
  const auto part_of = [&](const std::string& name) {
    const auto at = std::ranges::find(described.parts(), name, &io::robot_part::name);
    if (at == described.parts().end())
      throw usage_error("--allow", io::quoted(name) + " is no link with geometry, and nothing that is attached");
    return std::size_t(at - described.parts().begin());
  };
  for (const auto& [a, b] : asked.allowed) {
    if (a == b) throw usage_error("--allow", io::quoted(a) + " is given with itself");
    pairs.remove(part_of(a), part_of(b));
  }
  if (pairs.size() == 0) io::refuse(asked.robot, "no two of its links can meet, so there is nothing to ask");
  return pairs;
}

/// What `clearance self` reports.
struct self_report {
  const query_options* asked;
  const std::vector<body>* bodies;
  std::size_t pairs;                    // that can meet
  std::vector<self_clearance> found;    // one for each configuration
  std::vector<pair_clearance> nearest;  // of one configuration: all pairs, the nearest first
  std::vector<std::string> notes = {};
  double load = 0, pack = 0, build = 0, query = 0;  // seconds

  const std::string& name(std::uint32_t part) const { return (*bodies)[part].name; }
  std::string where_from() const { return asked->srdf.empty() ? "all but neighbours" : "by " + asked->srdf; }
  bool passes(const self_clearance& r) const { return !asked->margin || r.lower > *asked->margin; }
  /// The first configuration that fails --check.
  std::optional<std::size_t> first_below() const {
    const auto at = std::ranges::find_if(found, [&](const auto& r) { return !passes(r); });
    return at == found.end() ? std::nullopt : std::optional(std::size_t(at - found.begin()));
  }
};

constexpr const char* self_columns =
    "state,distance,lower,upper,part_a,part_b,sphere_a,sphere_b,a_x,a_y,a_z,b_x,b_y,b_z,normal_x,normal_y,normal_z";

json row_of(const self_report& report, const self_clearance& r) {
  const auto xyz = [](const auto& p) { return json{p.x, p.y, p.z}; };
  return {{"state", to_string(r.state)},
          {"distance", or_null(r.distance)},
          {"lower", or_null(r.lower)},
          {"upper", or_null(r.upper)},
          {"part_a", report.name(r.a)},
          {"part_b", report.name(r.b)},
          {"sphere_a", r.sphere_a},
          {"sphere_b", r.sphere_b},
          {"a_xyz", xyz(r.at_a)},
          {"b_xyz", xyz(r.at_b)},
          {"normal", r.normal == vec3{0, 0, 0} ? json(nullptr) : xyz(r.normal)}};
}

/// How the answer came about.
void add_course(const self_report& report, json& out) {
  if (report.asked->margin)
    out["check"] = {{"margin", *report.asked->margin}, {"passes", !report.first_below().has_value()}};
  out["pairs_that_can_meet"] = report.pairs;
  out["srdf"] = report.asked->srdf.empty() ? json(nullptr) : json(report.asked->srdf);
  out["backend"] = "host";
  out["seconds"] = {{"load", report.load}, {"pack", report.pack}, {"build", report.build}, {"query", report.query}};
}

std::string one_as_json(const self_report& report) {
  json out = row_of(report, report.found[0]);
  out["pairs"] = json::array();
  for (const pair_clearance& pair : report.nearest)
    out["pairs"].push_back({{"part_a", report.name(pair.a)},
                            {"part_b", report.name(pair.b)},
                            {"distance", or_null(pair.distance)},
                            {"lower", or_null(pair.lower)},
                            {"sphere_a", pair.sphere_a},
                            {"sphere_b", pair.sphere_b}});
  out["parts"] = json::array();
  for (const body& made : *report.bodies)
    out["parts"].push_back({{"name", made.name},
                            {"gap", or_null(made.packed.gap)},
                            {"tolerance", tolerance_of(made, model_kind::spheres)}});
  add_course(report, out);
  out["notes"] = json::array();
  for (const auto& note : report.notes) out["notes"].push_back(io::sentence(note));
  return json_text(out, 2);
}

std::string many_as_json(const self_report& report) {
  std::string lines;
  for (std::size_t k = 0; k < report.found.size(); ++k) {
    json row = {{"row", k}};
    row.update(row_of(report, report.found[k]));
    lines += json_text(row, -1);
  }
  const auto least = std::ranges::min_element(report.found, {}, &self_clearance::distance);
  json last = {
      {"self",
       {{"rows", report.found.size()}, {"least", or_null(least->distance)}, {"at", least - report.found.begin()}}}};
  if (report.asked->margin) {
    const auto first = report.first_below();
    last["self"]["first_below"] = first ? json(*first) : json(nullptr);
  }
  add_course(report, last);
  return lines + json_text(last, -1);
}

std::string many_as_csv(const self_report& report) {
  std::string out = std::string("row,") + self_columns + '\n';
  for (std::size_t k = 0; k < report.found.size(); ++k) {
    const self_clearance& r = report.found[k];
    out += std::to_string(k);
    const json row = row_of(report, r);
    for (const auto& [name, value] : row.items()) {
      if (name.ends_with("_xyz") || name == "normal") {
        for (int i = 0; i < 3; ++i) out += ',' + (value.is_null() ? std::string() : value[std::size_t(i)].dump());
      } else {
        out += ',' + csv_word(value, name == "distance" ? double(r.distance) : name == "upper" ? double(r.upper) : 0);
      }
    }
    out += '\n';
  }
  return out;
}

std::string one_as_text(const self_report& report) {
  const self_clearance& r = report.found[0];
  std::string out = text("state     %s\n", r.state == state::collision  ? "collision: two links certainly overlap"
                                           : r.state == state::possible ? "possible: the bracket contains 0"
                                                                        : "free");
  out += text("distance  %.6f m; between the solids certainly %.6f to %.6f m\n", double(r.distance), double(r.lower),
              double(r.upper));
  const auto side = [&](const char* word, std::uint32_t part, std::uint32_t sphere, const position& at) {
    return word + io::printable(report.name(part)) + text(", sphere %u, at %.6f %.6f %.6f\n", sphere, at.x, at.y, at.z);
  };
  out += side("part      ", r.a, r.sphere_a, r.at_a) + side("and       ", r.b, r.sphere_b, r.at_b);
  out += text("pairs     %zu can meet, ", report.pairs) + io::printable(report.where_from()) + '\n';
  out += text("seconds   load %.3f, pack %.3f, build %.3f, query %.6f\n", report.load, report.pack, report.build,
              report.query);
  if (report.asked->margin)
    out += text("check     lower end %s %g m: %s\n", report.passes(r) ? "above" : "not above", *report.asked->margin,
                report.passes(r) ? "passes" : "fails");
  out += "\npairs, the nearest first\n";
  for (const pair_clearance& pair : report.nearest)
    out += name_column(report.name(pair.a)) + name_column(report.name(pair.b)).substr(2) +
           text("%10.6f m, certainly %.6f m\n", double(pair.distance), double(pair.lower));
  return out;
}

int run_self(const query_options& asked) {
  stopwatch clock;
  progress shown;
  shown.show("reading " + asked.robot);
  self_report report{.asked = &asked, .bodies = nullptr, .pairs = 0, .found = {}, .nearest = {}};
  const asked_robot robot = load_robot(asked, report.notes);
  const bool many = !asked.configurations.empty();
  const auto rows = many ? read_rows(asked, robot.description, asked.configurations)
                         : std::vector<std::vector<double>>{about_file(asked.robot, [&] {
                             return named_configuration(asked, robot.description.kinematics());
                           })};
  const placed_rows placed(asked, robot, rows, many ? asked.configurations : std::string());
  const part_pairs pairs = pairs_of(asked, robot, report.notes);
  report.pairs = pairs.size();
  report.load = clock.lap();

  const std::vector<body> bodies = make_bodies(asked, robot, shown, report.notes);
  report.bodies = &bodies;
  report.pack = clock.lap();
  const auto model = make_model<sphere>(bodies | std::views::transform(&body::packed),
                                        [&](std::size_t k) { return part_options{.tolerance = bodies[k].tolerance}; });
  if (many) {
    self_queries ask(host{}, model, pairs);
    report.build = clock.lap();
    shown.show("asking about " + std::to_string(rows.size()) + " configurations");
    placed.for_each_block([&](poses_of poses) { std::ranges::copy(ask(poses), std::back_inserter(report.found)); });
  } else {
    self_query ask(host{}, model, pairs);
    report.build = clock.lap();
    self_distance_result all = ask(placed.first());
    report.found.push_back(all);
    report.nearest = std::move(all.pairs);
    std::ranges::stable_sort(report.nearest, {}, &pair_clearance::distance);
  }
  report.query = clock.lap();
  shown.clear();

  const bool touches = std::ranges::any_of(report.found, [](const auto& r) { return r.state != state::free; });
  if (touches && asked.srdf.empty())
    report.notes.push_back(asked.robot +
                           ": if links that touch here always do, --srdf or --allow says so, and they are left out");
  if (asked.csv && asked.margin) {
    const auto first = report.first_below();
    report.notes.push_back(asked.configurations + (first ? ": row " + std::to_string(*first) +
                                                               " is the first whose lower end is not above the margin"
                                                         : ": every row's lower end is above the margin"));
  }
  say_notes(report.notes);
  std::cout << (asked.csv    ? many_as_csv(report)
                : many       ? many_as_json(report)
                : asked.json ? one_as_json(report)
                             : one_as_text(report));
  return report.first_below() ? 2 : 0;
}

subcommand add_self(CLI::App& app) {
  CLI::App* sub =
      app.add_subcommand("self", "The least distance between links of one robot, in one or many configurations");
  return [options = add_query_options(*sub, asking::self)] { return run_self(options()); };
}

const listed_subcommand listed_self(3, add_self);

}  // namespace
