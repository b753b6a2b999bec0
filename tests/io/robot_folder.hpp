// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

/// A folder of small files that is deleted with the object.
struct robot_folder {
  std::filesystem::path path;

  robot_folder() {
    static int count = 0;
    path = std::filesystem::temp_directory_path() /
           ("clearance_robot_" + std::to_string(::getpid()) + "_" + std::to_string(++count));
    std::filesystem::create_directories(path);
  }
  robot_folder(const robot_folder&) = delete;
  robot_folder& operator=(const robot_folder&) = delete;
  ~robot_folder() { std::filesystem::remove_all(path); }

  std::filesystem::path put(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path / name).parent_path());
    std::ofstream(path / name, std::ios::binary) << text;
    return path / name;
  }
};

/// The sentence with which `act` refuses, of the kind expected; empty if it does not.
template <class Error = std::runtime_error, class Act>
std::string sentence(Act act) {
  try {
    act();
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

inline bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
