// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Runs the built command as a user would.

#include "io/scratch_file.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <nlohmann/json.hpp>

#include <sys/wait.h>
#include <algorithm>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

struct outcome {
  int code;
  std::string out, err;
};

/// `arguments` in a shell's words. The user's cache is left alone: there is none, or the folder given. `before`: shell
/// commands that come first, such as a ulimit.
inline outcome run_command(const std::string& arguments, const std::string& cache = {},
                           const std::string& before = {}) {
  const scratch_file err(".txt");
  FILE* pipe = ::popen(
      (before + "CLEARANCE_CACHE='" + cache + "' \"" + testing::command() + "\" " + arguments + " 2>" + err.path)
          .c_str(),
      "r");
  REQUIRE(pipe);
  outcome o;
  char piece[4096];
  for (std::size_t n; (n = std::fread(piece, 1, sizeof piece, pipe)) > 0;) o.out.append(piece, n);
  const int status = ::pclose(pipe);
  o.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  std::ifstream in(err.path);
  o.err.assign(std::istreambuf_iterator<char>(in), {});
  return o;
}

/// Exit code 1 and one line on stderr that says so; nothing on stdout.
inline void refuses(const std::string& arguments, const std::string& sentence) {
  const outcome o = run_command(arguments);
  INFO("clearance " << arguments << " said: " << o.err);
  CHECK(o.code == 1);
  CHECK(o.out.empty());
  CHECK(o.err.find(sentence) != std::string::npos);
  CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
}

inline nlohmann::json parsed(const outcome& o) {
  INFO(o.err);
  INFO(o.out);
  REQUIRE(!o.out.empty());
  return nlohmann::json::parse(o.out);
}

/// Those of an answer that has one on each line.
inline std::vector<nlohmann::json> lines(const outcome& o) {
  INFO(o.err);
  std::vector<nlohmann::json> all;
  std::istringstream in(o.out);
  for (std::string line; std::getline(in, line);) all.push_back(nlohmann::json::parse(line));
  return all;
}
