// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/questions.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "apps/serve/asked_words.hpp"
#include "apps/serve/live_setting.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "apps/view/picture_png.hpp"
#include "base/atomic_file.hpp"
#include "base/other_version.hpp"
#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_reach.hpp"
#include "engine/edit/edit_text.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/session/tool_brush.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostEdits = 256;     // in one question
constexpr std::size_t kMostPrepared = 256;  // questions of all clients that wait for meshes

// Why the work was not done; `remedy`: if memory was lacking.
std::optional<Error> refusalFrom(const std::function<void()>& work, const std::string& of, const std::string& remedy) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  } catch (const std::exception& error) {
    return Error(Error::Code::kOutOfMemory, of, error.what(), remedy);
  }
  return std::nullopt;
}

void doOrRefuse(const Questions::Done& done, const std::function<void()>& work) {
  if (const std::optional<Error> refusal = refusalFrom(work, "the question", "ask for less")) done(refusal, {});
}

// Whether it is certain that a brush or a cut reaches no voxel. Not asked of stamps, whose distances are too many to be
// lowered only for this, nor of what the engine will refuse.
bool reachesNothing(const EditCommand& command, const ServedVolume& served) {
  if (isStamp(command.kind)) return false;
  if (command.kind == EditKind::kCut) {
    const Vec3 normal_W = command.normal_W.normalized(), last = (served.size() - Vec3i::Ones()).cast<double>();
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Vec3 p_L((corner & 1) != 0 ? last.x() : 0, (corner & 2) != 0 ? last.y() : 0,
                     (corner & 4) != 0 ? last.z() : 0);
      const double height = (served.lattice().toWorld(p_L) - command.plane_W).dot(normal_W);
      if (!(height < -served.profile().band_m)) return false;
    }
    return true;
  }
  try {
    const LoweredEdits lowered = lowerEdits(std::span(&command, 1), served.size(), served.lattice(), served.profile());
    return reachedBox(lowered.commands.front(), BrickGrid{served.size(), served.lattice().spacing_m}).empty();
  } catch (const Error&) {
    return false;
  }
}

// Of the first one that reaches nothing, or else is too fine for the voxels; empty: none is.
std::string warningOf(const std::vector<EditCommand>& commands, const ServedVolume& served) {
  if (std::ranges::any_of(commands, [&](const EditCommand& one) { return reachesNothing(one, served); }))
    return "it reaches no voxel: 'palpate info' says where the volume lies (mm)";
  std::string warning;
  for (auto command = commands.begin(); command != commands.end() && warning.empty(); ++command)
    warning = fineBrushWarning(*command, served.lattice());
  return warning;
}

void writePicture(const std::string& file, const PictureQueue::Picture& picture, const std::string& failure) {
  if (!picture) throw Error(Error::Code::kDevice, "the picture", failure, "ask again");
  AtomicFile target(file);
  target.write(pngOf(*picture));
  target.commit();
}

}  // namespace

Questions::Questions(ServedVolume& served)
    : served_(served), stamps_(served.lattice(), served.profile()), preparer_("preparer"), packer_("packer") {}

void Questions::finish() {
  preparer_.finish();
  packer_.finish();
}

void Questions::ask(const wire::AskT& ask, const std::shared_ptr<Onlooker>& onlooker, const Done& done) {
  doOrRefuse(done, [&] { pass(ask, onlooker, done); });
}

void Questions::pass(const wire::AskT& ask, const std::shared_ptr<Onlooker>& onlooker, const Done& done) {
  switch (ask.verb) {
    case wire::Verb::Status:
    case wire::Verb::LookOn:
    case wire::Verb::Look:
      break;  // the desk answers them, and does not pass them on
    case wire::Verb::Show:
    case wire::Verb::Hold:
    case wire::Verb::Release:
    case wire::Verb::GoTo:
    case wire::Verb::Change:
      return askFromAWindow(ask, onlooker, done);
    case wire::Verb::Get:
      checkWords(ask, 0, kMostEdits);
      return done({}, settingsText(served_.scene(), ask.words));
    case wire::Verb::Set:
      return setLive(ask, done);
    case wire::Verb::Edit:
      return askForEdit(ask, done);
    case wire::Verb::Undo:
      return inOrder(done, [this, done] {
        served_.undo([done](const std::optional<Error>& refusal) { done(refusal, "undone"); });
      });
    case wire::Verb::Redo:
      return inOrder(done, [this, done] {
        served_.redo([done](const std::optional<Error>& refusal) { done(refusal, "redone"); });
      });
    case wire::Verb::Save:
      return save(ask, done);
    case wire::Verb::Filter:
      return filter(ask, done);
    case wire::Verb::Render:
      return askForPicture(ask, done);
    case wire::Verb::Leave:
      end_is_asked_ = true;
      return done({}, "the service ends");
  }
  refuseOtherVersion("the question", "this program does not know it");
}

void Questions::inOrder(const Done& done, const std::function<void()>& request, Takes takes) {
  if (takes == Takes::kNoTime && preparer_.idle()) return request();
  if (preparer_.waiting() >= kMostPrepared)  // also of clients that have gone
    throw Error(Error::Code::kOutOfMemory, "the question", "too many wait for meshes that are being read",
                "ask again in a moment");
  preparer_.add([done, request] { doOrRefuse(done, request); });
}

