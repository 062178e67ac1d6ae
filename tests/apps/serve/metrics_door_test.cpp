// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/metrics_door.hpp"

#include <atomic>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/apps/report/temporary_folder.hpp"
#include "tests/support/open_descriptors.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/unix_stream.hpp"

namespace palpate {
namespace metrics_door_test {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

class MetricsDoors : public testing::Test {
 protected:
  [[nodiscard]] std::string path() const { return (folder_.path() / "metrics.sock").string(); }
  [[nodiscard]] int connected() const { return connectedStream(path()); }
  [[nodiscard]] std::string ask(const std::string& request) const {
    const int reader = connected();
    sayTo(reader, request);
    return readAllOf(reader);
  }
  TemporaryFolder folder_;
};

TEST_F(MetricsDoors, AnswerAGet) {
  std::atomic<int> asked{0};
  const MetricsDoor door(path(), [&] { return "palpate_edits " + std::to_string(++asked) + "\n"; });
  const std::string first = ask("GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(first, StartsWith("HTTP/1.0 200 OK\r\n"));
  EXPECT_THAT(first, HasSubstr("Content-Type: text/plain; version=0.0.4"));
  EXPECT_THAT(first, HasSubstr("Content-Length: 16\r\n"));
  EXPECT_THAT(first, EndsWith("\r\n\r\npalpate_edits 1\n"));
  EXPECT_THAT(ask("GET / HTTP/1.0\r\n\r\n"), EndsWith("palpate_edits 2\n"));
  struct stat facts {};
  ASSERT_EQ(lstat(path().c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0600U);
}

TEST_F(MetricsDoors, AnswerNothingElse) {
  const MetricsDoor door(path(), [] { return std::string("secret"); });
  EXPECT_THAT(ask("POST /metrics HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.0 405 "));
  EXPECT_THAT(ask("\r\n\r\n"), StartsWith("HTTP/1.0 405 "));
  EXPECT_EQ(ask(std::string(2 * MetricsDoor::kMostRequestBytes, 'x')), "");  // it does not end in time, or is too long
}

// One who says nothing, or half a request, is left; those after him are served.
TEST_F(MetricsDoors, AreNotHeldOpen) {
  const MetricsDoor door(path(), [] { return std::string(1 << 20U, 'm'); });
  const int silent = connected(), half = connected(), deaf = connected();
  sayTo(half, "GET / HT");
  sayTo(deaf, "GET / HTTP/1.0\r\n\r\n");  // and does not read a megabyte
  EXPECT_THAT(ask("GET / HTTP/1.0\r\n\r\n"), EndsWith("mmm"));
  EXPECT_EQ(readAllOf(silent), "");
  EXPECT_EQ(readAllOf(half), "");
  EXPECT_LT(readAllOf(deaf).size(), std::size_t{1} << 20U);
}

// At the end nothing is left of it, whoever is connected.
TEST_F(MetricsDoors, LeaveNothingBehind) {
  const long before = openDescriptors();
  for (int i = 0; i < 3; ++i) {
    const MetricsDoor door(path(), [] { return std::string(); });
    close(connected());
  }
  EXPECT_EQ(openDescriptors(), before);
  EXPECT_FALSE(std::filesystem::exists(path()));
}

TEST_F(MetricsDoors, AreRefusedWhereOneIs) {
  const MetricsDoor door(path(), [] { return std::string(); });
  EXPECT_THAT(refusalOf([&] { const MetricsDoor second(path(), [] { return std::string(); }); }, Error::Code::kIo),
              HasSubstr("somebody listens there already"));
}

}  // namespace metrics_door_test
}  // namespace palpate
