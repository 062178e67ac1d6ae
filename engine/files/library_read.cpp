// SPDX-License-Identifier: Apache-2.0
#include "engine/files/library_read.hpp"

#include <memory>
#include <stdexcept>

#include "base/error.hpp"
#include "base/module.hpp"
#include "engine/files/itk_file.hpp"
#include "engine/files/text_header.hpp"
#include "engine/files/vdb_module.hpp"

namespace palpate {
namespace {

ItkReader readerFor(const std::string& name) {
  const std::string lower = lowerCase(name);
  if (lower.ends_with(".nrrd") || lower.ends_with(".nhdr")) return ItkReader::kNrrd;
  if (lower.ends_with(".nii") || lower.ends_with(".nii.gz")) return ItkReader::kNifti;
  if (lower.ends_with(".mha") || lower.ends_with(".mhd")) return ItkReader::kMeta;
  throw Error(Error::Code::kBadInput, name, "neither ITK nor OpenVDB reads its format",
              "give .nrrd, .nii, .nii.gz, .mha or .vdb");
}

}  // namespace

std::size_t readWithLibraryAlone(const std::string& name) {
  if (lowerCase(name).ends_with(".vdb")) return loadModule<VdbModule>().readAlone(name);
  const ItkReader reader = readerFor(name);
  try {
    const std::unique_ptr<ItkFile> file = loadModule<ItkModule>().open(reader, name);
    if (!file->header().type) throw std::runtime_error("its values are no numbers");
    std::size_t bytes = byteSize(*file->header().type);
    for (const std::int64_t size : file->header().dimensions) bytes *= static_cast<std::size_t>(size);
    const std::unique_ptr<char[]> raw(new char[bytes]);  // not filled, as ITK's own images are not
    file->read({raw.get(), bytes});
    return bytes;
  } catch (const std::runtime_error& failure) {
    throw Error(Error::Code::kBadInput, name, failure.what(), "give another file");
  }
}

}  // namespace palpate
