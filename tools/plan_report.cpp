// SPDX-License-Identifier: BSD-3-Clause
#include "report.hpp"

#include "report_json.hpp"

#include <algorithm>
#include <cmath>

using namespace clearance;

namespace {

const observation* cloud_of(const plan_report& report, const min_distance_result& r) {
  return r.point == none ? nullptr : &(*report.clouds)[r.cloud];
}

/// A word of CSV (RFC 4180); nothing for null. What JSON cannot say of numbers, CSV can.
std::string csv_word(const json& value, double number = 0) {
  if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
  if (value.is_null()) return {};
  if (!value.is_string()) return value.dump();
  std::string text = io::printable(value.get<std::string>());
  if (text.find_first_of(",\"") == text.npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != text.npos; at += 2) text.insert(at, 1, '"');
  return '"' + text + '"';
}

/// From a row to the next; `time` and `from` to `to` are between 0 and 1.
json way_of(const plan_report& report, std::size_t k) {
  const motion_clearance_result& way = report.ways[k];
  const bool any = way.state != state::no_data;
  const auto given = [&](json value) { return any ? value : json(nullptr); };
  return {{"state", to_string(way.state)}, {"lower", given(or_null(way.lower))}, {"upper", given(or_null(way.upper))}, {"time", given(or_null(way.time))},
          {"from", given(way.from)},       {"to", given(way.to)},
          {"part", any && way.part != none ? json((*report.bodies)[way.part].name) : json(nullptr)},
          {"queries", way.queries},        {"settled", way.settled}};
}

}  // namespace

std::optional<std::size_t> plan_report::first_below() const {
  const std::size_t first = blind() ? 0 : found.first_below(*asked->margin);
  return first < found.of.size() ? std::optional(first) : std::nullopt;
}

std::optional<std::size_t> plan_report::first_way_below() const {
  for (std::size_t k = 0; k < ways.size(); ++k)
    if (!(ways[k].lower > *asked->margin)) return k;
  return std::nullopt;
}

json outcome_of(const plan_report& report) {
  const auto& all = report.found.of;
  const auto least = std::ranges::min_element(all, {}, [](const min_distance_result& r) { return r.distance; });
  const bool any = !report.blind() && std::isfinite(least->distance);
  json out = {{"rows", all.size()}, {"least", any ? json(least->distance) : json(nullptr)}, {"at", any ? json(least - all.begin()) : json(nullptr)}};
  if (report.asked->margin) {
    const auto first = report.first_below();
    out["first_below"] = first ? json(*first) : json(nullptr);
  }
  if (!report.asked->between) return out;
  const auto worst = std::ranges::min_element(report.ways, {}, [](const motion_clearance_result& way) { return way.lower; });
  const bool some = !report.blind() && worst != report.ways.end();
  out["ways"] = {{"least_lower", some ? or_null(worst->lower) : json(nullptr)}, {"at", some ? json(worst - report.ways.begin()) : json(nullptr)}};
  if (report.asked->margin) {
    const auto first = report.first_way_below();
    out["ways"]["first_below"] = first ? json(*first) : json(nullptr);
  }
  return out;
}

std::string to_json(const plan_report& report) {
  std::string out;
  for (std::size_t k = 0; k < report.found.of.size(); ++k) {
    const min_distance_result& r = report.found.of[k];
    json row = {{"row", k}};
    row.update(witness(r, cloud_of(report, r), r.point, *report.bodies));
    if (k < report.ways.size()) row["way"] = way_of(report, k);
    out += json_text(row, -1);
  }
  json last = {{"plan", outcome_of(report)}};
  if (report.asked->margin) last["check"] = {{"margin", *report.asked->margin}, {"passes", report.code() == 0}};
  min_distance_result all = report.found.of[0];
  for (const observation& cloud : *report.clouds) cloud.recount(all);
  last["points"] = counts(all);
  last["model"] = to_string(report.asked->model);
  last["backend"] = report.asked->on_device ? "device" : "host";
  last["seconds"] = {{"load", report.load}, {"pack", report.pack}, {"build", report.build}, {"upload", report.upload}, {"query", report.query}};
  return out + json_text(last, -1);
}

std::string to_csv(const plan_report& report) {
  std::string out = "row,state,distance,lower,upper,cloud,point,part,primitive,point_x,point_y,point_z,nearest_x,nearest_y,nearest_z";
  out += report.asked->between ? ",way_state,way_lower,way_upper,way_time,way_part\n" : "\n";
  for (std::size_t k = 0; k < report.found.of.size(); ++k) {
    const min_distance_result& r = report.found.of[k];
    const json row = witness(r, cloud_of(report, r), r.point, *report.bodies);
    const bool any = r.state != state::no_data;
    out += std::to_string(k) + ',' + to_string(r.state);
    for (const auto& [name, value] : {std::pair("distance", double(r.distance)), {"lower", double(r.lower)}, {"upper", double(r.upper)}})
      out += ',' + csv_word(row[name], any ? value : 0);
    for (const char* name : {"cloud", "point", "part", "primitive"}) out += ',' + csv_word(row[name]);
    for (const char* name : {"point_xyz", "nearest_xyz"})
      for (int i = 0; i < 3; ++i) out += ',' + (row[name].is_null() ? std::string() : row[name][i].dump());
    if (report.asked->between) {
      const json way = k < report.ways.size() ? way_of(report, k) : json::object();  // none from the last
      for (const char* name : {"state", "lower", "upper", "time", "part"}) out += ',' + (way.contains(name) ? csv_word(way[name]) : std::string());
    }
    out += '\n';
  }
  return out;
}
