// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/result_file.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/outside_text.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void refuseResult(const std::string& name, const std::string& reason) {
  refuse(name, reason, "give a file that 'palpate bench NAME --json' has written");
}

// Text from outside that stands in a message.
std::string quoted(const std::string& text) {
  constexpr std::size_t kMost = 40;
  return "'" + oneLine(text.size() <= kMost ? text : text.substr(0, kMost) + "...") + "'";
}

std::string textIn(const Json& object, const char* key, const std::string& name) {
  const auto at = object.find(key);
  if (at == object.end() || !at->is_string()) refuseResult(name, fmt::format("it has no text '{}'", key));
  return at->get<std::string>();
}

const Json& listIn(const Json& object, const char* key, const std::string& name) {
  const auto at = object.find(key);
  if (at == object.end() || !at->is_array()) refuseResult(name, fmt::format("it has no list '{}'", key));
  return *at;
}

// Whole numbers beyond those of 64 bits are doubles.
BenchFigure figureFrom(const Json& value, const std::string& name, const std::string& where) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_null()) return kNoFigure;
  const bool huge = value.is_number_unsigned() &&
                    value.get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (value.is_number_integer() && !huge) return value.get<std::int64_t>();
  if (value.is_number()) return value.get<double>();
  refuseResult(name, fmt::format("{} is no text and no number", where));
}

BenchRow rowFrom(const Json& object, const std::string& name, std::size_t number) {
  if (!object.is_object()) refuseResult(name, fmt::format("row {} is no object", number));
  BenchRow row;
  for (const auto& [key, value] : object.items()) {
    row.emplace_back(key, figureFrom(value, name, fmt::format("{} of row {}", quoted(key), number)));
  }
  return row;
}

double targetNumber(const Json& object, const char* key, const std::string& name, std::size_t number) {
  const auto at = object.find(key);
  const bool there = at != object.end() && (at->is_number() || at->is_null());
  if (!there) refuseResult(name, fmt::format("target {} has no number '{}'", number, key));
  return at->is_null() ? kNoFigure : at->get<double>();
}

BenchTarget targetFrom(const Json& object, const std::string& name, std::size_t number) {
  if (!object.is_object()) refuseResult(name, fmt::format("target {} is no object", number));
  return {textIn(object, "name", name), targetNumber(object, "value", name, number),
          targetNumber(object, "bound", name, number)};
}

std::string bytesOf(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{256} << 20U;  // a result has some megabytes
  std::error_code failure;
  if (!std::filesystem::exists(file, failure)) {
    throw Error(Error::Code::kNotFound, file.string(), "there is no such file", "check the name");
  }
  if (!std::filesystem::is_regular_file(file, failure)) refuseResult(file.string(), "it is no plain file");
  const std::uintmax_t bytes = std::filesystem::file_size(file, failure);
  if (failure || bytes > kMostBytes) refuseResult(file.string(), "it is larger than any result");
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in || (bytes > 0 && !text)) {
    throw Error(Error::Code::kIo, file.string(), "it cannot be read", "check its permissions");
  }
  return text.str();
}

}  // namespace

BenchResult benchResultFrom(const std::string& text, const std::string& name) {
  const Json json = Json::parse(withoutByteOrderMark(text), nullptr, false);
  if (json.is_discarded()) refuseResult(name, "it is damaged: it is no whole JSON text");
  if (!json.is_object()) refuseResult(name, "it is no result of a bench");
  BenchResult result;
  result.bench = textIn(json, "bench", name);
  result.commit = textIn(json, "commit", name);
  result.machine = textIn(json, "machine", name);
  result.vulkan_device = textIn(json, "vulkan_device", name);
  result.command = textIn(json, "command", name);
  for (const Json& row : listIn(json, "rows", name)) {
    result.rows.push_back(rowFrom(row, name, result.rows.size() + 1));
  }
  for (const Json& target : listIn(json, "targets", name)) {
    result.targets.push_back(targetFrom(target, name, result.targets.size() + 1));
  }
  return result;
}

BenchResult readBenchResult(const std::filesystem::path& file) {
  return benchResultFrom(bytesOf(file), file.string());
}

}  // namespace palpate
