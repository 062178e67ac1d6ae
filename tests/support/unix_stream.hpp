// SPDX-License-Identifier: Apache-2.0
// A stream socket of another program: what a test says there, and reads from there.
#pragma once

#include <string>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace palpate {

// The descriptor, which is the caller's.
inline int connectedStream(const std::string& path) {
  const int reader = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  EXPECT_EQ(connect(reader, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0) << path;
  return reader;
}

inline void sayTo(int reader, const std::string& text) {
  EXPECT_EQ(send(reader, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
}

// Until the other side ends it; closes it.
inline std::string readAllOf(int reader) {
  std::string all;
  char part[512];
  for (ssize_t count = 0; (count = recv(reader, part, sizeof part, 0)) > 0;)
    all.append(part, static_cast<std::size_t>(count));
  close(reader);
  return all;
}

}  // namespace palpate
