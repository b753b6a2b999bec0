// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The table of combinations: every question with every kind of clouds, form and backend, as the declarations say; and
// what the command and the Python package register.

#include "combinations/questions.hpp"
#include "support/places.hpp"

#include <clearance/motion_clearance.hpp>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace combinations {

/// What the declarations see of backends that need nvcc, or MPI. The test on a device compares them with the real ones.
struct as_device {
  using own_scan = void;
};
struct as_devices {
  using own_scan = void;
  using several = void;
};
struct as_ranks {
  using several = void;
  int comm;
};

/// One cell. `why`: the sentence that refuses it, or null.
struct cell {
  std::string question, poses, clouds, form, backend;
  const char* why;
};

template <class Q>
constexpr bool takes_radii = requires(Q q) { q.radii.clear(); } || requires(Q q) { q.parts.clear(); };

/// Adds the cells of a question; `way`: the same of a way between two poses, which is asked once, not by ranks.
template <class Q>
void add_cells(std::vector<cell>& all, const char* question, bool way = false) {
  const char* const poses = way ? "a way" : clearance::planning_question<Q> ? "many" : "one";
  const auto of_clouds = [&]<class Clouds>(const std::string& clouds, std::type_identity<Clouds>) {
    const auto on = [&]<class On>(const char* backend, std::type_identity<On>) {
      const auto add = [&](const char* form, const char* why) {
        all.push_back({question, poses, clouds, form, backend, why});
      };
      using clearance::why_not;
      if (way && backend == std::string("ranks")) return;
      add("once", why_not<Q, Clouds, form::once, On>());
      if (way) return;
      add("enqueued", why_not<Q, Clouds, form::enqueued, On>());
      add("in chunks", why_not<Q, Clouds, form::in_chunks, On>());
      add("by a deadline", why_not<Q, Clouds, form::by_deadline, On>());
    };
    on("host", std::type_identity<clearance::host>());
    on("device", std::type_identity<as_device>());
    on("devices", std::type_identity<as_devices>());
    on("ranks", std::type_identity<as_ranks>());
  };
  for_each_kind(all_kinds(), [&]<class S>() { of_clouds(name_of<S>, std::type_identity<S>()); });
  of_clouds("several clouds", std::type_identity<std::vector<placed<points>>>());
  of_clouds("several images", std::type_identity<std::tuple<placed<image>, placed<image>>>());
}

inline std::vector<cell> all_cells() {
  std::vector<cell> all;
  for_each_question_type([&]<class Q>(const char* name) { add_cells<Q>(all, name); });
  add_cells<clearance::min_distance_per_part>(all, "motion_clearance", true);
  return all;
}

/// The table as data.
inline std::string json_of(const std::vector<cell>& cells) {
  std::string text = "[\n";
  for (const cell& c : cells)
    text += std::string(&c == cells.data() ? "" : ",\n") + "  {\"question\": \"" + c.question + "\", \"poses\": \"" +
            c.poses + "\", \"clouds\": \"" + c.clouds + "\", \"form\": \"" + c.form + "\", \"backend\": \"" +
            c.backend +
            "\", \"asked\": " + (c.why == nullptr ? "true" : "false, \"why\": \"" + std::string(c.why) + "\"") + "}";
  return text + "\n]\n";
}

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}
/// All matches of a pattern's first group.
inline std::set<std::string> found_in(const std::string& text, const std::string& pattern) {
  std::set<std::string> all;
  const std::regex its(pattern);
  for (std::sregex_iterator at(text.begin(), text.end(), its), end; at != end; ++at) all.insert((*at)[1]);
  return all;
}
/// The text from one line to another.
inline std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from), end = begin == text.npos ? begin : text.find(to, begin + from.size());
  return begin == text.npos || end == text.npos ? "" : text.substr(begin + from.size(), end - begin - from.size());
}

