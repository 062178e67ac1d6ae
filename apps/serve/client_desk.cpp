// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/client_desk.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "apps/serve/live_setting.hpp"
#include "apps/view/picture_png.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/units.hpp"
#include "engine/edit/edit_text.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostEdits = 256;  // in one question
constexpr int kMostPixels = 4096;        // along a side of a picture

// The number of a word; 0: it is none.
int pixelsOf(const std::string& word) {
  const bool is_number =
      !word.empty() && word.size() < 6 && std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
  return is_number ? std::stoi(word) : 0;
}

// So that an answer fits a packet, whatever was asked.
wire::AnswerT shortened(wire::AnswerT words) {
  constexpr std::size_t kMostText = 32'000, kMostPart = 4000;
  if (words.text.size() > kMostText) words.text.resize(kMostText);
  if (words.refusal) {
    for (std::string* const part : {&words.refusal->input, &words.refusal->reason, &words.refusal->remedy})
      if (part->size() > kMostPart) part->resize(kMostPart);
  }
  return words;
}

void writePicture(const std::string& file, const RenderedImage& image) {
  AtomicFile target(file);
  target.write(pngOf(image));
  target.commit();
}

void checkWords(const wire::AskT& ask, std::size_t least, std::size_t most) {
  if (ask.words.size() >= least && ask.words.size() <= most) return;
  refuse("the question",
         fmt::format("'{}' has {} words, not {} to {}", wire::EnumNameVerb(ask.verb), ask.words.size(), least, most),
         "ask with 'palpate ctl'");
}

wire::AnswerT answerOf(std::uint64_t number, const std::optional<Error>& refusal, const std::string& text) {
  wire::AnswerT words;
  words.number = number;
  words.text = text;
  if (refusal) words.refusal = std::make_unique<wire::RefusalT>(refusalMessage(*refusal));
  return words;
}

void checkAbsolute(const std::string& file) {
  if (!file.starts_with('/')) refuse(file, "the service writes files whose whole path is named", "begin it with '/'");
}

}  // namespace

ClientDesk::ClientDesk(Listener listener, ServedVolume& served, Tell tell)
    : served_(served),
      tell_(std::move(tell)),
      listener_(std::move(listener)),
      waker_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!waker_)
    throw Error(Error::Code::kIo, listener_.path(), fmt::format("nothing can wake it ({})", std::strerror(errno)),
                "raise the limit of open files (ulimit -n)");
}

ClientDesk::~ClientDesk() = default;

void ClientDesk::wake() const noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(write(waker_.get(), &one, sizeof one));
}

bool ClientDesk::round(int most_ms) {
  std::vector<pollfd> waits = {{listener_.descriptor(), POLLIN, 0}, {waker_.get(), POLLIN, 0}};
  for (const Client& client : clients_) waits.push_back({client.channel.descriptor(), POLLIN, 0});
  static_cast<void>(poll(waits.data(), waits.size(), most_ms));
  std::uint64_t count = 0;
  static_cast<void>(read(waker_.get(), &count, sizeof count));
  sendReady();
  for (auto client = clients_.begin(); client != clients_.end();) {
    std::string why;
    if (listenTo(*client, why)) {
      ++client;
      continue;
    }
    if (!why.empty())
      tell_(fmt::format("client {} (process {}) is dropped: {}", client->number, client->channel.peer().process, why));
    client = clients_.erase(client);
  }
  accept();
  sendReady();
  return !leaves_;
}

void ClientDesk::accept() {
  for (Channel channel = listener_.accept(); channel.open(); channel = listener_.accept()) {
    if (clients_.size() >= kMostClients) {
      tell_(fmt::format("a client (process {}) is turned away: {} are here", channel.peer().process, clients_.size()));
      continue;
    }
    clients_.push_back({.number = ++count_, .channel = std::move(channel), .since_ns = monotonicNow_ns()});
  }
}

