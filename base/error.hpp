// SPDX-License-Identifier: Apache-2.0
// base/error.hpp: the one error type of set-up and engine code. The servo throws nothing; it raises fault flags.
//
// A message is one line that a user can act on: which input, what is wrong with it, what to do.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

namespace palpate {

class Error : public std::runtime_error {
 public:
  // What kind of trouble, so that a caller (and the exit status) can tell them apart.
  enum class Code {
    kBadInput,     // a file, scene or flag that cannot be used as it is
    kNotFound,     // a file, folder, device or driver that is not there
    kIo,           // reading or writing failed: permission, full disk, broken pipe
    kOutOfMemory,  // a budget of main or GPU memory would be exceeded
    kDevice,       // Vulkan or a haptic device failed
    kCancelled     // the user stopped the work
  };

  // `input`: the file, flag or key; `reason`: what is wrong; `remedy`: what to do. Joined as "input: reason; remedy".
  Error(Code code, const std::string& input, const std::string& reason, const std::string& remedy);

  [[nodiscard]] Code code() const noexcept { return code_; }
  [[nodiscard]] const std::string& input() const noexcept { return parts_->input; }
  [[nodiscard]] const std::string& reason() const noexcept { return parts_->reason; }
  [[nodiscard]] const std::string& remedy() const noexcept { return parts_->remedy; }

 private:
  struct Parts {
    std::string input, reason, remedy;
  };
  Code code_;
  std::shared_ptr<const Parts> parts_;  // shared, so that a copy cannot fail
};

// Throws Error(kBadInput).
[[noreturn]] void refuse(const std::string& input, const std::string& reason, const std::string& remedy);

// The same for a file whose content cannot be right, with the remedy to copy it again.
[[noreturn]] void refuseDamaged(const std::string& file, const std::string& reason);

// What to do where no file descriptor, and where no process or thread, can be had.
inline constexpr const char* kFreeDescriptors = "raise the limit of open files (ulimit -n), or end other programs";
inline constexpr const char* kFreeProcesses = "end other programs, or raise the limit of processes (ulimit -u)";

// Refuses the value of a parameter, "stiffness: -1 cannot be used; give 0 or more", unless it is `good` and finite.
void checkSetting(bool good, const std::string& name, double value, const std::string& remedy);

// The process's exit status for an error code: 2 bad input, 3 not found, 4 I/O, 5 memory, 6 device, 130 cancelled.
[[nodiscard]] int exitStatus(Error::Code code) noexcept;

}  // namespace palpate
