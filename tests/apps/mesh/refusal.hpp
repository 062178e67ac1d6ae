// SPDX-License-Identifier: Apache-2.0
// tests/apps/mesh/refusal.hpp: the message with which a reader refuses the bytes of a mesh.
#pragma once

#include <string>
#include <string_view>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "base/triangle_mesh.hpp"

namespace palpate {

// "" if they are accepted. Expects the message to be one line that begins with the file's name and has a remedy.
inline std::string refusalOf(TriangleMesh (*read)(std::string_view, const std::string&), std::string_view bytes) {
  try {
    (void)read(bytes, "some.file");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput) << error.what();
    EXPECT_THAT(error.what(), testing::StartsWith("some.file: "));
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    EXPECT_FALSE(error.remedy().empty());
    return error.what();
  }
  return "";
}

}  // namespace palpate
