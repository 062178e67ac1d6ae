// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/device_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "apps/devices/device_files.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/nearest_word.hpp"
#include "base/user_folders.hpp"
#include "base/whole_file.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// Where something is in a file, for messages.
std::string placeOf(const toml::node& node, const std::string& file) {
  return fmt::format("{}:{}:{}", file, node.source().begin.line, node.source().begin.column);
}

std::optional<std::pair<std::uint16_t, std::uint16_t>> hexPair(std::string_view text) {
  const auto hex = [](std::string_view digits) -> std::optional<std::uint16_t> {
    std::uint16_t value = 0;
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (digits.empty() || digits.size() > 4 || code != std::errc() || end != digits.data() + digits.size()) return {};
    return value;
  };
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return {};
  const auto first = hex(text.substr(0, colon)), second = hex(text.substr(colon + 1));
  if (!first || !second) return {};
  return std::pair(*first, *second);
}

class KindReader {
 public:
  KindReader(const toml::table& table, const std::string& file) : table_(table), file_(file) {}

  DeviceKind kind() {
    static const std::vector<std::string> kKeys = {"name", "family", "what", "usb", "usage", "values"};
    for (const auto& [key, node] : table_) {
      const std::string word(key.str());
      if (std::ranges::find(kKeys, word) == kKeys.end()) {
        refuse(placeOf(node, file_), fmt::format("a device has no key '{}'", word),
               withDidYouMean(word, kKeys, "the keys are " + listed(kKeys)));
      }
    }
    kind_.file = file_;
    kind_.name = text("name");
    kind_.family = text("family");
    kind_.what = text("what");
    checkFamily();
    if (const toml::node* usage = table_.get("usage")) kind_.usage = pairOf(*usage, "usage", "ffab:0200");
    if (const toml::node* values = table_.get("values")) readValues(*values, kind_.values, {});
    readUsb();
    checkTogether();
    return std::move(kind_);
  }

 private:
  const toml::node& needed(const char* key) const {
    if (const toml::node* node = table_.get(key)) return *node;
    refuse(placeOf(table_, file_), fmt::format("a device has no '{}'", key), fmt::format("give it one: {} = ...", key));
  }
  std::string text(const char* key) const {
    const toml::node& node = needed(key);
    const auto value = node.value<std::string>();
    if (!value || value->empty())
      refuse(placeOf(node, file_), fmt::format("'{}' is no text", key), "give it in quotes");
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
    if (std::ranges::any_of(*value, is_control))
      refuse(placeOf(node, file_), fmt::format("'{}' has a control character", key), "give printable text of one line");
    return *value;
  }
  std::pair<std::uint16_t, std::uint16_t> pairOf(const toml::node& node, const char* what, const char* example) const {
    const auto value = node.value<std::string>();
    const auto pair = value ? hexPair(*value) : std::nullopt;
    if (!pair) {
      refuse(placeOf(node, file_), fmt::format("'{}' is not two hexadecimal numbers", what),
             fmt::format("give them as \"{}\"", example));
    }
    return *pair;
  }

  void checkFamily() {
    std::vector<std::string> families;
    for (const DeviceEntry& entry : devices()) {
      if (entry.needs_port) families.emplace_back(entry.name);
      if (entry.needs_port && entry.name == kind_.family) family_ = &entry;
    }
    if (family_ == nullptr) {
      refuse(placeOf(needed("family"), file_), fmt::format("there is no family '{}'", kind_.family),
             withDidYouMean(kind_.family, families, "the families are " + listed(families)));
    }
    for (const DeviceEntry& entry : devices()) {
      if (entry.name == kind_.name)
        refuse(placeOf(needed("name"), file_), fmt::format("'{}' is a name of its own", kind_.name), "choose another");
    }
  }

