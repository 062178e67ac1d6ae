// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/client_desk.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "apps/serve/live_setting.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "apps/view/picture_png.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/other_version.hpp"
#include "base/units.hpp"
#include "engine/edit/edit_text.hpp"
#include "engine/session/tool_brush.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostEdits = 256;     // in one question
constexpr std::size_t kMostPrepared = 256;  // questions of all clients that wait for meshes
constexpr int kMostPixels = 4096;           // along a side of a picture

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

// Throws Error(kBadInput) for a word that is no whole number.
std::uint64_t countOf(const std::string& word) {
  std::uint64_t count = 0;
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (problem != std::errc() || end != word.data() + word.size() || word.empty())
    refuse("the question", fmt::format("'{}' is no number of edits", word), "ask with 'palpate sculpt --connect'");
  return count;
}

Onlooker& onlookerOf(const std::shared_ptr<Onlooker>& onlooker) {
  if (!onlooker) refuse("the question", "it is one of a client who looks on", "ask to look on first");
  return *onlooker;
}

void checkAbsolute(const std::string& file) {
  if (!file.starts_with('/')) refuse(file, "the service writes files whose whole path is named", "begin it with '/'");
}

}  // namespace

ClientDesk::ClientDesk(Listener listener, ServedVolume& served, Tell tell)
    : served_(served),
      tell_(std::move(tell)),
      listener_(std::move(listener)),
      waker_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      stamps_(served.lattice(), served.profile()),
      preparer_("preparer"),
      packer_("packer") {
  if (!waker_)
    throw Error(Error::Code::kIo, listener_.path(), fmt::format("nothing can wake it ({})", std::strerror(errno)),
                "raise the limit of open files (ulimit -n)");
}

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
      tellOfClient(fmt::format("client {} (process {}) is dropped: {}", client->number, client->process, why));
    letGo(*client);
    client = clients_.erase(client);
  }
  accept();
  client_count_.store(clients_.size());
  sendReady();
  return !leaves_;
}

void ClientDesk::accept() {
  for (Channel channel = listener_.accept(); channel.open(); channel = listener_.accept()) {
    if (clients_.size() >= kMostClients) {
      tellOfClient(
          fmt::format("a client (process {}) is turned away: {} are here", channel.peer().process, clients_.size()));
      turnAway(channel, Error(Error::Code::kOutOfMemory, "the service",
                              fmt::format("{} clients are connected, and no more are served at once", kMostClients),
                              "end one of them, and ask again"));
      continue;
    }
    const std::int64_t process = channel.peer().process;
    clients_.push_back(
        {.number = ++count_, .channel = std::move(channel), .process = process, .since_ns = monotonicNow_ns()});
  }
}

void ClientDesk::turnAway(Channel& channel, const Error& why) {
  static_cast<void>(channel.send(encoded(refusalMessage(why)), 0));
}

void ClientDesk::tellOfClient(const std::string& words) {
  if (!words_.mayAsk(monotonicNow_ns())) {
    ++untold_;
    return;
  }
  const std::uint64_t untold = std::exchange(untold_, 0);
  tell_(untold == 0 ? words : fmt::format("{} ({} more like that were not told)", words, untold));
}

