// SPDX-License-Identifier: Apache-2.0
// The text headers of NRRD and MetaImage, as they are read before a library sees them. A header written from what was
// understood gives the same when it is read again.
#include "engine/files/text_header.hpp"

#include "fuzz_target.hpp"
#include "scratch_file.hpp"

namespace {

using namespace palpate;

std::string textOf(const TextHeader& header, TextFormat format) {
  const char separator = format == TextFormat::kNrrd ? ':' : '=';
  const std::string last_key = format == TextFormat::kNrrd ? "" : "elementdatafile";
  std::string text = format == TextFormat::kNrrd ? "NRRD0004\n" : "", last;
  for (const auto& [key, value] : header.fields) {
    const std::string line = key + separator + ' ' + value + '\n';
    (!key.empty() && key == last_key ? last : text) += line;
  }
  return text + (format == TextFormat::kNrrd ? "\n" : last);
}

void check(const std::string& bytes, TextFormat format) {
  static const fuzz::ScratchFile file("a.header");
  file.write(bytes);
  TextHeader header;
  fuzz::mustAccept("a file cannot be read", [&] { header = readTextHeader(file.path(), file.path(), format); });
  fuzz::require(header.data_offset <= bytes.size(), "its data begin beyond the file");
  for (const auto& [key, value] : header.fields) {
    fuzz::require(header.text(key) == value && key == lowerCase(key), "a key is not found again: " + key);
    static_cast<void>(header.numbers(key));
  }
  if (format == TextFormat::kMeta && !header.fields.contains("elementdatafile")) {
    fuzz::require(!header.fault.empty(), "a header without its last key has no fault");
  }
  if (!header.fault.empty()) return;
  fuzz::verdict = fuzz::Verdict::kAccepted;
  // A list of file names ends the header at its place. A map does not keep that place.
  for (const char* key : {"data file", "datafile"}) {
    if (lowerCase(header.text(key)).starts_with("list")) return;
  }
  file.write(textOf(header, format));
  fuzz::mustAccept("its own words are refused", [&] {
    const TextHeader again = readTextHeader(file.path(), file.path(), format);
    fuzz::require(again.fields == header.fields && again.fault.empty(),
                  "it reads otherwise from " + textOf(header, format));
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = fuzz::textOf(data, size);
  fuzz::verdict = fuzz::Verdict::kRefused;  // unless it has no fault in one of the forms
  check(bytes, TextFormat::kNrrd);
  check(bytes, TextFormat::kMeta);
  return 0;
}
