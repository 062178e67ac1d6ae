// SPDX-License-Identifier: Apache-2.0
// Shared by the tests of the command line: a fresh folder in which the program runs, and the form of a refusal.
#pragma once

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "child_process.hpp"
#include "temporary_folder.hpp"

namespace palpate {

using Words = std::vector<std::string>;

inline Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// A short run without a picture: 300 ticks.
inline Words quickTouch(const std::string& volume, const Words& more = {}) {
  return Words{"touch", volume, "--seconds", "0.3", "--clock", "simulated", "--picture", "off", "--out", "out"} + more;
}

// The same along a path file, which gives the length of the run.
inline Words quickTouchAlong(const std::string& path, const std::string& volume, const Words& more = {}) {
  return Words{"touch", volume, "--path", path, "--clock", "simulated", "--picture", "off", "--out", "out"} + more;
}

// The lines of stderr without those of progress ("loading x ...").
inline Words errorLines(const std::string& err) {
  Words lines;
  std::istringstream in(err);
  for (std::string line; std::getline(in, line);) {
    if (!line.ends_with(" ...")) lines.push_back(line);
  }
  return lines;
}

class ProgramTest : public testing::Test {
 protected:
  [[nodiscard]] Outcome run(const Words& arguments) const {
    return runPalpate({.arguments = arguments, .folder = folder()});
  }

  [[nodiscard]] std::filesystem::path folder() const { return folder_.path(); }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder() / name; }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(file(name), std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  [[nodiscard]] bool exists(const std::string& name) const { return std::filesystem::exists(file(name)); }

 private:
  TemporaryFolder folder_;
};

// A warning before the first tick: what was asked for is done, but a bound lies below it.
inline bool isBoundWarning(const std::string& line) {
  return line.find(" is more than this device can render ") != std::string::npos ||
         line.starts_with("palpate: a plane is kept for ");
}

// A warning of a brush of few voxels, as quick tests have them: what was asked for is done.
inline bool isBrushWarning(const std::string& line) {
  return line.find(", since the surface between voxels is flatter ") != std::string::npos;
}

// Nothing on standard error but progress and warnings of bounds and brushes.
inline void expectSuccess(const Outcome& outcome) {
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  Words lines = errorLines(outcome.err);
  std::erase_if(lines, [](const std::string& line) { return isBoundWarning(line) || isBrushWarning(line); });
  EXPECT_THAT(lines, testing::IsEmpty());
}

// One line "palpate: ...", with the input, the reason and, behind a semicolon, a remedy; a brush may be warned of
// before.
inline void expectRefusal(const Outcome& outcome, const std::string& input, const std::string& reason, int status) {
  EXPECT_FALSE(outcome.timed_out);
  EXPECT_EQ(outcome.status, status) << "signal " << outcome.signal << "\n" << outcome.err;
  Words lines = errorLines(outcome.err);
  std::erase_if(lines, isBrushWarning);
  ASSERT_EQ(lines.size(), 1U) << outcome.err;
  EXPECT_THAT(lines[0], testing::StartsWith("palpate: "));
  EXPECT_THAT(lines[0], testing::HasSubstr(input));
  EXPECT_THAT(lines[0], testing::HasSubstr(reason));
  EXPECT_THAT(lines[0], testing::ContainsRegex("; .{8,}$")) << "no remedy";
  EXPECT_THAT(lines[0], testing::Not(testing::HasSubstr("unexpected"))) << "an error that nobody thought of";
}

}  // namespace palpate
