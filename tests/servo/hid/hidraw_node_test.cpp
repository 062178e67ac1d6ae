// SPDX-License-Identifier: Apache-2.0
// A node of hidraw is opened and nothing else; a port at one carries whole reports. Truth for the port: a packet
// socket, whose other end stands for the device. Real nodes are in tests/hid.
#include "servo/hid/hidraw_node.hpp"

#include <array>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>

#include "base/error.hpp"
#include "base/module.hpp"
#include "servo/hid/hid_module.hpp"

namespace palpate {
namespace hidraw_node_test {

using testing::HasSubstr;

Error::Code refusalOf(const std::string& path, std::string* words = nullptr) {
  try {
    static_cast<void>(openHidrawNode(path));
  } catch (const Error& error) {
    if (words != nullptr) *words = error.what();
    return error.code();
  }
  ADD_FAILURE() << path << " was opened";
  return {};
}

// Whoever asks a broker to open something (service/broker) may say anything.
TEST(HidrawNode, NoOtherPathIsOpened) {
  for (const char* path : {"", "/dev/null", "/dev/zero", "/dev/hidraw", "/dev/hidraw/0", "/dev/hidraw0/../null",
                           "/dev/hidrawx", "/dev/hidraw0x", "/dev/hidraw-1", "dev/hidraw0", "//dev/hidraw0", "hidraw0",
                           "/proc/self/mem", "/etc/passwd", "/dev/hidraw0\n", "/dev/./hidraw0"})
    EXPECT_EQ(refusalOf(path), Error::Code::kBadInput) << path;
  EXPECT_EQ(refusalOf(std::string("/dev/hidraw0\0/../null", 21)), Error::Code::kBadInput);
}

TEST(HidrawNode, OneThatIsNotThereIsTold) {
  std::string words;
  EXPECT_EQ(refusalOf("/dev/hidraw99999", &words), Error::Code::kNotFound);
  EXPECT_THAT(words, HasSubstr("/dev/hidraw99999: it is not there any more; plug the device in"));
}

// Where nobody says which device it is, it is not handed over.
TEST(HidrawNode, WhatTheKernelSaysNothingOfIsTold) {
  const Descriptor nothing(open("/dev/null", O_RDWR | O_CLOEXEC));
  try {
    static_cast<void>(numbersAt(nothing, "/dev/hidraw3"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kDevice);
    EXPECT_THAT(error.what(), HasSubstr("/dev/hidraw3: the kernel does not say what it is"));
  }
}

// hidapi opens devices of libusb alone.
TEST(HidModules, OnlyThatOfLibusbOpens) {
  const auto tableOf = [](const char* name) {
    return static_cast<const HidModule*>(moduleTable(moduleFile(name), HidModule::kTable));
  };
  EXPECT_EQ(tableOf("hidraw")->open, nullptr);
  EXPECT_NE(tableOf("hidusb")->open, nullptr);
}

class NodePorts : public testing::Test {
 protected:
  NodePorts() {
    std::array<int, 2> ends = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) return;
    device_ = Descriptor(ends[0]);
    port_ = portAt(Descriptor(ends[1]));
  }
  Descriptor device_;
  std::unique_ptr<ReportPort> port_;
};

TEST_F(NodePorts, CarryWholeReports) {
  ASSERT_NE(port_, nullptr);
  Report report;
  report.size = 5;
  EXPECT_EQ(port_->read(report, 0), PortRead::kNothing);
  EXPECT_EQ(report.size, 0U);
  for (const std::size_t size : {std::size_t{1}, std::size_t{14}, kMostReportBytes + 1}) {
    Report sent;
    sent.size = size;
    for (std::size_t i = 0; i < size; ++i) sent.bytes.at(i) = static_cast<std::uint8_t>(i + size);
    ASSERT_TRUE(port_->write(sent));
    Report there;
    ASSERT_EQ(recv(device_.get(), there.bytes.data(), there.bytes.size(), 0), static_cast<ssize_t>(size));
    there.size = size;
    EXPECT_EQ(there, sent);
    ASSERT_EQ(send(device_.get(), sent.bytes.data(), size, 0), static_cast<ssize_t>(size));
    ASSERT_EQ(port_->read(report, 1000), PortRead::kReport);
    EXPECT_EQ(report, sent);
  }
}

TEST_F(NodePorts, ADeviceThatIsGoneIsTold) {
  ASSERT_NE(port_, nullptr);
  device_.close();
  Report report;
  EXPECT_EQ(port_->read(report, 1000), PortRead::kGone);
  EXPECT_EQ(port_->read(report, 0), PortRead::kGone);
  EXPECT_EQ(report.size, 0U);
}

}  // namespace hidraw_node_test
}  // namespace palpate
