// SPDX-License-Identifier: Apache-2.0
// Where the headers of NRRD and MetaImage say that the values are, and reading them there. An accepted header names
// existing files. Reading them yields exactly the values, or a message that says why not.
#include "engine/files/text_stored.hpp"

#include <fstream>
#include <optional>
#include <stdexcept>

#include "fuzz_target.hpp"
#include "scratch_file.hpp"

namespace {

using namespace palpate;

constexpr std::size_t kValueBytes = 2;
constexpr std::size_t kBytes = 120;  // of the volume's 5 x 4 x 3 values

// Files beside the header: the whole volume, as text and as bytes, and its slices.
void writeData(const std::filesystem::path& folder) {
  const std::string bytes(kBytes, '7');
  std::string words = "a line to skip\n";
  for (std::size_t n = 0; n < kBytes / kValueBytes; ++n) words += std::to_string(n) + ' ';
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
  };
  write("a.raw", bytes);
  write("a.txt", words);
  for (int n = 0; n < 3; ++n) write("a" + std::to_string(n) + ".raw", bytes.substr(0, kBytes / 3));
}

void readAll(const StoredValues& values, const std::string& source) {
  StoredValues checked;
  if (!fuzz::accepts(source, [&] { checked = checkedBySize(values, kBytes, source); })) return;
  std::string to(kBytes, '\0');
  try {
    readStored(checked, ValueType::kInt16, to);
  } catch (const std::runtime_error& error) {
    fuzz::require(*error.what() != '\0', "values are refused without a word");
    fuzz::verdict = fuzz::Verdict::kRefused;
  }
}

void check(const std::string& bytes, TextFormat format) {
  static const fuzz::ScratchFile file("a.header");
  static const bool has_data = (writeData(file.folder()), true);
  static_cast<void>(has_data);
  file.write(bytes);
  const std::string path = file.path();
  const TextHeader header = readTextHeader(path, path, format);
  std::optional<StoredValues> values;
  const auto understand = [&] {
    if (format == TextFormat::kNrrd) {
      values = nrrdStored(header, path, kValueBytes, path);
    } else {
      values = metaStored(header, path, path);
    }
  };
  if (!fuzz::accepts(path, understand) || !values) return;
  fuzz::require(!values->parts.empty(), "the values are in no file");
  for (const StoredPart& part : values->parts) {
    fuzz::require(std::filesystem::is_regular_file(part.path), "a file is not there: " + part.path);
  }
  fuzz::require(!values->from_end || values->packing == Packing::kNone, "packed values end with their file");
  readAll(*values, path);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = fuzz::textOf(data, size);
  check(bytes, bytes.starts_with("NRRD") ? TextFormat::kNrrd : TextFormat::kMeta);
  return 0;
}
