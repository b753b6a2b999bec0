// SPDX-License-Identifier: BSD-3-Clause
// The tables of `plan` and `run`. A cell holds the value in JSON, or nothing for null.
#include "report.hpp"

#include "report_json.hpp"

#include <cmath>

using namespace clearance;

namespace {

/// A word of CSV (RFC 4180), empty for null. Infinities, which JSON lacks, are words in CSV.
std::string csv_word(const json& value, double number = 0) {
  if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
  if (value.is_null()) return {};
  if (!value.is_string()) return value.dump();
  std::string text = io::printable(value.get<std::string>());
  if (text.find_first_of(",\"") == text.npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != text.npos; at += 2) text.insert(at, 1, '"');
  return '"' + text + '"';
}

const char* const of_witness =
    "state,distance,lower,upper,cloud,point,part,primitive,point_x,point_y,point_z,nearest_x,nearest_y,nearest_z";

std::string cells(const min_distance_result& r, const observation* cloud, std::uint32_t point,
                  const std::vector<body>& bodies) {
  const json row = witness(r, cloud, point, bodies);
  const bool any = r.state != state::no_data;
  std::string out = to_string(r.state);
  for (const auto& [name, value] :
       {std::pair("distance", double(r.distance)), {"lower", double(r.lower)}, {"upper", double(r.upper)}})
    out += ',' + csv_word(row[name], any ? value : 0);
  for (const char* name : {"cloud", "point", "part", "primitive"}) out += ',' + csv_word(row[name]);
  for (const char* name : {"point_xyz", "nearest_xyz"})
    for (int i = 0; i < 3; ++i) out += ',' + (row[name].is_null() ? std::string() : row[name][i].dump());
  return out;
}

}  // namespace

std::string to_csv(const plan_report& report) {
  std::string out =
      std::string("row,") + of_witness +
      (report.asked->between ? ",way_state,way_lower,way_upper,way_time,way_from,way_to,way_part\n" : "\n");
  for (std::size_t k = 0; k < report.found.of.size(); ++k) {
    const min_distance_result& r = report.found.of[k];
    out += std::to_string(k) + ',' + cells(r, cloud_of(report, r), r.point, *report.bodies);
    if (report.asked->between) {
      const json way = k < report.ways.size() ? way_of(report, k) : json::object();  // the last has none
      for (const char* name : {"state", "lower", "upper", "time", "from", "to", "part"})
        out += ',' + (way.contains(name) ? csv_word(way[name]) : std::string());
    }
    out += '\n';
  }
  return out;
}

std::string to_csv(const frame_report& report) {
  std::string out;
  if (report.frame == 0) {
    out = std::string("frame,file,") + of_witness + ",latency_us";
    if (report.plan) out += report.plan->asked->margin ? ",plan_least,plan_at,plan_first_below" : ",plan_least,plan_at";
    out += '\n';
  }
  out += std::to_string(report.frame) + ',' + csv_word(report.file) + ',' +
         cells(report.found.result, report.cloud, report.point, *report.bodies) + ',' +
         csv_word(microseconds(report.query));
  if (report.plan)
    for (const auto plan = outcome_of(*report.plan); const char* const name : {"least", "at", "first_below"})
      if (plan.contains(name)) out += ',' + csv_word(plan[name]);
  return out + '\n';
}
