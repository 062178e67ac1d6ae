// SPDX-License-Identifier: Apache-2.0
// What is expected here is set by hand.
#include "apps/console/document.hpp"

#include <cstdlib>
#include <sstream>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>

#include "apps/console/message.hpp"
#include "in_child.hpp"

namespace palpate {
namespace document_test {

TEST(AlignedTables, HaveColumnsAndNoBars) {
  EXPECT_EQ(
      alignedTables("# Keys\n\nText | with `a` bar.\n\n"
                    "| key | takes | default |\n|---|---:|---|\n| `n` | 10 | |\n| `rate_hz` | 9 | 1000 |\n\nEnd.\n",
                    80),
      "# Keys\n\nText | with `a` bar.\n\n"
      "key      takes  default\n"
      "-------  -----  -------\n"
      "n           10\n"
      "rate_hz      9  1000\n"
      "\nEnd.\n");
}

// 4 + 2 + 11 columns; into 12 go 4 + 2 + 6, and "object" is as wide.
TEST(AlignedTables, AreWrappedWhereTheTerminalIsNarrower) {
  const std::string table = "| name | what it is |\n|---|---|\n| ball | round object |\n";
  EXPECT_EQ(alignedTables(table, 18), "name  what it is\n----  ------------\nball  round object\n");
  EXPECT_EQ(alignedTables(table, 17), "name  what it is\n----  -----------\nball  round\n      object\n");
  const std::string narrow = "name  what\n      it is\n----  ------\nball  round\n      object\n";
  EXPECT_EQ(alignedTables(table, 12), narrow);
  EXPECT_EQ(alignedTables(table, 1), narrow);  // no word is cut
}

// 1 + 2 + 2 + 2 + 9 columns: two gaps.
TEST(AlignedTables, OfThreeColumnsHaveTwoGaps) {
  const std::string table = "| a | bb | cccc dddd |\n|---|---|---|\n";
  EXPECT_EQ(alignedTables(table, 16), "a  bb  cccc dddd\n-  --  ---------\n");
  EXPECT_EQ(alignedTables(table, 15), "a  bb  cccc\n       dddd\n-  --  --------\n");
}

// "µ" is two bytes and one column.
TEST(AlignedTables, CountCharactersAndKeepBarsThatAreEscaped) {
  EXPECT_EQ(alignedTables("| \xc2\xb5m | a \\| b |\n|---|---|\n| 1 | 2 |\n", 80),
            "\xc2\xb5m  a | b\n--  -----\n1   2\n");
}

// Rows may have fewer cells than the heading, and more.
TEST(AlignedTables, TakeRowsOfAnyLength) {
  EXPECT_EQ(alignedTables("| a | b |\n|---|---|\n| 1 |\n| 1 | 2 | 3 |\n", 80), "a  b\n-  -  -\n1\n1  2  3\n");
}

TEST(AlignedTables, LeaveWhatIsNoTable) {
  for (const std::string text : {"", "no end", "| a bar\n| and another\n", "| a |\n", "\n\n", "a\n|---|\n"})
    EXPECT_EQ(alignedTables(text, 10), text);
}

constexpr const char* kDocument = "| a | bb |\n|---|---|\n| `111` | 2 |\n";

// What a child prints that has a terminal of 40 columns for its standard output.
std::string printedOnATerminal() {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0) return "no terminal";
  const std::string name = ptsname(terminal);
  std::string text;
  const Ended ended = inChild([&] {
    const int screen = open(name.c_str(), O_RDWR | O_NOCTTY);
    const winsize size{25, 40, 0, 0};
    ioctl(screen, TIOCSWINSZ, &size);
    dup2(screen, STDOUT_FILENO);
    printDocument(kDocument);
    static_cast<void>(resultError());  // flushes
    // Read before the last descriptor of the terminal is closed, which may drop what it holds.
    pollfd ready{terminal, POLLIN, 0};
    std::string seen;
    while (seen.find("2\r\n") == std::string::npos && poll(&ready, 1, 10'000) == 1) {
      char byte = 0;
      if (read(terminal, &byte, 1) != 1) break;
      seen += byte;
    }
    dprintf(STDERR_FILENO, "%s", seen.c_str());
  });
  close(terminal);
  for (const char c : ended.err) text += c == '\r' ? "" : std::string(1, c);
  return text;
}

TEST(Documents, AreAlignedOnATerminal) {
  EXPECT_EQ(printedOnATerminal(), "a    bb\n---  --\n111  2\n");
}

// As in `palpate scene > docs/scene.md`.
TEST(Documents, StayPagesInAFile) {
  const Ended ended = inChild([] {
    dup2(STDERR_FILENO, STDOUT_FILENO);  // a pipe
    printDocument(kDocument);
    static_cast<void>(resultError());
  });
  EXPECT_EQ(ended.err, kDocument);
}

}  // namespace document_test
}  // namespace palpate
