// SPDX-License-Identifier: Apache-2.0
#include "base/user_folders.hpp"

#include <cstdlib>
#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace user_folders_test {

// A variable for the length of a test.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* was = std::getenv(name)) was_ = was;
    value == nullptr ? unsetenv(name) : setenv(name, value, 1);
  }
  ~Variable() { was_ ? setenv(name_, was_->c_str(), 1) : unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> was_;
};

TEST(UserFolders, FollowTheVariablesOfTheDesktop) {
  const Variable home("HOME", "/home/somebody");
  {
    const Variable config("XDG_CONFIG_HOME", "/c"), state("XDG_STATE_HOME", "/s"), cache("XDG_CACHE_HOME", "/k"),
        runtime("XDG_RUNTIME_DIR", "/r");
    EXPECT_EQ(settingsFolder(), "/c/palpate");
    EXPECT_EQ(stateFolder(), "/s/palpate");
    EXPECT_EQ(cacheFolder(), "/k/palpate");
    EXPECT_EQ(runtimeFolder(), "/r/palpate");
    EXPECT_EQ(calibrationsFolder(), "/r/palpate/calibrated");
  }
  for (const char* unset : {static_cast<const char*>(nullptr), "", "relative"}) {
    const Variable config("XDG_CONFIG_HOME", unset), state("XDG_STATE_HOME", unset), cache("XDG_CACHE_HOME", unset),
        runtime("XDG_RUNTIME_DIR", unset);
    EXPECT_EQ(settingsFolder(), "/home/somebody/.config/palpate");
    EXPECT_EQ(stateFolder(), "/home/somebody/.local/state/palpate");
    EXPECT_EQ(cacheFolder(), "/home/somebody/.cache/palpate");
    EXPECT_EQ(runtimeFolder(), "");
    EXPECT_EQ(calibrationsFolder(), "");
    for (const char* nowhere : {static_cast<const char*>(nullptr), "", "relative"}) {
      const Variable nobody("HOME", nowhere);
      EXPECT_EQ(settingsFolder(), "");
      EXPECT_EQ(stateFolder(), "");
      EXPECT_EQ(cacheFolder(), "");
    }
  }
}

}  // namespace user_folders_test
}  // namespace palpate
