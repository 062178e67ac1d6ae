// SPDX-License-Identifier: Apache-2.0
#include "apps/report/html_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace palpate {
namespace {

// Ends of the summary's keys that are units; the longest first.
constexpr std::array<std::pair<std::string_view, std::string_view>, 18> kUnits = {{
    {"_Ns_per_m", "N s/m"},
    {"_N_per_m", "N/m"},
    {"_N_per_s", "N/s"},
    {"_density", "density"},
    {"_voxel", "voxel"},
    {"_bytes", "byte"},
    {"_ticks", "ticks"},
    {"_deg", "deg"},
    {"_kg", "kg"},
    {"_hz", "Hz"},
    {"_mm", "mm"},
    {"_us", "us"},
    {"_ms", "ms"},
    {"_px", "pixel"},
    {"_N", "N"},
    {"_m", "m"},
    {"_s", "s"},
    {"_W", "world"},
}};

}  // namespace

std::string escapeHtml(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
    }
  }
  return out;
}

std::string escapeScriptJson(std::string json) {
  for (auto at = json.find('<'); at != std::string::npos; at = json.find('<', at)) json.replace(at, 1, "\\u003c");
  return json;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return out;
}

std::string keyInWords(std::string_view key) {
  std::string unit;
  for (const auto& [end, name] : kUnits) {
    if (key.size() <= end.size() || !key.ends_with(end)) continue;
    unit = " [" + std::string(name) + "]";
    key.remove_suffix(end.size());
    break;
  }
  std::string words(key);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words + unit;
}

}  // namespace palpate
