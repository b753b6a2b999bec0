// SPDX-License-Identifier: BSD-3-Clause
#include "asked_clouds.hpp"
#include "certain_report.hpp"
#include "command_line.hpp"
#include "messages.hpp"
#include "plan_report.hpp"
#include "ranks.hpp"
#include "recording.hpp"
#include "report_text.hpp"
#include "scale_notes.hpp"

#include <clearance/io/joint_motion.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/questions/unseen.hpp>

#include <CLI/CLI.hpp>

#include <iostream>

using namespace clearance;

namespace {

/// The ways from each row to the next, every joint at constant speed.
std::vector<io::joint_motion> ways_between(const query_options& asked, const asked_robot& robot,
                                           const std::vector<std::vector<double>>& rows) {
  std::vector<io::joint_motion> ways;
  for (std::size_t k = 1; k < rows.size(); ++k)
    ways.emplace_back(robot.description, rows[k - 1], rows[k], io::joint_options{asked.ignore_limits}, asked.base);
  return ways;
}

/// Throws usage_error if no row beyond --d-max could pass --check, because parts may be elsewhere.
void check_d_max(const query_options& asked, const std::vector<double>& radii) {
  const double most = radii.empty() ? 0 : std::ranges::max(radii);
  if (asked.margin && !(asked.d_max - most > *asked.margin))
    throw usage_error("--d-max", text("must be above the margin of --check by more than %g m, as far as a link may be "
                                      "elsewhere, or nothing could pass",
                                      most));
}

/// `ranks`: those of --shard.
int run_plan(const query_options& asked, all_ranks* ranks) {
  stopwatch clock;
  progress shown;
  shown.show("reading " + asked.robot);
  std::vector<std::string> notes;
  const asked_robot robot = load_robot(asked, notes);
  const auto rows = read_rows(asked, robot.description, asked.configurations);
  const placed_rows placed(asked, robot, rows, asked.configurations);
  asked_clouds clouds;
  clouds.load(asked, shown, notes);
  clouds.place(asked, robot, rows[0], placed.first());  // a plan begins where the robot is when it looks
  plan_report report{.asked = &asked, .clouds = &clouds.files};
  report.load = clock.lap();

  const field_use fields = uses_fields(asked, rows.size());
  const std::vector<body> bodies = make_bodies(asked, robot, shown, notes, fields);
  report.bodies = &bodies;
  report.pack = clock.lap();
  shown.show("asking about " + std::to_string(rows.size()) + " configurations");
  const asked_model model{asked.model, asked.volume, &bodies, fields,
                          chosen_cache(asked.no_cache, asked.cache).folder()};
  auto robot_there = robot_on(asked.on_device, model);
  if (ranks) robot_there->join(*ranks, asked.alike);
  report.upload = robot_there->see(clouds.seen);

  std::vector<double> radii;
  if (asked.certain) check_d_max(asked, radii = radii_in_rows(asked, robot, rows, robot_there->facts()));
  report.found = ask_plan(*robot_there, placed, asked.d_max, report.query);
  note_scale(clouds.seen, bodies, placed.first().first(bodies.size()), report.found.of[0], notes);
  if (asked.certain) {
    report.certain = ask_certain_plan(*robot_there, placed, asked.d_max, radii, report.query);
    note_anywhere(report.certain[0].anywhere, notes);
  }
  if (asked.unseen) {
    shown.show("asking about what is hidden");
    report.unseen = ask_plan_unseen(*robot_there, placed, {.room = *asked.unseen, .radii = radii}, bodies.size(), false,
                                    report.query);
  }

  if (asked.between) {
    shown.show("asking about the ways between them");
    // With a margin only as exact as the decision needs; otherwise to a centimetre.
    motion_clearance_options options{.tolerance = asked.margin ? double(infinity) : 0.01,
                                     .margin = asked.margin.value_or(0),
                                     .radii = radii_between_rows(asked, robot, rows, robot_there->facts())};
    const auto ways = ways_between(asked, robot, rows);
    report.ways = robot_there->ways(ways, options);
    report.query += robot_there->query;
    if (asked.unseen) {
      const unseen room{.room = *asked.unseen, .radii = std::exchange(options.radii, {})};
      report.hidden = robot_there->hidden_ways(ways, options, room);
      report.query += robot_there->query;
    }
  }

  if (ranks) ranks->part();
  if (ranks && !ranks->speaks()) return 0;
  report.build = robot_there->build;
  report.fields = robot_there->fields;
  report.fields_cached = robot_there->fields_cached;
  report.upload += robot_there->upload;
  shown.clear();

  if (asked.csv && asked.margin) {
    const auto first = report.first_below();
    notes.push_back(asked.configurations +
                    (first ? ": row " + std::to_string(*first) + " is the first whose lower end is not above the margin"
                           : ": every row's lower end is above the margin"));
    if (const auto row = report.first_hidden_below())
      notes.push_back(asked.configurations + ": in row " + std::to_string(*row) +
                      " what is hidden may be within the margin, which no row before is known to be");
    if (const auto way = report.first_way_below())
      notes.push_back(asked.configurations + ": on the way from row " + std::to_string(*way) +
                      " to the next the margin may be fallen below");
    if (const auto way = report.first_hidden_way_below())
      notes.push_back(asked.configurations + ": on the way from row " + std::to_string(*way) +
                      " to the next what is hidden may be within the margin");
  }
  note_fields(*robot_there, bodies, notes);
  say_notes(notes);
  std::cout << (asked.csv ? to_csv(report) : to_json(report));
  return report.code();
}

subcommand add_plan(CLI::App& app) {
  CLI::App* sub =
      app.add_subcommand("plan", "The least distance of many configurations, such as those of a planned path");
  return [options = add_query_options(*sub, asking::plan)] {
    const query_options asked = options();
    return asked.shard ? on_all_ranks([&](all_ranks& ranks) { return run_plan(asked, &ranks); })
                       : run_plan(asked, nullptr);
  };
}

const listed_subcommand listed_plan(2, add_plan);

}  // namespace