  void readValues(const toml::node& node, DeviceValues& values, const std::string& but) const {
    const toml::table* table = node.as_table();
    if (table == nullptr) refuse(placeOf(node, file_), "values are no table", "give them as { force_limit_N = 5 }");
    const std::span<const DeviceParameter> parameters = family_->parameters();
    for (const auto& [key, value] : *table) {
      const std::string word(key.str());
      if (word == but) continue;
      const auto known = std::ranges::find(parameters, std::string_view(word), &DeviceParameter::key);
      if (known == parameters.end()) {
        std::vector<std::string> keys;
        for (const DeviceParameter& p : parameters) keys.emplace_back(p.key);
        refuse(placeOf(value, file_), fmt::format("family {} has no value '{}'", kind_.family, word),
               withDidYouMean(word, keys, fmt::format("it has {}", listed(keys))));
      }
      const auto number = value.is_number() ? value.value<double>() : std::nullopt;
      if (!number) {
        refuse(placeOf(value, file_), fmt::format("'{}' is no number", word),
               fmt::format("give {:g} to {:g} {}", known->lowest, known->highest, known->unit));
      }
      if (!(*number >= known->lowest && *number <= known->highest)) {
        refuse(placeOf(value, file_), fmt::format("'{}' is out of range", word),
               fmt::format("give {:g} to {:g} {}", known->lowest, known->highest, known->unit));
      }
      if (known->is_whole && *number != std::round(*number))
        refuse(placeOf(value, file_), fmt::format("'{}' is no whole number", word), "give one");
      values[word] = *number;
    }
  }

  // What each value allows alone may not go together.
  void checkTogether() const {
    for (const UsbId& usb : kind_.usb) {
      DeviceValues values = kind_.values;
      for (const auto& [key, value] : usb.values) values[key] = value;
      try {
        if (family_->check != nullptr) family_->check(values);
      } catch (const Error& error) {
        refuse(placeOf(table_, file_), fmt::format("{}: {}", error.input(), error.reason()), error.remedy());
      }
    }
  }

  void readUsb() {
    const toml::node& node = needed("usb");
    const toml::array* ids = node.as_array();
    if (ids == nullptr || ids->empty())
      refuse(placeOf(node, file_), "'usb' names no USB numbers", "give it as [\"1234:0006\"]");
    for (const toml::node& id : *ids) {
      UsbId usb;
      const toml::table* table = id.as_table();
      const toml::node* numbers = table != nullptr ? table->get("id") : &id;
      if (numbers == nullptr) refuse(placeOf(id, file_), "it has no 'id'", "give it as { id = \"1234:0006\" }");
      std::tie(usb.vendor, usb.product) = pairOf(*numbers, "usb", "1234:0006");
      if (table != nullptr) readValues(id, usb.values, "id");
      kind_.usb.push_back(std::move(usb));
    }
  }

  const toml::table& table_;
  const std::string& file_;
  DeviceKind kind_;
  const DeviceEntry* family_ = nullptr;
};

void addKinds(std::vector<DeviceKind>& all, std::vector<DeviceKind> more) {
  for (DeviceKind& kind : more) {
    const auto known = std::ranges::find(all, kind.name, &DeviceKind::name);
    if (known == all.end())
      all.push_back(std::move(kind));
    else
      *known = std::move(kind);
  }
}

std::vector<fs::path> tomlFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

std::vector<DeviceKind> kindsOfFile(const fs::path& file) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 20U;
  return readDeviceKinds(wholeFile(file, "the table of devices", kMostBytes), file.string());
}

struct Known {
  std::vector<DeviceKind> kinds;
  std::vector<std::string> complaints, names;
};

const Known& known() {
  static const Known kKnown = [] {
    Known known;
    known.kinds = readDeviceKinds(kDevicesToml, "");
    for (const fs::path& file : tomlFiles(userDeviceFolder())) {
      try {
        addKinds(known.kinds, kindsOfFile(file));
      } catch (const Error& error) {
        known.complaints.emplace_back(error.what());
      }
    }
    for (const DeviceEntry& entry : devices()) {
      if (!entry.needs_port) known.names.emplace_back(entry.name);
    }
    for (const DeviceKind& kind : known.kinds) known.names.push_back(kind.name);
    return known;
  }();
  return kKnown;
}

}  // namespace

