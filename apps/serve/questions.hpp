// SPDX-License-Identifier: Apache-2.0
// apps/serve/questions.hpp: what clients ask a service to do, one case for each verb (service/messages): read, checked,
// and passed on to the served volume.
//
// They are done in the order in which they are asked, by the engine. Meshes are read and pictures packed by threads of
// their own; what is asked for after an edit whose mesh is still being read waits for it. What has an answer at once
// and another form (how the service goes, looking on) is not here but in client_desk.hpp.
// Threads: one makes it and asks. Each Done is called once, by any thread, and must throw nothing. Errors: none; what
// is refused is told to the Done, also what memory is lacking for.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/edit/stamp_files.hpp"
#include "apps/serve/chores.hpp"
#include "apps/serve/served_volume.hpp"
#include "base/error.hpp"
#include "service/messages/message.hpp"

namespace palpate {

class Questions {
 public:
  using Done = std::function<void(const std::optional<Error>& refusal, const std::string& text)>;
  explicit Questions(ServedVolume& served);

  // `onlooker`: what the client looks on with; null: it does not.
  void ask(const wire::AskT& ask, const std::shared_ptr<Onlooker>& onlooker, const Done& done);
  [[nodiscard]] bool endIsAsked() const noexcept { return end_is_asked_; }  // of the service
  void finish();  // waits for meshes and pictures that are under way

 private:
  void pass(const wire::AskT& ask, const std::shared_ptr<Onlooker>& onlooker, const Done& done);
  enum class Takes { kNoTime, kLong };
  void inOrder(const Done& done, const std::function<void()>& request, Takes takes = Takes::kNoTime);
  void setLive(const wire::AskT& ask, const Done& done);
  void filter(const wire::AskT& ask, const Done& done);
  void save(const wire::AskT& ask, const Done& done);
  void askForEdit(const wire::AskT& ask, const Done& done);
  void edit(const std::vector<std::string>& words, const Done& done);
  void askForPicture(const wire::AskT& ask, const Done& done);
  void askFromAWindow(const wire::AskT& ask, const std::shared_ptr<Onlooker>& looks_on, const Done& done);
  [[nodiscard]] std::string warningLines() const;

  ServedVolume& served_;
  bool end_is_asked_ = false;
  StampFiles stamps_;  // the preparer's
  Chores preparer_;    // of edits with meshes, and of what was asked for after them
  Chores packer_;      // last members: they use the others
};

}  // namespace palpate
