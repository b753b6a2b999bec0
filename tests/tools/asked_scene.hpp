// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A scene in which every option of `query`, `run` and `plan` that changes an answer does so, and what answers say
// about each option.

#include "../../tools/option_table.hpp"

#include "tools/small_png.hpp"
#include "tools/two_boxes.hpp"

#include <fstream>
#include <iterator>
#include <map>

namespace testing {

using nlohmann::json;

using option_set = std::map<std::string, std::string>;  // with their values

/// A robot before a camera that sees two pixels: what is before the robot, or the robot and something before it.
struct asked_scene {
  scratch_file urdf{".urdf", moving_boxes_text}, far{".png", png(1000, 1200)}, own{".png", png(1900, 1000)};
  scratch_file rows{".csv", "turn,slide\n0,0.2\n0,0\n"}, still{".csv", "turn,slide\n0,0\n"}, ply{".ply"};
  scratch_file both{".txt", far.path + '\n' + own.path + '\n'}, fars{".txt", far.path + '\n'};
  std::string robot = " --backend host --model triangles --robot " + urdf.path +
                      " --camera-pose=-2,0,0,-0.5,0.5,-0.5,0.5 --intrinsics 100,100,0.5,0";

  std::vector<std::string> asks(const std::string& command) const {
    if (command == "query")
      return {"query --json" + robot + " --cloud " + far.path, "query --json" + robot + " --cloud " + own.path};
    if (command == "plan")
      return {"plan --configurations " + rows.path + robot + " --cloud " + far.path,
              "plan --configurations " + rows.path + robot + " --cloud " + own.path};
    std::vector<std::string> all;
    for (const scratch_file* list : {&fars, &both})
      all.push_back("run --trajectory " + still.path + robot + " --frames " + list->path);
    return all;
  }

  /// Has the command this option?
  bool has(const std::string& command, const std::string& name) const {
    static std::map<std::string, std::string> helps;
    std::string& help = helps[command];
    if (help.empty()) help = run_command(command + " --help").out;
    return help.find("  " + name + " ") != help.npos || help.find("  " + name + "\n") != help.npos;
  }

  /// The option, and those without which it is refused.
  option_set with(const std::string& name, const std::string& command) const {
    static const std::map<std::string, option_set> usual = {
        {"--check", {{"--check", "0.65"}}},
        {"--zones", {{"--zones", "0.65"}}},
        {"--min-points", {{"--zones", "0.65"}, {"--min-points", "2"}}},
        {"--distances", {{"--distances", ""}}},
        {"--signed", {{"--distances", ""}, {"--signed", ""}}},
        {"--nearest", {{"--nearest", "2"}}},
        {"--d-max", {{"--distances", ""}, {"--d-max", "0.75"}}},
        {"--self-filter", {{"--self-filter", "0.05"}}},
        {"--unseen", {{"--unseen", "0.1:1.5"}}},
        {"--min-support", {{"--min-support", "2@0.5"}}},
        {"--support-limit", {{"--min-support", "2@0.5"}, {"--support-limit", "1"}}},
        {"--gradient", {{"--gradient", ""}}},
        {"--deadline", {{"--deadline", "1000"}}},
        {"--merge", {{"--merge", ""}}},
        {"--plan", {{"--plan", ""}}},
        {"--between", {{"--between", ""}}},
        {"--sensor", {{"--sensor", "lidar:0.05,0"}}},
        {"--calibration", {{"--calibration", "0.1,0"}}},
        {"--delay", {{"--delay", "0.1"}, {"--max-speed", "1.5"}}},
        {"--max-speed", {{"--delay", "0.1"}, {"--max-speed", "1.5"}}},
        {"--plan-time", {{"--delay", "0.1"}, {"--max-speed", "1.5"}, {"--plan-time", "0.2"}, {"--plan", ""}}},
        {"--joint-error", {{"--joint-error", "0.2,0"}}},
        {"--joint-speed", {{"--delay", "0.1"}, {"--joint-speed", "2,0"}}},
    };
    option_set all = usual.at(name);
    if (command == "plan") all.erase("--distances"), all.erase("--plan");
    return all;
  }

  std::string words(option_set all, const std::string& command) const {
    if ((command == "plan" || all.contains("--plan")) && all.contains("--max-speed")) all.emplace("--plan-time", "0.2");
    std::string line;
    for (const auto& [name, value] : all) {
      const std::string given = name == "--distances" ? ply.path : name == "--plan" ? rows.path : value;
      line += ' ' + name + (given.empty() ? "" : ' ' + given);
    }
    return line;
  }
};

/// What an answer says about an option.
inline json said_about(const std::string& name, const std::string& command, const outcome& o, const asked_scene& s) {
  std::vector<json> all = command == "query" ? std::vector{json::parse(o.out)} : lines(o);
  json said = json::array();
  const auto take = [&](const json& from, const char* key) {
    if (!from.contains(key)) return;
    json its = from.at(key);
    if (its.is_object()) its.erase("latency_us");
    said.push_back(its);
  };
  const auto of_parts = [&](const json& line, const char* key) {
    take(line, key);
    if (line.contains("parts"))
      for (const json& part : line.at("parts")) take(part, key);
  };
  const auto key_of = [&]() -> const char* {
    if (is_doubt(name)) return "certain";
    if (name == "--min-points" || name == "--zones") return "zones";
    if (name == "--min-support" || name == "--support-limit") return "support";
    if (name == "--signed" || name == "--distances") return "distances";
    if (name == "--d-max") return command == "plan" ? "distance" : "distances";
    if (name == "--self-filter") return "filter";
    if (name == "--between") return "way";
    for (const char* key : {"nearest", "unseen", "gradient", "deadline", "plan"})
      if (name == std::string("--") + key) return key;
    return nullptr;
  };
  for (const json& line : all) {
    if (name == "--check") command == "run" ? take(line, "distance") : take(line, "check");
    if (const char* key = key_of()) of_parts(line, key);
    if (command == "plan" && line.contains("plan"))
      for (const char* key : {"certain", "unseen", "ways"})
        if (key == std::string(name == "--between" ? "ways" : is_doubt(name) ? "certain" : name.substr(2)))
          take(line.at("plan"), key);
  }
  if (name == "--check" && command != "query") said.push_back(o.code);
  if (said.dump().find("\"file\"") != std::string::npos) {
    std::ifstream in(s.ply.path, std::ios::binary);
    std::string bytes(std::istreambuf_iterator<char>(in), {});
    said.push_back(std::hash<std::string>{}(bytes));
  }
  return said;
}

inline std::vector<std::string> options_of(const std::string& command) {
  std::istringstream help(run_command(command + " --help").out);
  std::vector<std::string> names;
  for (std::string line, name; std::getline(help, line);)
    if (std::istringstream words(line); words >> name && line.starts_with("  ") && name.starts_with("--"))
      names.push_back(name.substr(0, name.find(',')));
  return names;
}

inline bool is_question(const std::string& name) {
  const auto* its = std::ranges::find(option_table, name, &declared_option::name);
  return its->is == option_is::question || its->is == option_is::doubt;
}

/// The rules of one kind about options that are all given.
inline std::vector<meeting_rule> rules_about(const option_set& given, meeting how) {
  std::vector<meeting_rule> found;
  for (const meeting_rule& rule : meeting_rules) {
    if (rule.how != how || (!rule.beside.empty() && !given.contains(std::string(rule.beside)))) continue;
    for (const auto& [a, value] : given)
      for (const auto& [b, other] : given)
        if (a < b && is_about(rule, a, b)) found.push_back(rule);
  }
  return found;
}

}  // namespace testing
