// SPDX-License-Identifier: BSD-3-Clause
#include "frame_report.hpp"

#include "report_csv.hpp"

using namespace clearance;

std::string to_json(const frame_report& report) {
  json out = {{"frame", report.frame}, {"file", report.file}};
  out.update(witness(report.found.result, report.cloud, report.point, *report.bodies));
  out["points"] = counts(report.found.result);
  out["upload_us"] = microseconds(report.upload);
  out["latency_us"] = microseconds(report.query);
  if (report.certain) out["certain"] = certain_of(*report.certain, {report.cloud}, *report.bodies);
  if (report.unseen) {
    json& unseen = out["unseen"] = unseen_of(*report.unseen);
    unseen["latency_us"] = microseconds(report.unseen_query);
    out["parts"] = json::array();
    for (std::size_t k = 0; k < report.bodies->size(); ++k)
      out["parts"].push_back({{"name", (*report.bodies)[k].name},
                              {"distance", or_null(report.found.parts[k].distance)},
                              {"unseen", unseen_of(*report.unseen, k)}});
  }
  if (report.plan) {
    json& plan = out["plan"] = outcome_of(*report.plan);
    plan["lower"] = json::array();
    for (const min_distance_result& r : report.plan->found.of)
      plan["lower"].push_back(r.state == state::no_data ? json(nullptr) : or_null(r.lower));
    plan["latency_us"] = microseconds(report.plan->query);
  }
  return json_text(out, -1);
}

std::string to_csv(const frame_report& report) {
  std::string out;
  if (report.frame == 0) {
    out = std::string("frame,file,") + witness_columns + ",latency_us";
    if (report.certain) out += ",certain_state,certain_lower,certain_upper";
    if (report.unseen) out += unseen_columns(*report.unseen);
    if (report.plan) out += report.plan->asked->margin ? ",plan_least,plan_at,plan_first_below" : ",plan_least,plan_at";
    out += '\n';
  }
  out += std::to_string(report.frame) + ',' + csv_word(report.file) + ',' +
         witness_cells(report.found.result, report.cloud, report.point, *report.bodies) + ',' +
         csv_word(microseconds(report.query));
  if (report.certain)
    out += std::string(",") + to_string(report.certain->state) + ',' + csv_word(or_null(report.certain->lower)) + ',' +
           csv_word(or_null(report.certain->upper), report.certain->upper);
  if (report.unseen) out += unseen_cells(*report.unseen, report.found.parts);
  if (report.plan)
    for (const auto plan = outcome_of(*report.plan); const char* const name : {"least", "at", "first_below"})
      if (plan.contains(name)) out += ',' + csv_word(plan[name]);
  return out + '\n';
}
