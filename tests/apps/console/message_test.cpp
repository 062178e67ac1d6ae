// SPDX-License-Identifier: Apache-2.0
#include "apps/console/message.hpp"

#include <cerrno>
#include <sstream>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/console/progress.hpp"
#include "failing_memory.hpp"
#include "in_child.hpp"

namespace palpate {
namespace message_test {

TEST(Messages, AreALineThatNoNameCanBreak) {
  const Ended ended = inChild([] { tellUser("a\nb\033[2Kc.vdb: it is gone; look for it"); });
  EXPECT_EQ(ended.err, "palpate: a?b?[2Kc.vdb: it is gone; look for it\n");
}

// A result may have many lines and a table; a name in it cannot steer the terminal either.
TEST(Results, HaveNoControlCharactersButLinesAndTabs) {
  const Ended ended = inChild([] {
    dup2(STDERR_FILENO, STDOUT_FILENO);
    printText("a\033[2Kb\r.vdb\t1 mm\n\x7f\xc3\xa4\n");
    flushResults();
  });
  EXPECT_EQ(ended.err, "a?[2Kb?.vdb\t1 mm\n?\xc3\xa4\n");
}

// For programs: whatever a name holds, a line is one object, and progress says nothing between.
TEST(Messages, AreObjectsOfJsonWhereAsked) {
  const Ended ended = inChild([] {
    setMessageForm(MessageForm::kJson);
    Progress progress;
    progress.stage("loading");
    tellUser("a\"b\n\xff");
    progress.done();
    tellError("lost");
    setMessageForm(MessageForm::kText);
    tellUser("as before");
  });
  std::istringstream lines(ended.err);
  std::string line;
  std::getline(lines, line);
  const nlohmann::json first = nlohmann::json::parse(line);
  EXPECT_THAT(std::string(first["message"]), testing::StartsWith("a\"b?"));
  EXPECT_EQ(first["level"], "info");
  EXPECT_GT(first["pid"], 0);
  EXPECT_EQ(first["program"], program_invocation_short_name);
  EXPECT_THAT(std::string(first["time"]),
              testing::MatchesRegex("20[0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9:]+[.][0-9][0-9][0-9]Z"));
  std::getline(lines, line);
  const nlohmann::json second = nlohmann::json::parse(line);
  EXPECT_EQ(second["level"], "error");
  EXPECT_EQ(second["message"], "lost");
  std::getline(lines, line);
  EXPECT_EQ(line, "palpate: as before");
}

void giveStream(int stream, const char* name) {
  const int file = open(name, O_WRONLY);
  dup2(file, stream);
  close(file);
}

// Progress tells from its destructor too, where an exception would end the process.
TEST(Messages, ThatCannotBeWrittenAreNoReasonToEnd) {
  const Ended ended = inChild([] {
    giveStream(STDERR_FILENO, "/dev/full");
    tellUser("on a full disk");
    {
      Progress progress;
      progress.stage("loading");
      progress.fraction(0.5);
    }
    _exit(7);
  });
  EXPECT_EQ(ended.status, 7);
}

// As it is, where there is no memory to make a line of it.
TEST(Messages, AreToldWithoutMemoryToo) {
  const Ended ended = inChild([] {
    const std::string text(100, 'x');
    failing_memory::also_in_libraries = true;
    failing_memory::failAfter(1);
    tellUser(text);
  });
  EXPECT_EQ(ended.err, std::string(100, 'x'));
}

// A disk that was full has room again: what is told then is written.
TEST(Messages, AreTriedAgain) {
  const Ended ended = inChild([] {
    const int err = dup(STDERR_FILENO);
    giveStream(STDERR_FILENO, "/dev/full");
    tellUser("lost");
    dup2(err, STDERR_FILENO);
    tellUser("told");
  });
  EXPECT_EQ(ended.err, "palpate: told\n");
}

TEST(Results, ThatCannotBeWrittenAreRemembered) {
  for (const std::size_t size : {std::size_t{10}, std::size_t{1} << 20U}) {  // kept in the buffer, and not
    const Ended ended = inChild([&] {
      giveStream(STDOUT_FILENO, "/dev/full");
      printText(std::string(size, 'x'));
      printResult("{}\n", "more");
      _exit(resultError() == ENOSPC ? 0 : 1);
    });
    EXPECT_EQ(ended.status, 0) << size;
  }
}

TEST(Results, ThatWereWrittenAreNoError) {
  const Ended ended = inChild([] {
    giveStream(STDOUT_FILENO, "/dev/null");
    printResult("{} of {}\n", 1, 2);
    _exit(resultError());
  });
  EXPECT_EQ(ended.status, 0);
}

// Every combination: afterwards all three are open, so no file takes their place, and those that were open are as they
// were.
TEST(StandardStreams, AreOpenWhateverWasClosed) {
  for (int closed = 0; closed < 8; ++closed) {
    const Ended ended = inChild([&] {
      int status = 0;
      for (int stream = 0; stream < 3; ++stream) {
        const int file = open("/dev/zero", O_RDWR);
        dup2(file, stream);
        close(file);
      }
      for (int stream = 0; stream < 3; ++stream) {
        if ((closed >> stream & 1) != 0) close(stream);
      }
      openClosedStreams();
      const int next = open("/dev/null", O_RDWR);
      if (next <= 2) status = 1;
      for (int stream = 0; stream < 3; ++stream) {
        char byte = 1;
        const bool was_closed = (closed >> stream & 1) != 0;
        const ssize_t done = stream == 0 ? read(stream, &byte, 1) : write(stream, &byte, 1);
        // What goes to a closed stream is lost, and who cares can know it.
        if (was_closed ? done != -1 || errno != EBADF : done != 1) status = 2 + stream;
      }
      _exit(status);
    });
    EXPECT_EQ(ended.status, 0) << closed;
  }
}

}  // namespace message_test
}  // namespace palpate