/// The questions that headers declare: structs with a `result`, in questions/ and beside it.
inline std::set<std::string> declared_questions() {
  std::set<std::string> all;
  const std::filesystem::path include = testing::checkout("include/clearance");
  for (const auto& folder : {include / "questions", include}) {
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
      if (file.path().extension() != ".hpp") continue;
      std::istringstream lines(text_of(file.path()));
      std::string last;
      for (std::string line; std::getline(lines, line);) {
        std::smatch of;
        if (std::regex_search(line, of, std::regex("^struct (\\w+)"))) last = of[1];
        if (line.starts_with("  using result = ")) all.insert(last);
      }
    }
  }
  return all;
}

/// What else offers questions: which, and which of them about uncertain clouds.
struct offers {
  std::set<std::string> questions, uncertain;

  /// `more`: the library takes uncertain clouds, too.
  std::string say(const std::string& question, bool more) const {
    return !questions.contains(question) ? "no" : !more || uncertain.contains(question) ? "yes" : "measured";
  }
};
/// The Python package has every question that is no template (python/declarations.py), and a function of that name.
inline offers python_offers() {
  offers all{declared_questions(), {}};
  all.questions.erase("collect");
  all.questions.insert("motion_clearance");
  const std::string text = text_of(testing::checkout("python/src/asker.hpp"));
  all.uncertain = found_in(between(text, "requires one_of<Q,", ">"), "clearance::(\\w+)");
  return all;
}
/// The command lists its questions among the units of its CMake file, and says in questions/asked.hpp what their clouds
/// are.
inline offers command_offers() {
  offers all;
  const std::string list = text_of(testing::checkout("tools/CMakeLists.txt"));
  all.questions = found_in(between(list, "foreach(unit ", ")"), "(\\w+)");
  for (const char* unit : {"middle", "ways", "demo"}) all.questions.erase(unit);
  std::istringstream lines(text_of(testing::checkout("tools/questions/asked.hpp")));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("  requires std::same_as<Q,")) all.uncertain.merge(found_in(line, "clearance::(\\w+)"));
  all.questions.insert("motion_clearance"), all.uncertain.insert("motion_clearance");  // by its own option, --between
  return all;
}

/// The table of docs/choosing.md.
inline std::string page_of(const std::vector<cell>& cells) {
  const offers python = python_offers(), command = command_offers();
  const auto asked = [&](const std::string& question, const std::string& clouds, const std::string& form,
                         const std::string& backend) {
    for (const cell& c : cells)
      if (c.question == question && c.clouds == clouds && c.form == form && c.backend == backend)
        return c.why == nullptr;
    return false;
  };
  std::string table =
      "| question | clouds | `.radii` | enqueued | pieces | deadline | Python | command |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  const auto row = [&](const std::string& name, bool radii) {
    const auto takes = [&](const char* clouds) { return asked(name, clouds, "once", "host"); };
    const bool images = !takes("points"), uncertain = takes(images ? "uncertain image" : "balls");
    const std::string clouds = images                 ? (uncertain ? "images, uncertain" : "images")
                               : takes("hidden room") ? "rooms"
                               : uncertain            ? "balls"
                                                      : "points";
    const std::string bare = images ? "image" : "points";
    const auto word = [](bool has) { return has ? "yes" : "no"; };
    const auto& first = *std::find_if(cells.begin(), cells.end(), [&](const cell& c) { return c.question == name; });
    const bool on_host = asked(name, bare, "enqueued", "host"), on_device = asked(name, bare, "enqueued", "device");
    const bool pieces = asked(name, bare, "in chunks", "host") && asked(name, bare, "once", "ranks");
    const bool way = first.poses == "a way";
    table += "| `" + name + "` | " + clouds + " | " + word(radii) + " | " +
             (on_host     ? "yes"
              : on_device ? "placed"
                          : "no") +
             " | " +
             (pieces                                        ? "yes"
              : way && asked(name, bare, "once", "devices") ? "GPUs"
                                                            : "no") +
             " | " + word(asked(name, bare, "by a deadline", "host")) + " | " + python.say(name, uncertain) + " | " +
             command.say(name, uncertain) + " |\n";
  };
  for_each_question_type([&]<class Q>(const char* name) { row(name, takes_radii<Q>); });
  row("motion_clearance", true);
  return table;
}

}  // namespace combinations
