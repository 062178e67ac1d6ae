// SPDX-License-Identifier: Apache-2.0
// palpate ctl: asks a service for edits, files, settings and pictures; palpate top: watches one.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/serve/service_client.hpp"
#include "apps/serve/service_place.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/units.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

using Words = std::vector<std::string>;

constexpr int kLong_ms = 24 * 3'600'000;  // a large volume on a slow disk

struct CtlArguments {
  std::string socket = usualSocket();
  Words words;
  std::string file, key, value;
  int width = 1280, height = 720;
};

std::string absolute(const std::string& file) {
  return std::filesystem::absolute(file).lexically_normal().string();
}

void tellAnswer(const ServiceAnswer& answer) {
  if (answer.text.empty()) return;
  printText(answer.text.ends_with('\n') ? answer.text : answer.text + "\n");
}

CLI::App* addAsking(
    CLI::App& ctl, const std::shared_ptr<CtlArguments>& arguments, const char* name, const char* help, wire::Verb verb,
    const std::function<Words(const CtlArguments&)>& words = [](const CtlArguments&) { return Words{}; }) {
  CLI::App* const sub = ctl.add_subcommand(name, help);
  sub->fallthrough();  // takes --socket, too
  sub->callback([arguments, verb, words] {
    tellAnswer(ServiceClient(arguments->socket).ask(verb, words(*arguments), kLong_ms));
  });
  return sub;
}

nlohmann::json figuresOf(const ServiceAnswer& answer) {
  nlohmann::json json = {{"schema", "palpate.status/1"}};
  for (const auto& [key, value] : answer.figures) json[key] = value;
  json["journal_failure"] = answer.text;
  return json;
}

}  // namespace

void addCtlVerb(CLI::App& app) {
  CLI::App* ctl = app.add_subcommand("ctl", "ask a service for edits, files, settings and pictures");
  ctl->footer(
      "Each waits until it has come about; an edit that is answered is on the disk.\n"
      "Example: palpate ctl edit remove:radius=2mm:at=10,20,30mm");
  ctl->require_subcommand(1);
  auto arguments = std::make_shared<CtlArguments>();
  ctl->add_option("--socket", arguments->socket, "where the service listens")->capture_default_str()->check(notEmpty);
  const auto words = [](const CtlArguments& a) { return a.words; };
  const auto file = [](const CtlArguments& a) { return Words{absolute(a.file)}; };
  addAsking(*ctl, arguments, "edit", "make edits, together (docs/edits.md)", wire::Verb::Edit, words)
      ->add_option("edits", arguments->words, "as remove:radius=2mm:at=10,20,30mm")
      ->required();
  addAsking(*ctl, arguments, "undo", "undo the last edit", wire::Verb::Undo);
  addAsking(*ctl, arguments, "redo", "make it again", wire::Verb::Redo);
  addAsking(*ctl, arguments, "save", "write the volume with every edit", wire::Verb::Save, file)
      ->add_option("file", arguments->file, "its suffix says the format")
      ->required();
  addAsking(*ctl, arguments, "export", "write the isosurface as a mesh", wire::Verb::Save, file)
      ->add_option("file", arguments->file, "as skull.stl")
      ->required();
  CLI::App* const set = addAsking(*ctl, arguments, "set", "change a setting while it is served (docs/service.md)",
                                  wire::Verb::Set, [](const CtlArguments& a) {
                                    return Words{a.key, a.value};
                                  });
  set->add_option("key", arguments->key, "as servo.stiffness_N_per_m")->required();
  set->add_option("value", arguments->value, "as 800, in the unit that the key names")->required();
  addAsking(*ctl, arguments, "get", "print settings", wire::Verb::Get, words)
      ->add_option("keys", arguments->words, "all if none is named");
  CLI::App* const render = addAsking(
      *ctl, arguments, "render", "draw the object as it is now", wire::Verb::Render, [](const CtlArguments& a) {
        return Words{absolute(a.file), std::to_string(a.width), std::to_string(a.height)};
      });
  render->add_option("file", arguments->file, "a .png")->required();
  render->add_option("--width", arguments->width, "[pixel]")->capture_default_str();
  render->add_option("--height", arguments->height, "[pixel]")->capture_default_str();
  CLI::App* const status = ctl->add_subcommand("status", "print how the service is, as JSON");
  status->fallthrough();
  status->callback(
      [arguments] { printText(figuresOf(ServiceClient(arguments->socket).ask(wire::Verb::Status)).dump(2) + "\n"); });
  CLI::App* const metrics =
      ctl->add_subcommand("metrics", "print the same as Prometheus' text, for its textfile collector");
  metrics->fallthrough();
  metrics->callback([arguments] {
    for (const auto& [key, value] : ServiceClient(arguments->socket).ask(wire::Verb::Status).figures)
      printText(fmt::format("# TYPE palpate_{0} gauge\npalpate_{0} {1}\n", key, value));
  });
  addAsking(*ctl, arguments, "stop", "end the service in good order", wire::Verb::Leave);
}

void addTopVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("top", "watch a service: servo, force, edits, ages and faults");
  struct TopArguments {
    std::string socket = usualSocket();
    double every_s = 0.5;
    int count = 0;
  };
  auto arguments = std::make_shared<TopArguments>();
  verb->add_option("--socket", arguments->socket, "where the service listens")->capture_default_str()->check(notEmpty);
  verb->add_option("--every", arguments->every_s, "time between looks [s]")
      ->capture_default_str()
      ->check(numberFrom(0.05, 3600));
  verb->add_option("--count", arguments->count, "looks, then it ends; 0: until Ctrl-C")
      ->capture_default_str()
      ->check(numberFrom(0, 1e9));
  verb->callback([arguments] {
    ServiceClient client(arguments->socket);
    double last_tick = -1;
    std::int64_t last_ns = 0;
    printText("servo  ticks/s  pose age [ms]  force [N]  contact  windows  edits  undo/redo  to disk  clients\n");
    for (int look = 0; arguments->count == 0 || look < arguments->count; ++look) {
      const nlohmann::json now = figuresOf(client.ask(wire::Verb::Status));
      const auto value = [&](const char* key) { return now.value(key, 0.0); };
      const std::int64_t now_ns = monotonicNow_ns();
      const double passed_s = static_cast<double>(now_ns - last_ns) / kNanosecondsPerSecond;
      const double rate = last_tick < 0 ? 0 : std::max(0.0, value("tick") - last_tick) / passed_s;
      last_tick = value("tick");
      last_ns = now_ns;
      printText(fmt::format(
          "{:<5}  {:>7.0f}  {:>13.1f}  {:>9.2f}  {:<7}  {:>7.0f}  {:>5.0f}  {:>4.0f}/{:<4.0f}  {:>7.0f}  {:>7.0f}\n",
          value("servo") > 0 ? "on" : "off", rate, value("pose_age_ms"), value("force_N"),
          value("contact") > 0 ? "yes" : "no", value("windows"), value("edits"), value("undoable"), value("redoable"),
          value("waiting_for_disk"), value("clients")));
      for (double waited_s = 0; waited_s < arguments->every_s; waited_s += 0.05) {
        throwIfInterrupted("palpate top", "the service goes on");
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    }
  });
}

}  // namespace palpate