bool ClientDesk::listenTo(Client& client, std::string& why) {
  try {
    for (std::size_t taken = 0; taken < kMostOpen && client.channel.open(); ++taken) {
      Packet packet;
      const Channel::Got got = client.channel.receive(packet, 0);
      if (got == Channel::Got::kClosed) return false;
      if (got == Channel::Got::kNothing) break;
      wire::BodyUnion body = decoded(packet.bytes, "a client");
      const bool is_first = !std::exchange(client.has_spoken, true);
      if (const auto* const hello = contentOf<wire::HelloT>(body); is_first && hello != nullptr) {
        greet(client, *hello);
        return false;
      }
      const auto* const ask = contentOf<wire::AskT>(body);
      if (ask == nullptr) {
        why = fmt::format("it sent a message {} where none may be", kindOf(body));
        return false;
      }
      take(client, *ask);
    }
  } catch (const Error& error) {
    why = error.what();
    return false;
  }
  const double silent_s = static_cast<double>(monotonicNow_ns() - client.since_ns) / kNanosecondsPerSecond;
  if (!client.has_spoken && silent_s > kSilence_s) why = "it says nothing";
  if (!client.channel.open()) why = "it does not read its answers";
  return why.empty();
}

// It is no client: the engine talks with it from now on.
void ClientDesk::greet(Client& client, const wire::HelloT& hello) {
  if (served_.attach(std::move(client.channel), hello)) return;
  tell_("a second servo is turned away");
}

void ClientDesk::take(Client& client, const wire::AskT& ask) {
  if (ask.verb == wire::Verb::Status) return askForStatus(ask, client);
  const Answer done = answerTo(client, ask);
  if (client.open > kMostOpen) {
    done(Error(Error::Code::kOutOfMemory, "the question", fmt::format("{} others are not answered yet", kMostOpen),
               "wait for answers"),
         {});
    return;
  }
  try {
    askFor(ask, done, client);
  } catch (const Error& error) {
    done(error, {});
  }
}

ClientDesk::Answer ClientDesk::answerTo(Client& client, const wire::AskT& ask) {
  ++client.open;
  return
      [this, number = client.number, asked = ask.number](const std::optional<Error>& refusal, const std::string& text) {
        answer(number, [asked, refusal, text] { return answerOf(asked, refusal, text); });
      };
}

void ClientDesk::answer(std::uint64_t client, Make make) {
  {
    const std::lock_guard lock(mutex_);
    ready_.push_back({client, std::move(make)});
  }
  wake();
}

// Nobody is waited for: a client whose socket is full has not read.
void ClientDesk::sendReady() {
  std::deque<Ready> ready;
  {
    const std::lock_guard lock(mutex_);
    ready.swap(ready_);
  }
  for (const Ready& one : ready) {
    const std::vector<std::byte> bytes = encodedAnswer(one);  // also for one who has left: a picture is written
    const auto client = std::ranges::find(clients_, one.client, &Client::number);
    if (client == clients_.end()) continue;
    if (client->open > 0) --client->open;
    if (!client->channel.send(bytes, 0)) client->channel.close();
  }
}

// What went wrong with one answer is no matter for the others.
std::vector<std::byte> ClientDesk::encodedAnswer(const Ready& one) {
  try {
    return encoded(shortened(one.make()));
  } catch (const std::exception& error) {
    tell_(fmt::format("an answer to client {} could not be made: {}", one.client, error.what()));
    wire::AnswerT none;
    return encoded(std::move(none));
  }
}

void ClientDesk::flush() {
  sendReady();
}

void ClientDesk::askFor(const wire::AskT& ask, const Answer& done, Client& client) {
  switch (ask.verb) {
    case wire::Verb::Status:
      return;  // answered at once
    case wire::Verb::Get:
      checkWords(ask, 0, kMostEdits);
      return done({}, settingsText(served_.scene(), ask.words));
    case wire::Verb::Set: {
      checkWords(ask, 2, 2);
      served_.change(withLiveSetting(served_.scene(), ask.words[0], ask.words[1]));
      return done({}, settingsText(served_.scene(), std::span(ask.words).first(1)));
    }
    case wire::Verb::Edit:
      return askForEdit(ask, done);
    case wire::Verb::Undo:
      return served_.undo([done](const std::optional<Error>& refusal) { done(refusal, "undone"); });
    case wire::Verb::Redo:
      return served_.redo([done](const std::optional<Error>& refusal) { done(refusal, "redone"); });
    case wire::Verb::Save:
      checkWords(ask, 1, 1);
      checkAbsolute(ask.words[0]);
      return served_.save(ask.words[0], [done](const LiveVolume::Saved& saved) {
        if (saved.written) return done({}, saved.words);
        done(Error(Error::Code::kIo, "the volume", saved.words, "see that there is room, and ask again"), {});
      });
    case wire::Verb::Render:
      return askForPicture(ask, client);
    case wire::Verb::Leave:
      leaves_ = true;
      return done({}, "the service ends");
  }
  refuse("the question", "this program does not know it", "start programs of the same version of Palpate");
}

