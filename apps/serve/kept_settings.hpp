// SPDX-License-Identifier: Apache-2.0
// apps/serve/kept_settings.hpp: what a service was told to change of its scene (`palpate ctl set`, `filter`, a window),
// from before a crash to after it.
//
// A file keeps each such setting with the value that the scene had. The next start takes those whose value the scene
// still has: one that was changed in the scene meanwhile is the user's later word. A service that ends in good order
// forgets them.
// Threads: one makes and calls it; another one writes the file, so nobody waits for the disk.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "apps/scene/scene.hpp"
#include "apps/serve/chores.hpp"

namespace palpate {

class KeptSettings {
 public:
  using Tell = std::function<void(const std::string&)>;
  static constexpr std::int64_t kEvery_ns = 200'000'000;  // at most so late does a change go to the disk

  // `file`: empty: none is kept. `scene`: the user's. One of another volume, or that cannot be read, is told and
  // ignored.
  KeptSettings(std::filesystem::path file, const Scene& scene, Tell tell);
  // The user's scene with what is kept.
  [[nodiscard]] const Scene& taken() const noexcept { return taken_; }
  // Nothing is taken if this throws for taken(), which is told.
  void check(const std::function<void(const Scene&)>& fits);
  // Forgets what was kept, and tells why.
  void takeNone(const std::string& why);
  // The scene as the service begins with it: with what it has chosen where the user leaves it to the program, and
  // perhaps without some of taken(). Tells what is in effect, and what is not. Before look().
  void begin(const Scene& served);
  // The user's scene was read again, and its settings are in effect.
  void reread(const Scene& wanted);
  [[nodiscard]] bool isDue(std::int64_t now_ns) const noexcept { return now_ns - looked_at_ns_ >= kEvery_ns; }
  // When it is due: the scene as it is served now. An isovalue that is not felt yet is not kept: if changing to it
  // ended the service, it would end the next one too. A file that cannot be written is told once, and tried again.
  void look(const Scene& served, std::int64_t now_ns, bool isovalue_is_felt = true);
  // The end in good order. Removes the file.
  void forget();

 private:
  struct Setting {
    std::string in_scene, set;
    friend bool operator==(const Setting&, const Setting&) = default;
  };
  using Settings = std::map<std::string, Setting>;  // by key
  [[nodiscard]] Settings changed(const Scene& served, bool isovalue_is_felt) const;
  void take(const std::string& text);
  void write(const Settings& settings);

  const std::filesystem::path file_;
  const std::string volume_;  // its name, as the file says it
  const Tell tell_;
  Scene users_, taken_, at_start_;
  Settings kept_;               // as the file has them, or will
  std::string overtaken_;       // keys of those that the scene has overtaken
  std::set<std::string> told_;  // keys of those that were taken
  std::int64_t looked_at_ns_ = 0;
  std::atomic<bool> file_differs_{false};
  bool was_told_ = false;  // the writer's
  Chores writer_;          // last member: it uses the others
};

}  // namespace palpate
