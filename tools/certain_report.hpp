// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the reports say about uncertainty.

#include "asked_robot.hpp"
#include "report_json.hpp"

#include <clearance/questions/certain_distance.hpp>

/// One radius per part, by --joint-error, --joint-speed and --delay. Empty: none was given. `off`: seconds between
/// the joints and the frame.
std::vector<clearance::part_radius> radii_of(const query_options& asked, const asked_robot& robot,
                                             const std::vector<double>& joints,
                                             std::span<const clearance::part_facts> facts, double off = 0);

/// The sums of `radii_of`, in metres, as questions take them.
std::vector<double> summed_radii(const query_options& asked, const asked_robot& robot,
                                 const std::vector<double>& joints, std::span<const clearance::part_facts> facts,
                                 double off = 0);

/// One radius per part that holds in all rows of a plan: its greatest.
std::vector<double> radii_in_rows(const query_options& asked, const asked_robot& robot,
                                  const std::vector<std::vector<double>>& rows,
                                  std::span<const clearance::part_facts> facts);
/// One radius per part that holds all the way from each row to the next.
std::vector<double> radii_between_rows(const query_options& asked, const asked_robot& robot,
                                       const std::vector<std::vector<double>>& rows,
                                       std::span<const clearance::part_facts> facts);

/// A cloud's own uncertainty, and what joints that are wrong do to the camera, which this link carries.
clearance::cloud_uncertainty carried_off(const query_options& asked, const asked_robot& robot,
                                         const std::vector<double>& joints, const std::string& link,
                                         const Eigen::Isometry3d& carrier, const seen_points& seen, double off);

/// State and bracket, the pair that decides its lower end, and what it loses to what.
json certain_of(const clearance::certain_distance_result& r, const std::vector<const observation*>& clouds,
                const std::vector<body>& bodies);
/// One pair: its lower end, and what it loses to what.
json certain_of(const clearance::certain_pair& pair, const std::vector<const observation*>& clouds);

/// What is certain, as lines of the text.
std::string certain_text(const clearance::certain_distance_result& r, const std::vector<body>& bodies);

/// Adds a note if so many points may be anywhere.
void note_anywhere(std::uint64_t count, std::vector<std::string>& notes);