void ClientDesk::askForEdit(const wire::AskT& ask, const Answer& done) {
  checkWords(ask, 1, kMostEdits);
  std::vector<EditCommand> commands;
  for (const std::string& word : ask.words) {
    const EditText text = editText(word, EditUse::kPlaced, word);
    if (text.verb != EditText::Verb::kEdit || !text.mesh_file.empty())
      refuse(word, "it is not an edit of one place without a mesh",
             "ask for undo and redo with their own verbs; stamp with 'palpate edit'");
    for (EditCommand& command : withMirror(text.command, text.mirror_axis, served_.size(), served_.lattice()))
      commands.push_back(std::move(command));
  }
  const std::size_t count = commands.size();
  served_.edit(std::move(commands), [done, count](const std::optional<Error>& refusal) {
    done(refusal, fmt::format("{} edit{} made, and on the disk", count, count == 1 ? "" : "s"));
  });
}

void ClientDesk::askForPicture(const wire::AskT& ask, const Client& client) {
  checkWords(ask, 3, 3);
  const std::string file = ask.words[0];
  const int width = pixelsOf(ask.words[1]), height = pixelsOf(ask.words[2]);
  checkAbsolute(file);
  if (!file.ends_with(".png")) refuse(file, "pictures are written as PNG", "end its name with .png");
  if (width < 16 || height < 16 || width > kMostPixels || height > kMostPixels)
    refuse("the picture", fmt::format("it has 16 to {} pixels along a side", kMostPixels), "name other sizes");
  checkWritable(file);
  served_.render(
      width, height,
      [this, file, number = client.number, asked = ask.number](RenderedImage image, const std::string& failure) {
        const auto kept = std::make_shared<const RenderedImage>(std::move(image));
        answer(number, [file, kept, failure, asked] {
          try {
            if (!failure.empty()) throw Error(Error::Code::kDevice, "the picture", failure, "ask again");
            writePicture(file, *kept);
          } catch (const Error& error) {
            return answerOf(asked, error, {});
          }
          return answerOf(asked, {}, fmt::format("{}: {} x {} pixels", file, kept->width, kept->height));
        });
      });
}

void ClientDesk::askForStatus(const wire::AskT& ask, Client& client) {
  const ServedStatus s = served_.status();
  wire::AnswerT words;
  words.number = ask.number;
  const auto add = [&](const char* key, double value) {
    words.figures.push_back(std::make_unique<wire::FigureT>());
    words.figures.back()->key = key;
    words.figures.back()->value = value;
  };
  add("servo", s.servo ? 1 : 0);
  add("servos", static_cast<double>(s.servos));
  add("clients", static_cast<double>(clients_.size()));
  add("tick", static_cast<double>(s.pose.tick));
  add("pose_age_ms",
      s.pose.tick < 0 ? 0 : static_cast<double>(monotonicNow_ns() - s.pose_at_ns) / kNanosecondsPerMillisecond);
  add("force_N", s.pose.force_W.norm());
  add("contact", s.pose.normal_W.isZero(0) ? 0 : 1);
  add("windows", static_cast<double>(s.windows));
  add("edits", static_cast<double>(s.edits));
  add("refused", static_cast<double>(s.refused));
  add("waiting_for_disk", static_cast<double>(s.waiting));
  add("undoable", static_cast<double>(s.undoable));
  add("redoable", static_cast<double>(s.redoable));
  add("unsaved", s.unsaved ? 1 : 0);
  add("journal_bytes", static_cast<double>(s.journal_bytes));
  words.text = s.journal_failure;
  if (!client.channel.send(encoded(std::move(words)), 0)) client.channel.close();
}

}  // namespace palpate