const UsbId* DeviceKind::idOf(std::uint16_t vendor, std::uint16_t product) const noexcept {
  const auto id = std::ranges::find_if(usb, [&](const UsbId& u) { return u.vendor == vendor && u.product == product; });
  return id == usb.end() ? nullptr : &*id;
}

std::vector<double> DeviceKind::eachValueOf(std::string_view key) const {
  const std::span<const DeviceParameter> parameters = deviceEntry(family).parameters();
  const auto parameter = std::ranges::find(parameters, key, &DeviceParameter::key);
  if (parameter == parameters.end()) return {};
  std::vector<double> each;
  for (const UsbId& id : usb) {
    double value = parameter->usual;
    for (const DeviceValues* const stated : {&values, &id.values}) {
      if (const auto found = stated->find(std::string(key)); found != stated->end()) value = found->second;
    }
    each.push_back(value);
  }
  return each;
}

std::string usbText(std::uint16_t vendor, std::uint16_t product) {
  return fmt::format("{:04x}:{:04x}", vendor, product);
}

std::vector<DeviceKind> readDeviceKinds(std::string_view text, const std::string& file) {
  toml::table root;
  try {
    root = toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    refuse(fmt::format("{}:{}:{}", file, error.source().begin.line, error.source().begin.column),
           std::string(error.description()), "mend the TOML there");
  }
  for (const auto& [key, node] : root) {
    if (key.str() != "device")
      refuse(placeOf(node, file), fmt::format("there is no key '{}'", key.str()), "give tables of [[device]]");
  }
  std::vector<DeviceKind> kinds;
  const toml::node* const node = root.get("device");
  const toml::array* const array = node != nullptr ? node->as_array() : nullptr;
  if (node != nullptr && array == nullptr)
    refuse(placeOf(*node, file), "'device' is no list of tables", "give tables of [[device]]");
  if (array == nullptr) return kinds;
  for (const toml::node& entry : *array) {
    const toml::table* const table = entry.as_table();
    if (table == nullptr) refuse(placeOf(entry, file), "it is no table", "give tables of [[device]]");
    DeviceKind kind = KindReader(*table, file).kind();
    if (std::ranges::find(kinds, kind.name, &DeviceKind::name) != kinds.end())
      refuse(placeOf(entry, file), fmt::format("'{}' is there twice", kind.name), "give one of them another name");
    kinds.push_back(std::move(kind));
  }
  return kinds;
}

fs::path userDeviceFolder() {
  const fs::path settings = settingsFolder();
  return settings.empty() ? settings : settings / "devices";
}

std::vector<DeviceKind> deviceKinds(const fs::path& folder) {
  std::vector<DeviceKind> all = readDeviceKinds(kDevicesToml, "");
  for (const fs::path& file : tomlFiles(folder)) addKinds(all, kindsOfFile(file));
  return all;
}

std::span<const DeviceKind> knownDeviceKinds() {
  return known().kinds;
}

const std::vector<std::string>& deviceKindComplaints() {
  return known().complaints;
}

const std::vector<std::string>& deviceNamesForUsers() {
  return known().names;
}

const DeviceKind* deviceKindNamed(const std::string& name) {
  for (const DeviceKind& kind : known().kinds) {
    if (kind.name == name) return &kind;
  }
  const std::vector<std::string>& names = known().names;
  if (std::ranges::find(names, name) != names.end()) return nullptr;
  std::string remedy = withDidYouMean(name, names, fmt::format("choose one of {}", listed(names)));
  for (const std::string& complaint : known().complaints) remedy += fmt::format(" ({})", complaint);
  refuse(fmt::format("device \"{}\"", name), "there is none of this name", remedy);
}

}  // namespace palpate
