// SPDX-License-Identifier: Apache-2.0
// The text headers of NRRD and MetaImage, as they are read before a library sees them: what was understood, written
// again, is understood again.
#include "engine/volume/text_header.hpp"

#include "fuzz_target.hpp"
#include "scratch_file.hpp"

namespace {

using namespace palpate;

struct Form {
  char separator;
  const char* last_key;
};

std::string textOf(const TextHeader& header, const Form& form) {
  std::string text = "NRRD0004\n", last;
  for (const auto& [key, value] : header.fields) {
    const std::string line = key + form.separator + ' ' + value + '\n';
    (!key.empty() && key == form.last_key ? last : text) += line;
  }
  return text + (*form.last_key == '\0' ? "\n" : last);
}

void check(const std::string& bytes, const Form& form) {
  static const fuzz::ScratchFile file("a.header");
  file.write(bytes);
  TextHeader header;
  fuzz::mustAccept("a file cannot be read",
                   [&] { header = readTextHeader(file.path(), file.path(), form.separator, form.last_key); });
  if (header.plain) fuzz::verdict = fuzz::Verdict::kAccepted;
  fuzz::require(header.data_offset <= bytes.size(), "its data begin beyond the file");
  for (const auto& [key, value] : header.fields) {
    fuzz::require(header.text(key) == value && key == lowerCase(key), "a key is not found again: " + key);
    static_cast<void>(header.numbers(key));
  }
  if (*form.last_key != '\0' && !header.fields.contains(form.last_key)) {
    fuzz::require(!header.plain, "a header without its last key is called plain");
    return;
  }
  file.write(textOf(header, form));
  fuzz::mustAccept("its own words are refused", [&] {
    const TextHeader again = readTextHeader(file.path(), file.path(), form.separator, form.last_key);
    fuzz::require(again.fields == header.fields && again.plain, "it reads otherwise from " + textOf(header, form));
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = fuzz::textOf(data, size);
  fuzz::verdict = fuzz::Verdict::kRefused;  // unless it is plain in one of the forms
  check(bytes, {':', ""});
  check(bytes, {'=', "elementdatafile"});
  return 0;
}
