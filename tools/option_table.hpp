// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every option of `query`, `run`, `plan` and `self`, what each needs, and what becomes of two that are given together.
// A test goes through all pairs.

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

/// What an option is.
enum class option_is {
  file,      // what is asked about: a file or a folder
  scene,     // another word about robot, joints, clouds
  course,    // how: no answer depends on it
  question,  // has an answer of its own, or changes another's
  doubt      // says what is uncertain
};

struct declared_option {
  std::string_view name;
  option_is is;
};

inline constexpr declared_option option_table[] = {
    {"--robot", option_is::file},
    {"--ignore-limits", option_is::scene},
    {"--geometry", option_is::scene},
    {"--strict", option_is::scene},
    {"--package", option_is::file},
    {"--gltf-up", option_is::scene},
    {"--mesh-limit", option_is::scene},
    {"--base-pose", option_is::scene},
    {"--joints", option_is::scene},
    {"--joint", option_is::scene},
    {"--cloud", option_is::file},
    {"--camera-pose", option_is::scene},
    {"--camera-link", option_is::scene},
    {"--intrinsics", option_is::scene},
    {"--depth-scale", option_is::scene},
    {"--cloud-scale", option_is::scene},
    {"--range", option_is::scene},
    {"--unfold-limit", option_is::scene},
    {"--use-viewpoint", option_is::scene},
    {"--crop", option_is::scene},
    {"--crop-out", option_is::scene},
    {"--height", option_is::scene},
    {"--plane", option_is::scene},
    {"--zero-is-missing", option_is::scene},
    {"--model", option_is::scene},
    {"--spheres", option_is::scene},
    {"--packing", option_is::file},
    {"--exclude-link", option_is::scene},
    {"--attach", option_is::file},
    {"--attach-pose", option_is::scene},
    {"--frames", option_is::file},
    {"--trajectory", option_is::file},
    {"--stamps", option_is::file},
    {"--max-age", option_is::scene},
    {"--configurations", option_is::file},
    {"--srdf", option_is::file},
    {"--allow", option_is::scene},
    {"--help", option_is::course},
    {"--threads", option_is::course},
    {"--backend", option_is::course},
    {"--volume", option_is::course},
    {"--no-cache", option_is::course},
    {"--cache", option_is::course},
    {"--fields", option_is::course},
    {"--cells", option_is::course},
    {"--json", option_is::course},
    {"--csv", option_is::course},
    {"--report", option_is::course},
    {"--scene", option_is::course},
    {"--svg", option_is::course},
    {"--shard", option_is::course},
    {"--check", option_is::question},
    {"--zones", option_is::question},
    {"--min-points", option_is::question},
    {"--distances", option_is::question},
    {"--signed", option_is::question},
    {"--nearest", option_is::question},
    {"--d-max", option_is::question},
    {"--self-filter", option_is::question},
    {"--unseen", option_is::question},
    {"--min-support", option_is::question},
    {"--gradient", option_is::question},
    {"--support-limit", option_is::question},
    {"--deadline", option_is::question},
    {"--merge", option_is::question},
    {"--plan", option_is::question},
    {"--between", option_is::question},
    {"--sensor", option_is::doubt},
    {"--calibration", option_is::doubt},
    {"--delay", option_is::doubt},
    {"--max-speed", option_is::doubt},
    {"--plan-time", option_is::doubt},
    {"--joint-error", option_is::doubt},
    {"--joint-speed", option_is::doubt},
};

/// What becomes of two options. Two without a rule are apart: neither changes what the other's answer says.
enum class meeting {
  changes,  // one is in what the other's answer says
  noted,    // the second is not in what the first says, and a note says so
  refused
};

struct meeting_rule {
  std::string_view first, second;  // a name, or `doubts`
  meeting how;
  const char* why = "";
  std::string_view beside = {};  // only if that is given, too
};

inline constexpr std::string_view doubts = "doubts";  // any option_is::doubt

