// SPDX-License-Identifier: Apache-2.0
// apps/serve/kept_settings.hpp: what a service was told to change of its scene (`palpate ctl set`, `filter`, a window),
// from before a crash to after it.
//
// A file keeps each such setting with the value that the scene had. The next start takes those whose value the scene
// still has: one that was changed in the scene meanwhile is the user's later word. A service that ends in good order
// forgets them.
// Threads: one makes and calls it; another one writes the file, so nobody waits for the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "apps/scene/scene.hpp"
#include "apps/serve/chores.hpp"

namespace palpate {

class KeptSettings {
 public:
  using Tell = std::function<void(const std::string&)>;
  static constexpr std::int64_t kEvery_ns = 200'000'000;  // at most so late is a change on the disk, and then its fsync

  // `file`: empty: none is kept. A file that cannot be read is told and ignored.
  KeptSettings(std::filesystem::path file, const Scene& scene, Tell tell);
  // The scene with what is kept.
  [[nodiscard]] const Scene& scene() const noexcept { return begun_; }
  // `served`: the scene as the service begins with it, in which it has chosen what scene() leaves to it.
  void begin(const Scene& served);
  // Now and then: the scene as it is served now. A file that cannot be written is told once.
  void look(const Scene& served, std::int64_t now_ns);
  // The end in good order. Removes the file.
  void forget();

 private:
  struct Setting {
    std::string in_scene, set;
    friend bool operator==(const Setting&, const Setting&) = default;
  };
  using Settings = std::map<std::string, Setting>;  // by key
  [[nodiscard]] Settings changed(const Scene& served) const;
  void take(const std::string& text);
  void write(const Settings& settings);

  const std::filesystem::path file_;
  const Tell tell_;
  const Scene scene_;
  Scene begun_;  // scene_ with what was kept
  Scene served_first_;
  Settings kept_;  // as the file has them, or will
  std::int64_t looked_at_ns_ = 0;
  bool was_told_ = false;  // the writer's
  Chores writer_;          // last member: it uses the others
};

}  // namespace palpate