void Questions::setLive(const wire::AskT& ask, const Done& done) {
  checkWords(ask, 2, 2);
  const std::string key = ask.words[0];
  const bool is_isovalue = key == "isovalue";
  served_.change(
      withLiveSetting(served_.scene(), key, ask.words[1]),
      [this, done, key, is_isovalue](const std::optional<Error>& refusal) {
        if (refusal) return done(refusal, {});
        const std::string stairs = is_isovalue ? served_.stairs() : "";
        done({}, settingsText(served_.scene(), std::span(&key, 1)) + warningLines() + stairs);
      },
      is_isovalue ? ServedVolume::Awaits::kTheIsovalue : ServedVolume::Awaits::kAnotherIsovalue);
}

std::string Questions::warningLines() const {
  std::string lines;
  for (const std::string& warning : served_.warnings()) lines += warning + "\n";
  return lines;
}

void Questions::filter(const wire::AskT& ask, const Done& done) {
  checkWords(ask, 1, 1);
  served_.filter(ask.words[0], [&served = served_, done, chain = ask.words[0]](const std::optional<Error>& refusal) {
    if (refusal) return done(refusal, {});
    const std::string stairs = served.stairs();
    done({}, (chain.empty() ? "felt as it is, without filters" : "felt through " + chain) +
                 (stairs.empty() ? "" : "; " + stairs));
  });
}

void Questions::save(const wire::AskT& ask, const Done& done) {
  checkWords(ask, 1, 1);
  checkAbsolute(ask.words[0]);
  inOrder(done, [this, done, file = ask.words[0]] {
    served_.save(file,
                 [done](const LiveVolume::Saved& saved) { done(saved.refusal, saved.written ? saved.words : ""); });
  });
}

void Questions::askForEdit(const wire::AskT& ask, const Done& done) {
  checkWords(ask, 1, kMostEdits);
  bool has_mesh = false;
  for (const std::string& word : ask.words) {
    const EditText text = editText(word, EditUse::kPlaced, word);
    if (text.verb != EditText::Verb::kEdit)
      refuse(word, "it is not an edit of one place", "undo and redo are questions of their own: 'palpate ctl undo'");
    if (text.mesh_file.empty()) continue;
    checkAbsolute(text.mesh_file);
    has_mesh = true;
  }
  inOrder(
      done, [this, words = ask.words, done] { edit(words, done); }, has_mesh ? Takes::kLong : Takes::kNoTime);
}

void Questions::edit(const std::vector<std::string>& words, const Done& done) {
  std::vector<EditCommand> commands;
  for (const std::string& word : words) {
    EditText text = editText(word, EditUse::kPlaced, word);
    if (!text.mesh_file.empty()) text.command.stamp = stamps_.stampOf(text);
    for (EditCommand& command : withMirror(text.command, text.mirror_axis, served_.size(), served_.lattice()))
      commands.push_back(std::move(command));
  }
  std::string answer = fmt::format("{} edit{} made{}", commands.size(), commands.size() == 1 ? "" : "s",
                                   served_.keepsJournal() ? ", and on the disk" : "");
  if (const std::string warning = warningOf(commands, served_); !warning.empty())
    answer += (commands.size() == 1 ? "; " : "; one of them at least: ") + warning;
  served_.edit(std::move(commands), [done, answer](const std::optional<Error>& refusal) { done(refusal, answer); });
}

void Questions::askForPicture(const wire::AskT& ask, const Done& done) {
  checkWords(ask, 3, 3);
  const std::string file = ask.words[0];
  checkAbsolute(file);
  if (!file.ends_with(".png")) refuse(file, "pictures are written as PNG", "end its name with .png");
  const AskedPixels pixels = pixelsOf(ask.words[1], ask.words[2]);
  checkWritable(file);
  const std::string words = fmt::format("{}: {} x {} pixels", file, pixels.width, pixels.height);
  served_.render(
      pixels.width, pixels.height,
      [this, file, words, done](const PictureQueue::Picture& picture, const std::string& failure) {
        packer_.add([file, words, done, picture, failure] {
          done(refusalFrom([&] { writePicture(file, picture, failure); }, "the picture", "ask for a smaller one"),
               words);
        });
      });
}

void Questions::askFromAWindow(const wire::AskT& ask, const std::shared_ptr<Onlooker>& looks_on, const Done& done) {
  Onlooker& onlooker = checkedOnlooker(looks_on);
  switch (ask.verb) {
    case wire::Verb::Show:
      served_.show(onlooker, viewOf(ask.view));
      break;
    case wire::Verb::Hold:
      checkWords(ask, 1, 1);
      return inOrder(done,
                     [this, done, looks_on, turn = served_.askToHold(onlooker), brush = toolBrushSpec(ask.words[0])] {
                       served_.hold(looks_on, turn, brush);
                       done({}, {});
                     });
    case wire::Verb::Release:
      served_.release(looks_on);
      break;
    case wire::Verb::GoTo:
      checkWords(ask, 1, 1);
      return inOrder(done, [this, done, count = countOf(ask.words[0])] {
        served_.goTo(count);
        done({}, {});
      });
    default:
      return served_.change(settingsOf(ask.before), settingsOf(ask.settings),
                            [done](const std::optional<Error>& refusal) { done(refusal, {}); });
  }
  done({}, {});
}

}  // namespace palpate