inline constexpr meeting_rule meeting_rules[] = {
    // C++ refuses uncertain clouds for these three.
    {"--self-filter", doubts, meeting::refused,
     "a point that is certainly the robot's own as measured may be an obstacle's where it may really be"},
    {"--nearest", doubts, meeting::refused,
     "its lower ends are about what was measured; what is certain of each link stands in the answer without it"},
    {"--min-support", doubts, meeting::refused, "which points confirm one another is asked of what was measured"},
    {"--distances", doubts, meeting::noted, "it writes the distances that were measured"},
    {"--gradient", doubts, meeting::noted, "it is that of the distance that was measured"},
    {"--deadline", "--zones", meeting::refused, "it is for the least distance alone"},
    {"--deadline", "--distances", meeting::refused, "it is for the least distance alone"},
    {"--deadline", "--self-filter", meeting::refused, "it is for the least distance alone"},
    {"--deadline", "--min-support", meeting::refused, "it is for the least distance alone"},
    {"--deadline", "--unseen", meeting::refused, "it is for the least distance alone"},
    {"--deadline", "--nearest", meeting::refused, "it is for the least distance alone"},
    {"--deadline", "--gradient", meeting::refused, "it is for the least distance alone"},
    {"--deadline", doubts, meeting::refused, "it is for the least distance alone"},
    {"--shard", "--min-support", meeting::refused, "points of different ranks may confirm one another"},
    {"--shard", "--unseen", meeting::refused, "what one camera hides another may see"},
    {"--shard", "--deadline", meeting::refused, "ranks wait for one another"},
    {"--shard", doubts, meeting::refused, "ranks join only what was measured"},
    {"--merge", "--self-filter", meeting::refused, "the robot was elsewhere when the other frames were seen"},
    {"--merge", "--unseen", meeting::refused, "a merged cloud does not say what was hidden"},
    {"--merge", doubts, meeting::refused, "a merged cloud does not say what a point was seen from"},
    {"--between", "--attach", meeting::refused, "how what is held moves is not bounded yet"},
    {"--plan", "--unseen", meeting::refused, "the plan may lead into the room that the robot itself hides now",
     "--self-filter"},

    {"--check", doubts, meeting::changes},
    {doubts, doubts, meeting::changes},
    {"--zones", doubts, meeting::changes},
    {"--min-points", doubts, meeting::changes},
    {"--unseen", doubts, meeting::changes},
    {"--between", doubts, meeting::changes},
    {"--plan", doubts, meeting::changes},
    {"--self-filter", "--check", meeting::changes},
    {"--self-filter", "--zones", meeting::changes},
    {"--self-filter", "--min-points", meeting::changes},
    {"--self-filter", "--distances", meeting::changes},
    {"--self-filter", "--signed", meeting::changes},
    {"--self-filter", "--nearest", meeting::changes},
    {"--self-filter", "--d-max", meeting::changes},
    {"--self-filter", "--unseen", meeting::changes},
    {"--self-filter", "--min-support", meeting::changes},
    {"--self-filter", "--support-limit", meeting::changes},
    {"--self-filter", "--gradient", meeting::changes},
    {"--self-filter", "--plan", meeting::changes},
    {"--check", "--unseen", meeting::changes},
    {"--check", "--min-support", meeting::changes},
    {"--check", "--support-limit", meeting::changes},
    {"--check", "--between", meeting::changes},
    {"--check", "--plan", meeting::changes},
    {"--check", "--merge", meeting::changes},
    {"--min-points", "--zones", meeting::changes},
    {"--signed", "--distances", meeting::changes},
    {"--d-max", "--distances", meeting::changes},
    {"--d-max", "--signed", meeting::changes},
    {"--d-max", "--nearest", meeting::changes},
    {"--d-max", "--joint-error", meeting::changes},
    {"--d-max", "--joint-speed", meeting::changes},
    {"--support-limit", "--min-support", meeting::changes},
    {"--unseen", "--between", meeting::changes},
    {"--unseen", "--plan", meeting::changes},
    {"--merge", "--plan", meeting::changes},
};

/// An option that says nothing alone: one of `of` must be given, too; with `beside`, only where one of that is given.
struct need_rule {
  std::string_view option;
  std::array<std::string_view, 3> of;  // empty ones are none
  const char* why;                     // the sentence after the option's name
  std::array<std::string_view, 2> beside = {};
};

inline constexpr need_rule need_rules[] = {
    {"--max-age", {"--stamps"}, "is for --stamps"},
    {"--max-speed", {"--delay"}, "needs --delay, the time in which things move"},
    {"--max-speed",
     {"--plan-time"},
     "needs --plan-time, the time until the plan ends, in which things move, too",
     {"--plan", "--configurations"}},
    {"--plan-time", {"--plan", "--configurations"}, "is for --plan"},
    {"--plan-time", {"--max-speed"}, "needs --max-speed: what moves in that time?"},
    {"--joint-speed", {"--delay", "--stamps"}, "needs --delay, the time in which things move"},
    {"--delay", {"--max-speed", "--joint-speed"}, "needs --max-speed or --joint-speed: what moves in that time?"},
    {"--min-points", {"--zones"}, "is for --zones"},
    {"--signed", {"--distances"}, "is for --distances"},
    {"--cells", {"--distances"}, "is for --distances"},
    {"--support-limit", {"--min-support"}, "is for --min-support"},
    {"--fields", {"--plan", "--configurations"}, "is for --plan"},
    {"--csv", {"--frames", "--configurations"}, "is for --configurations"},
    {"--d-max", {"--distances", "--nearest", "--configurations"}, "is for --distances and --nearest"},
};

constexpr bool is_doubt(std::string_view name) {
  const auto* option = std::ranges::find(option_table, name, &declared_option::name);
  return option != std::end(option_table) && option->is == option_is::doubt;
}

/// Is the rule about these two, in either order?
constexpr bool is_about(const meeting_rule& rule, std::string_view a, std::string_view b) {
  const auto fits = [](std::string_view one, std::string_view name) {
    return one == name || (one == doubts && is_doubt(name));
  };
  return (fits(rule.first, a) && fits(rule.second, b)) || (fits(rule.first, b) && fits(rule.second, a));
}

/// The options that ranks must be given alike, each with its values, or none. Files are known by what is in them.
std::vector<std::pair<std::string, std::string>> given_alike(const CLI::App& app);

/// Throws usage_error if an option is given without what it needs, or two that refuse each other. Returns the notes
/// about the others.
std::vector<std::string> check_together(const CLI::App& app);
