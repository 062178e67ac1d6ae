// SPDX-License-Identifier: Apache-2.0
#include "hostile_messages.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "apps/servo_side/wire_settings.hpp"
#include "service/memory/link_memory.hpp"
#include "service/messages/message.hpp"

namespace palpate {
namespace {

std::string textOf(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::byte> bytesOf(const std::string& text) {
  const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

std::vector<std::byte> ask(wire::Verb verb, std::vector<std::string> words, std::uint64_t number = 1) {
  wire::AskT ask = asking(verb);
  ask.number = number;
  ask.words = std::move(words);
  return encoded(std::move(ask));
}

wire::VectorT vector(double x, double y, double z) {
  wire::VectorT v;
  v.x = x;
  v.y = y;
  v.z = z;
  return v;
}

wire::DeviceMadeT deviceMade() {
  wire::DeviceMadeT made;
  made.name = "simulated";
  made.force_limit_N = 8;
  made.slew_limit_N_per_s = 4000;
  made.hands.push_back(std::make_unique<wire::HandT>());
  return made;
}

wire::HelloT hello() {
  wire::HelloT words;
  words.layout = kLinkLayout;
  words.commit = "0123456789";
  words.first_version = 1;
  words.stays = true;
  return words;
}

std::vector<std::string> corpus() {
  std::vector<std::string> all;
  const auto add = [&](const std::vector<std::byte>& bytes) { all.push_back(textOf(bytes)); };
  add(encoded(hello()));
  add(encoded(deviceMade()));
  add(encoded(wire::LoopMadeT{}));
  add(encoded(wire::StartT{}));
  add(encoded(wire::StopT{}));
  add(encoded(wire::StepT{}));
  add(encoded(wire::GoT{}));
  add(encoded(wire::ChangeEndedT{}));
  add(encoded(wire::EndedT{}));
  add(encoded(wire::MeshT{}));
  add(encoded(wire::MakeDeviceT{}));
  add(encoded(wire::MakeLoopT{}));
  add(encoded(wire::ChangeT{}));
  add(encoded(wire::RefusalT{}));
  add(encoded(wire::AnswerT{}));
  add(ask(wire::Verb::Status, {}));
  add(ask(wire::Verb::Get, {"servo.n", "isovalue"}));
  add(ask(wire::Verb::Set, {"servo.n", "7"}));
  add(ask(wire::Verb::Edit, {"remove:radius=2mm:at=1,2,3mm", "add:radius=2mm:from=1,2,3mm:to=4,5,6mm:mirror=x"}));
  add(ask(wire::Verb::Save, {"/tmp/a.vdb"}));
  add(ask(wire::Verb::Render, {"/tmp/a.png", "640", "480"}));
  add(ask(wire::Verb::Filter, {"median:1 gaussian:0.8mm"}));
  add(encoded(wire::DeviceStateT{}));
  add(ask(wire::Verb::LookOn, {}));
  add(ask(wire::Verb::Look, {"7"}));
  return all;
}

// Whether it is a question that may do something if its words are right.
bool mayDoSomething(const std::vector<std::byte>& bytes) {
  try {
    wire::BodyUnion body = decoded(bytes, "the test");
    const auto* const question = contentOf<wire::AskT>(body);
    constexpr wire::Verb kHarmless[] = {wire::Verb::Status, wire::Verb::Get, wire::Verb::LookOn, wire::Verb::Look};
    return question != nullptr && std::ranges::find(kHarmless, question->verb) == std::end(kHarmless);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

HostileMessages::HostileMessages(std::uint64_t seed) : random_(seed), mutator_(corpus(), seed + 1) {}

std::vector<std::byte> HostileMessages::noise() {
  std::vector<std::byte> bytes(below(8) == 0 ? 65'000 + below(5000) : 1 + below(300));
  for (std::byte& one : bytes) one = static_cast<std::byte>(below(256));
  return bytes;
}

std::vector<std::byte> HostileMessages::changedMessage() {
  while (true) {
    std::vector<std::byte> bytes = bytesOf(mutator_.next());
    if (!bytes.empty() && !mayDoSomething(bytes)) return bytes;
  }
}

std::string HostileMessages::word() {
  static const std::string kWords[] = {"",
                                       "nan",
                                       "-inf",
                                       "1e999",
                                       "%s%n",
                                       "../../../etc/passwd",
                                       "\xff\xfe",
                                       std::string(30'000, 'x'),
                                       "servo.n",
                                       "remove",
                                       "remove:radius=nan:at=1,1,1mm",
                                       "add:radius=1e308mm:at=0,0,0mm",
                                       "add:radius=2mm:at=1e300,0,0mm",
                                       "add:radius=-1mm:at=0,0,0mm",
                                       "remove:radius=2mm:at=inf,0,0mm",
                                       "stamp-add:mesh=/dev/zero:at=0,0,0mm",
                                       "stamp-add:mesh=/none/a.stl:at=0,0,0mm",
                                       "add:radius=2mm:at=1,1,1mm:at=2,2,2mm",
                                       "undo",
                                       "redo:1",
                                       "18446744073709551616",
                                       "-1",
                                       "0x10",
                                       "gaussian:",
                                       "gaussian:1e9mm",
                                       "/none/of/these/a.vdb",
                                       "/proc/self/mem",
                                       "a.vdb",
                                       std::string("a\0b", 3)};
  return kWords[below(std::size(kWords))];
}

// What a window asks for, with a number that cannot be.
std::vector<std::byte> HostileMessages::refusedView() {
  wire::AskT ask = asking(wire::Verb::Show);
  ask.view = std::make_unique<wire::ViewT>();
  wire::ViewT& view = *ask.view;
  const auto along = [](double x, double y, double z) { return std::make_unique<wire::VectorT>(vector(x, y, z)); };
  view.position = along(0, -0.1, 0);
  view.forward = along(0, 1, 0);
  view.right = along(1, 0, 0);
  view.up = along(0, 0, 1);
  view.vertical_fov_rad = 0.5;
  view.width = 64;
  view.height = 48;
  const double bad[] = {1e308, std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()};
  double* const numbers[] = {&view.forward->x, &view.right->y, &view.up->z, &view.vertical_fov_rad};
  switch (below(4)) {
    case 0:
      *numbers[below(std::size(numbers))] = bad[below(std::size(bad))];
      break;
    case 1:
      (below(2) == 0 ? view.width : view.height) =
          static_cast<std::int32_t>(below(2) == 0 ? random_() | 0x80000000U : 0);
      break;
    case 2:
      for (std::size_t left = 17 + below(100); left > 0; --left) view.clips.push_back(std::make_unique<wire::PlaneT>());
      break;
    default:
      view.up.reset();
  }
  return encoded(std::move(ask));
}

// What a window asks for with its sliders, with one that cannot be.
std::vector<std::byte> HostileMessages::refusedSettings() {
  wire::AskT ask = asking(wire::Verb::Change);
  ask.before = wireOf(RigSettings{});
  ask.settings = wireOf(RigSettings{});
  wire::SettingsT& settings = *ask.settings;
  const double bad[] = {-1, -1e300, std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()};
  double* const numbers[] = {&settings.stiffness_N_per_m, &settings.damping_Ns_per_m, &settings.force_limit_N,
                             &settings.friction_static, &settings.friction_dynamic};
  switch (below(3)) {
    case 0:
      *numbers[below(std::size(numbers))] = bad[below(std::size(bad))];
      break;
    case 1:
      settings.algorithm = "melt" + word();
      break;
    default:
      settings.isovalue = std::numeric_limits<double>::quiet_NaN();
  }
  return encoded(std::move(ask));
}

// Each verb with words of which at least one cannot be.
std::vector<std::byte> HostileMessages::refusedQuestion() {
  const std::uint64_t number = below(4) == 0 ? std::numeric_limits<std::uint64_t>::max() : below(1000);
  switch (below(15)) {
    case 0:
      return ask(wire::Verb::Get, {"no." + word(), word()}, number);
    case 1:
      return ask(wire::Verb::Set, {"no." + word(), word()}, number);
    case 2:
      return ask(wire::Verb::Set, {"servo.stiffness_N_per_m", below(2) == 0 ? "nan" : "-" + word()}, number);
    case 3:
      return ask(wire::Verb::Edit, {"add:radius=1mm:at=0,0,0mm", "melt:" + word()}, number);
    case 4:
      return ask(wire::Verb::Edit, std::vector<std::string>(below(2) == 0 ? 0 : 257, "undo"), number);
    case 5:
      return ask(wire::Verb::Save, {"none/" + word()}, number);  // no whole path
    case 6:
      return ask(wire::Verb::Render, {"/none/a.png", word(), word()}, number);
    case 7:
      return ask(wire::Verb::Filter, {"melt:" + word()}, number);
    case 8:
      return ask(wire::Verb::Hold, {"melt:" + word()}, number);
    case 9:
      return ask(wire::Verb::GoTo, {"-" + word()}, number);
    case 10:
      return ask(wire::Verb::Look, {"x" + word()}, number);
    case 11:
      return ask(wire::Verb::Change, {word()}, number);  // without settings
    case 12:
      return refusedView();
    case 13:
      return refusedSettings();
    default:
      return ask(static_cast<wire::Verb>(20 + below(230)), {word(), word()}, number);
  }
}

std::vector<std::byte> HostileMessages::next() {
  switch (below(8)) {
    case 0:
      return noise();
    case 1:
    case 2:
    case 3:
      return changedMessage();
    case 4: {
      constexpr wire::Verb kHarmless[] = {wire::Verb::Status, wire::Verb::Get, wire::Verb::LookOn, wire::Verb::Look};
      return ask(kHarmless[below(std::size(kHarmless))], {}, below(5));
    }
    default:
      return refusedQuestion();
  }
}

std::vector<std::byte> HostileMessages::nextOfAServo() {
  switch (below(6)) {
    case 0: {
      wire::DeviceMadeT made = deviceMade();
      const double bad[] = {-1, 0, 1e308, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity()};
      double* const numbers[] = {&made.force_limit_N,         &made.slew_limit_N_per_s,
                                 &made.workspace_radius_m,    &made.stiffness_limit_N_per_m,
                                 &made.position_resolution_m, &made.hands[0]->hand_mass_kg};
      *numbers[below(std::size(numbers))] = bad[below(std::size(bad))];
      made.force_delay_ticks = static_cast<std::int32_t>(below(3)) - 1;
      made.force_off = static_cast<std::uint8_t>(below(256));
      return encoded(std::move(made));
    }
    case 1:
      return encoded(wire::LoopMadeT{});
    case 2: {
      wire::ChangeEndedT ended;
      ended.number = random_();
      return encoded(ended);
    }
    case 3: {
      wire::EndedT ended;
      ended.records = random_();
      ended.recording_bytes = random_();
      return encoded(std::move(ended));
    }
    case 4:
      return noise();
    default:
      return changedMessage();
  }
}

}  // namespace palpate
