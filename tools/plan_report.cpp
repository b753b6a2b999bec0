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

}  // namespace

std::optional<std::size_t> plan_report::first_below() const {
  const std::size_t first = blind() ? 0 : found.first_below(*asked->margin);
  return first < found.of.size() ? std::optional(first) : std::nullopt;
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
  return out;
}

std::string to_json(const plan_report& report) {
  std::string out;
  for (std::size_t k = 0; k < report.found.of.size(); ++k) {
    const min_distance_result& r = report.found.of[k];
    json row = {{"row", k}};
    row.update(witness(r, cloud_of(report, r), r.point, *report.bodies));
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
  std::string out = "row,state,distance,lower,upper,cloud,point,part,primitive,point_x,point_y,point_z,nearest_x,nearest_y,nearest_z\n";
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
    out += '\n';
  }
  return out;
}
