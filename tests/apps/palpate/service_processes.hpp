// SPDX-License-Identifier: Apache-2.0
// The processes of a service as a user starts them, in a folder of their own; and how to wait for what they come to.
#pragma once

#include <csignal>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "program_test.hpp"

extern char** environ;

namespace palpate {

// A program that runs beside the test, and is killed with this. Its messages go to a file.
class RunningProgram {
 public:
  RunningProgram() = default;
  RunningProgram(const std::string& program, const Words& arguments, const std::filesystem::path& folder,
                 const std::string& log) {
    Words words = Words{program} + arguments;
    std::vector<char*> raw;
    for (std::string& word : words) raw.push_back(word.data());
    raw.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    const std::string file = (folder / log).string();
    posix_spawn_file_actions_addopen(&actions, 1, file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawnattr_t own_group;
    posix_spawnattr_init(&own_group);
    posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
    if (posix_spawn(&id_, program.c_str(), &actions, &own_group, raw.data(), environ) != 0) id_ = -1;
    posix_spawnattr_destroy(&own_group);
    posix_spawn_file_actions_destroy(&actions);
  }
  ~RunningProgram() { end(SIGKILL); }
  RunningProgram(RunningProgram&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  RunningProgram& operator=(RunningProgram&& other) noexcept {
    end(SIGKILL);
    id_ = std::exchange(other.id_, -1);
    return *this;
  }

  [[nodiscard]] pid_t id() const { return id_; }
  void send(int signal) const {
    if (id_ > 0) kill(id_, signal);
  }
  // Its status as waitpid(2) gives it.
  int end(int signal) {
    if (id_ <= 0) return 0;
    killpg(id_, signal);
    int status = 0;
    waitpid(std::exchange(id_, -1), &status, 0);
    return status;
  }
  [[nodiscard]] bool hasEnded() {
    int status = 0;
    if (id_ <= 0 || waitpid(id_, &status, WNOHANG) == 0) return id_ <= 0;
    id_ = -1;
    return true;
  }

 private:
  pid_t id_ = -1;
};

class ServiceTest : public ProgramTest {
 protected:
  ServiceTest() {
    for (const auto& [name, folder] : {std::pair("XDG_RUNTIME_DIR", "run"), std::pair("XDG_STATE_HOME", "state")}) {
      std::filesystem::create_directories(file(folder));
      setenv(name, file(folder).c_str(), 1);
    }
  }
  ~ServiceTest() override {
    unsetenv("XDG_RUNTIME_DIR");
    unsetenv("XDG_STATE_HOME");
  }

  void serve(const Words& scene) {
    engine = RunningProgram(PALPATE_PROGRAM, Words{"serve"} + scene, folder(), "serve.log");
  }
  void join() { servo = RunningProgram(PALPATE_PROGRAM, {"servo"}, folder(), "servo.log"); }
  // From the journal alone, which has everything. What a checkpoint has cannot be undone by the next engine, and edits
  // that take long, as on a busy machine, make one.
  void serveFromTheJournal(const Words& scene) {
    std::vector<std::filesystem::path> checkpoints;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder()))
      if (entry.path().filename().string().starts_with("checkpoint-")) checkpoints.push_back(entry.path());
    for (const std::filesystem::path& one : checkpoints) std::filesystem::remove(one);
    serve(scene);
  }
  [[nodiscard]] Outcome ctl(const Words& words) const { return run(Words{"ctl"} + words); }
  [[nodiscard]] nlohmann::json status() const {
    const Outcome outcome = ctl({"status"});
    return outcome.status == 0 ? nlohmann::json::parse(outcome.out) : nlohmann::json();
  }
  // Asks for the status until it is so, for 60 s at most. False: it never was.
  [[nodiscard]] bool await(const std::function<bool(const nlohmann::json&)>& is_so) const {
    for (int look = 0; look < 1200; ++look) {
      const nlohmann::json now = status();
      if (now.is_object() && is_so(now)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
  [[nodiscard]] bool awaitService() const {
    return await([](const nlohmann::json&) { return true; });
  }
  // A servo that has ticked on and reads windows.
  [[nodiscard]] bool awaitServo() const {
    return await([](const nlohmann::json& now) { return now["servo"] == 1 && now["windows"] > 0; });
  }

  // Whether a program's log comes to have these words, for 10 s at most.
  [[nodiscard]] bool awaitSaid(const std::string& words, const std::string& log = "serve.log") const {
    for (int look = 0; look < 500; ++look) {
      if (contentsOf(file(log)).find(words) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  RunningProgram engine, servo;
};

}  // namespace palpate
