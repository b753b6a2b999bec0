// SPDX-License-Identifier: BSD-3-Clause
// Tables as people's programs write them are read, and what is said about them is whole and short.
#include "tools/two_boxes.hpp"

namespace csv_test {

using namespace testing;

namespace {

std::string utf16(const std::string& text, bool highest_first) {
  std::string bytes = highest_first ? "\xfe\xff" : "\xff\xfe";
  for (const char c : text) bytes += highest_first ? std::string{'\0', c} : std::string{c, '\0'};
  return bytes;
}

/// How many digits stand side by side, at most.
std::size_t most_digits(const std::string& text) {
  std::size_t most = 0, now = 0;
  for (const char c : text) most = std::max(most, now = c >= '0' && c <= '9' ? now + 1 : 0);
  return most;
}

}  // namespace

TEST_CASE("A table of joints may be in UTF-16, and its words in quotes") {
  const moving_boxes m;
  const scratch_file list(".txt", m.cloud.path + '\n');
  const std::string plain = "turn,slide\n0,0.1\n";
  const scratch_file usual(".csv", plain);
  const auto plan = [&](const std::string& rows) {
    return lines(run_command("plan --cloud " + m.cloud.path + m.robot + " --configurations " + rows))[0];
  };
  const auto run = [&](const std::string& rows) {
    return lines(run_command("run --frames " + list.path + m.robot + " --trajectory " + rows))[0].at("distance");
  };
  for (const std::string& text :
       {utf16(plain, false), utf16(plain, true), "\xef\xbb\xbf" + plain, std::string("\"turn\",\"slide\"\n0,0.1\n"),
        std::string(" \"turn\" , \"slide\"\r\n\"0\",\"0.1\"\r\n")}) {
    const scratch_file rows(".csv", text);
    CHECK(plan(rows.path) == plan(usual.path));
    CHECK(run(rows.path) == run(usual.path));
  }
  const scratch_file frames(".txt", utf16(m.cloud.path + '\n', false));
  CHECK(run_command("run --frames " + frames.path + m.robot + " --trajectory " + usual.path).code == 0);
}

TEST_CASE("A sentence about a table is whole, whatever is in it") {
  const moving_boxes m;
  for (const std::string& text :
       {std::string("turn,sl\0ide\n0,0\n", 16), std::string("turn,slide\n0,0\0 1\n", 18), std::string("\0\0", 2),
        utf16("turn,nowhere\n0,0\n", false), utf16("turn,slide\n0,0\n", false).substr(2),
        std::string("turn,slide\n0,\0,0\n", 17)}) {
    const scratch_file rows(".csv", text);
    const outcome o = run_command("plan --cloud " + m.cloud.path + m.robot + " --configurations " + rows.path);
    INFO(o.err);
    CHECK(o.code == 1);
    CHECK(std::ranges::count(o.err, '\n') == 1);
    CHECK(o.err.find(rows.path) != o.err.npos);
    CHECK(std::ranges::count(o.err, '"') % 2 == 0);  // no quoted word is cut
    CHECK(o.err.find('\0') == o.err.npos);
    CHECK(o.err.size() > rows.path.size() + 30);
  }
}

TEST_CASE("No number is printed with hundreds of digits, and no zero with a sign") {
  const two_boxes q;
  const std::string ask = "query --backend host --model triangles --robot " + q.urdf.path;
  for (const std::string& more :
       {std::string(" --base-pose 0,0,0,1e200,0,0,1"), std::string(" --camera-pose 1e200,0,0,0,0,0,1"),
        std::string(" --base-pose 1e300,0,0,0,0,0,1"), std::string(" --unseen 1:1e300"), std::string(" --zones 1e300"),
        std::string(" --self-filter 1e300"), std::string(" --nearest 2 --d-max 1e29")}) {
    const outcome o = run_command(ask + " --cloud " + q.cloud.path + more);
    INFO(more << ": " << o.err << o.out);
    CHECK(most_digits(o.err) <= 25);
    CHECK(most_digits(o.out) <= 25);
  }
  const scratch_file far(".xyz", "1e17 0 0\n"), nearly(".xyz", "0.3 -1e-9 -1e-9\n");
  CHECK(most_digits(run_command(ask + " --cloud " + far.path).out) <= 25);
  const std::string text = run_command(ask + " --cloud " + nearly.path).out;
  CHECK(text.find("point     0.300000 0.000000 0.000000\n") != text.npos);
  CHECK(text.find("-0.000000") == text.npos);
}

}  // namespace csv_test
