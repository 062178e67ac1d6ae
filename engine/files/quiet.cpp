// SPDX-License-Identifier: Apache-2.0
#include "engine/files/quiet.hpp"

#include <iostream>

namespace palpate {
namespace {

std::mutex& oneAtATime() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

Quiet::Quiet()
    : lock_(oneAtATime()), old_cerr_(std::cerr.rdbuf(chatter_.rdbuf())), old_cout_(std::cout.rdbuf(chatter_.rdbuf())) {}

Quiet::~Quiet() {
  std::cerr.rdbuf(old_cerr_);
  std::cout.rdbuf(old_cout_);
}

// "ITK ERROR: NrrdImageIO(0x55...): Read: Error reading FILE:\n [nrrd] ..." becomes what follows the object's address.
std::string shortReason(const std::string& description) {
  constexpr std::size_t kLongest = 200;
  std::string text = description;
  const std::size_t address = text.find("): ");
  if (text.find("(0x") < address && address != std::string::npos) text.erase(0, address + 3);
  std::string line;
  for (const char c : text) {
    const bool blank = static_cast<unsigned char>(c) <= ' ' || c == 127;
    if (!blank) line += c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
  }
  if (line.size() > kLongest) line = line.substr(0, kLongest) + "...";
  while (!line.empty() && (line.back() == ' ' || line.back() == ':')) line.pop_back();
  return line;
}

}  // namespace palpate