bool ClientDesk::listenTo(Client& client, std::string& why) {
  try {
    for (std::size_t taken = 0; taken < kMostOpen && client.channel.open(); ++taken) {
      Packet packet;
      const Channel::Got got = client.channel.receive(packet, 0);
      if (got == Channel::Got::kClosed) return false;
      if (got == Channel::Got::kNothing) break;
      if (!client.rate.mayAsk(monotonicNow_ns())) {
        why = fmt::format("it asks more often than {:g} times a second", kMostPerSecond);
        return false;
      }
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
  } catch (const std::exception& error) {
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
  turnAway(client.channel, Error(Error::Code::kIo, "the service", "another servo touches its volume already",
                                 "end that one, or name another service's socket with --connect"));
  // It tries again every second.
  if (std::exchange(last_turned_away_, client.process) != client.process)
    tellOfClient(fmt::format("a second servo (process {}) is turned away", client.process));
}

void ClientDesk::take(Client& client, const wire::AskT& ask) {
  if (ask.protocol != kProtocol) {
    const Error other = otherVersion(
        "the question", fmt::format("its program speaks number {} of the protocol, not {}", ask.protocol, kProtocol));
    return answerNow(client, answerOf(ask.number, other, {}));
  }
  if (ask.verb == wire::Verb::Status) return askForStatus(ask, client);
  if (ask.verb == wire::Verb::LookOn || ask.verb == wire::Verb::Look) return letLookOn(ask, client);
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
  } catch (const std::exception& error) {
    done(Error(Error::Code::kOutOfMemory, "the question", error.what(), "ask for less"), {});
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
    const std::vector<std::byte> bytes = encodedAnswer(one);
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
  preparer_.finish();
  packer_.finish();
  sendReady();
}

void ClientDesk::askFor(const wire::AskT& ask, const Answer& done, Client& client) {
  switch (ask.verb) {
    case wire::Verb::Status:
    case wire::Verb::LookOn:
    case wire::Verb::Look:
      return;  // answered at once
    case wire::Verb::Show:
    case wire::Verb::Hold:
    case wire::Verb::Release:
    case wire::Verb::GoTo:
    case wire::Verb::Change:
      return askFromAWindow(ask, done, client);
    case wire::Verb::Get:
      checkWords(ask, 0, kMostEdits);
      return done({}, settingsText(served_.scene(), ask.words));
    case wire::Verb::Set: {
      checkWords(ask, 2, 2);
      const std::string key = ask.words[0];
      return served_.change(
          withLiveSetting(served_.scene(), key, ask.words[1]),
          [this, done, key](const std::optional<Error>& refusal) {
            done(refusal, refusal ? "" : settingsText(served_.scene(), std::span(&key, 1)) + warningLines());
          },
          key == "isovalue" ? ServedVolume::Awaits::kTheIsovalue : ServedVolume::Awaits::kAnotherIsovalue);
    }
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
      checkWords(ask, 1, 1);
      checkAbsolute(ask.words[0]);
      return inOrder(done, [this, done, file = ask.words[0]] {
        served_.save(file,
                     [done](const LiveVolume::Saved& saved) { done(saved.refusal, saved.written ? saved.words : ""); });
      });
    case wire::Verb::Filter:
      checkWords(ask, 1, 1);
      return served_.filter(ask.words[0], [done, chain = ask.words[0]](const std::optional<Error>& refusal) {
        done(refusal, chain.empty() ? "felt as it is, without filters" : "felt through " + chain);
      });
    case wire::Verb::Render:
      return askForPicture(ask, client);
    case wire::Verb::Leave:
      leaves_ = true;
      return done({}, "the service ends");
  }
  refuseOtherVersion("the question", "this program does not know it");
}

std::string ClientDesk::warningLines() const {
  std::string lines;
  for (const std::string& warning : served_.warnings()) lines += warning + "\n";
  return lines;
}

// What is asked for after an edit whose mesh is still being read waits for it.
void ClientDesk::inOrder(const Answer& done, const std::function<void()>& request, Takes takes) {
  if (takes == Takes::kNoTime && preparer_.idle()) return request();
  if (preparer_.waiting() >= kMostPrepared)  // also of clients that have gone
    throw Error(Error::Code::kOutOfMemory, "the question", "too many wait for meshes that are being read",
                "ask again in a moment");
  preparer_.add([done, request] {
    try {
      request();
    } catch (const Error& error) {
      done(error, {});
    } catch (const std::exception& error) {
      done(Error(Error::Code::kOutOfMemory, "the question", error.what(), "ask for less"), {});
    }
  });
}

void ClientDesk::askForEdit(const wire::AskT& ask, const Answer& done) {
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

void ClientDesk::edit(const std::vector<std::string>& words, const Answer& done) {
  std::vector<EditCommand> commands;
  for (const std::string& word : words) {
    EditText text = editText(word, EditUse::kPlaced, word);
    if (!text.mesh_file.empty()) text.command.stamp = stamps_.stampOf(text);
    for (EditCommand& command : withMirror(text.command, text.mirror_axis, served_.size(), served_.lattice()))
      commands.push_back(std::move(command));
  }
  const std::size_t count = commands.size();
  served_.edit(std::move(commands), [this, done, count](const std::optional<Error>& refusal) {
    done(refusal, fmt::format("{} edit{} made{}", count, count == 1 ? "" : "s",
                              served_.keepsJournal() ? ", and on the disk" : ""));
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
  served_.render(width, height,
                 [this, file, number = client.number, asked = ask.number](const PictureQueue::Picture& picture,
                                                                          const std::string& failure) {
                   packer_.add([this, file, picture, failure, number, asked] {
                     std::optional<Error> refusal;
                     try {
                       if (!picture) throw Error(Error::Code::kDevice, "the picture", failure, "ask again");
                       writePicture(file, *picture);
                     } catch (const Error& error) {
                       refusal = error;
                     } catch (const std::exception& error) {
                       refusal = Error(Error::Code::kOutOfMemory, "the picture", error.what(), "ask for a smaller one");
                     }
                     const std::string words =
                         refusal ? std::string()
                                 : fmt::format("{}: {} x {} pixels", file, picture->width, picture->height);
                     answer(number, [asked, refusal, words] { return answerOf(asked, refusal, words); });
                   });
                 });
}

void ClientDesk::askForStatus(const wire::AskT& ask, Client& client) {
  ServedStatus status = served_.status();
  status.clients = clients_.size();
  wire::AnswerT words;
  words.number = ask.number;
  for (const auto& [key, value] : figuresOf(status, monotonicNow_ns())) {
    words.figures.push_back(std::make_unique<wire::FigureT>());
    words.figures.back()->key = key;
    words.figures.back()->value = value;
  }
  words.text = status.journal_failure;
  answerNow(client, std::move(words));
}

void ClientDesk::answerNow(Client& client, wire::AnswerT answer, int attached) {
  if (!client.channel.send(encoded(std::move(answer)), 0, attached)) client.channel.close();
}

void ClientDesk::letLookOn(const wire::AskT& ask, Client& client) {
  wire::AnswerT answer;
  answer.number = ask.number;
  try {
    if (ask.verb == wire::Verb::LookOn) {
      checkWords(ask, 0, 0);
      letGo(client);
      client.onlooker = served_.lookOn();
      answer.facts = wireOf(served_.facts());
      return answerNow(client, std::move(answer), client.onlooker->descriptor());
    }
    checkWords(ask, 0, 1);
    std::optional<std::uint64_t> known;
    if (!ask.words.empty()) known = countOf(ask.words[0]);
    answer.looked = wireOf(served_.looked(onlookerOf(client.onlooker), known));
  } catch (const Error& error) {
    answer = answerOf(ask.number, error, {});
  }
  answerNow(client, std::move(answer));
}

void ClientDesk::askFromAWindow(const wire::AskT& ask, const Answer& done, Client& client) {
  Onlooker& onlooker = onlookerOf(client.onlooker);
  switch (ask.verb) {
    case wire::Verb::Show:
      served_.show(onlooker, viewOf(ask.view));
      break;
    case wire::Verb::Hold:
      checkWords(ask, 1, 1);
      return inOrder(done, [this, done, one = client.onlooker, turn = served_.askToHold(onlooker),
                            brush = toolBrushSpec(ask.words[0])] {
        served_.hold(one, turn, brush);
        done({}, {});
      });
    case wire::Verb::Release:
      served_.release(client.onlooker);
      break;
    case wire::Verb::GoTo:
      checkWords(ask, 1, 1);
      return inOrder(done, [this, done, count = countOf(ask.words[0])] {
        served_.goTo(count);
        done({}, {});
      });
    default:
      return served_.change(settingsOf(ask.settings),
                            [done](const std::optional<Error>& refusal) { done(refusal, {}); });
  }
  done({}, {});
}

void ClientDesk::letGo(Client& client) {
  if (client.onlooker) served_.leave(std::exchange(client.onlooker, nullptr));
}

}  // namespace palpate
