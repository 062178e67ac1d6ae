// SPDX-License-Identifier: Apache-2.0
// palpate ctl: asks a service for edits, files, settings and pictures.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/console/message.hpp"
#include "apps/serve/served_status.hpp"
#include "apps/serve/service_client.hpp"
#include "base/error.hpp"
#include "base/json_text.hpp"
#include "service/channel/usual_socket.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

using Words = std::vector<std::string>;

constexpr int kLong_ms = 24 * 3'600'000;  // a large volume on a slow disk

struct CtlArguments {
  std::string socket = usualSocket();
  Words words;
  std::string file, key, value, filter;
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
    Words asked = words(*arguments);  // first: what is refused here needs no service
    tellAnswer(ServiceClient(arguments->socket).ask(verb, std::move(asked), kLong_ms));
  });
  return sub;
}

// The service does not know where this program was started.
Words withWholePaths(Words edits) {
  constexpr std::string_view kMesh = ":mesh=";
  for (std::string& edit : edits) {
    const std::size_t key = edit.find(kMesh);
    if (key == std::string::npos) continue;
    const std::size_t begin = key + kMesh.size(), end = std::min(edit.find(':', begin), edit.size());
    if (end > begin) edit.replace(begin, end - begin, absolute(edit.substr(begin, end - begin)));
  }
  return edits;
}

// "KEY VALUE" or "KEY=VALUE".
Words keyAndValue(const std::string& key, const std::string& value) {
  if (!value.empty()) return {key, value};
  const std::size_t sign = key.find('=');
  if (sign == std::string::npos)
    refuse(key, "no value is given for it", fmt::format("as 'palpate ctl set {} VALUE'", key));
  return {key.substr(0, sign), key.substr(sign + 1)};
}

nlohmann::json statusOf(const ServiceAnswer& answer) {
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
  addAsking(*ctl, arguments, "edit", "make edits, together (docs/edits.md)", wire::Verb::Edit,
            [](const CtlArguments& a) { return withWholePaths(a.words); })
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
                                  wire::Verb::Set, [](const CtlArguments& a) { return keyAndValue(a.key, a.value); });
  set->add_option("key", arguments->key, "as servo.stiffness_N_per_m")->required();
  set->add_option("value", arguments->value, "as 800, in the unit that the key names; or KEY=VALUE in one word");
  set->footer("Example: palpate ctl set servo.stiffness_N_per_m 800");
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
      [arguments] { printText(jsonFileText(statusOf(ServiceClient(arguments->socket).ask(wire::Verb::Status)))); });
  CLI::App* const metrics =
      ctl->add_subcommand("metrics", "print the same as Prometheus' text, for its textfile collector");
  metrics->fallthrough();
  metrics->callback(
      [arguments] { printText(metricsText(ServiceClient(arguments->socket).ask(wire::Verb::Status).figures)); });
  addAsking(*ctl, arguments, "filter", "feel the volume through other filters (docs/filters.md)", wire::Verb::Filter,
            [](const CtlArguments& a) { return Words{a.filter}; })
      ->add_option("filters", arguments->filter, "as \"median:1 gaussian:0.8mm\"; none if not given");
  ctl->get_subcommand("filter")->footer("Example: palpate ctl filter \"median:1 gaussian:0.8mm\"");
  addAsking(*ctl, arguments, "stop", "end the service in good order", wire::Verb::Leave);
}

}  // namespace palpate
