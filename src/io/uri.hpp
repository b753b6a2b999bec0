// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From a file's name as somebody wrote it to the file that is meant.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace clearance::io {

/// The text that a URI means: %20 is a blank. A % without two digits stands for itself.
inline std::string percent_decoded(std::string_view uri) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string made;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool coded = uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0;
    made += coded ? char(16 * digit(uri[i + 1]) + digit(uri[i + 2])) : uri[i];
    if (coded) i += 2;
  }
  return made;
}

/// The file that a written path means, below `folder` if it is relative: as it stands, else with its %20 as blanks,
/// else with its backslashes as slashes. The first of them that exists, or as it stands.
inline std::filesystem::path written_path(const std::filesystem::path& folder, const std::string& written) {
  std::error_code failed;
  std::string slashes = percent_decoded(written);
  for (char& c : slashes)
    if (c == '\\') c = '/';
  for (const std::string& meant : {written, percent_decoded(written), slashes})
    if (std::filesystem::exists(folder / meant, failed)) return folder / meant;
  return folder / written;
}

}  // namespace clearance::io
