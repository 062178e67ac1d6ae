// SPDX-License-Identifier: Apache-2.0
#include "engine/files/formats.hpp"

#include <algorithm>
#include <filesystem>
#include <new>

#include <fmt/ranges.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/files/magic.hpp"
#include "engine/files/readers.hpp"
#include "engine/files/text_header.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/files/volume_name.hpp"
#include "engine/phantoms/phantom.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

bool endsWithAny(const std::string& name, const std::vector<std::string>& suffixes) {
  return std::any_of(suffixes.begin(), suffixes.end(),
                     [&](const std::string& suffix) { return name.ends_with(suffix); });
}

const VolumeFormat& formatNamed(const std::string& name) {
  const auto& formats = volumeFormats();
  return *std::find_if(formats.begin(), formats.end(), [&](const VolumeFormat& format) { return format.name == name; });
}

std::string allSuffixes() {
  std::vector<std::string> suffixes;
  for (const VolumeFormat& format : volumeFormats()) {
    suffixes.insert(suffixes.end(), format.suffixes.begin(), format.suffixes.end());
  }
  return fmt::format("{}", fmt::join(suffixes, " "));
}

// `seen`: what the file's first bytes say it is, "" where they say nothing.
[[noreturn]] void refuseSuffix(const std::string& name, const std::string& seen) {
  if (seen == "DICOM") {
    throw Error(Error::Code::kBadInput, name, "it is one DICOM slice", "give the folder that holds the series");
  }
  if (seen.empty()) {
    throw Error(Error::Code::kBadInput, name, "its suffix names no known format and its content does not either",
                "use one of " + allSuffixes() + ", a DICOM folder or phantom:NAME");
  }
  throw Error(Error::Code::kBadInput, name, "it holds " + seen + " data, which its suffix does not say",
              fmt::format("rename it to {}", fmt::join(formatNamed(seen).suffixes, " or ")));
}

const VolumeFormat& chooseByFile(const std::string& name, const std::string& path) {
  refuseEmpty(path, name, "it");
  const std::string seen = formatByContent(path, name);
  const std::string lower = lowerCase(path);
  for (const VolumeFormat& format : volumeFormats()) {
    if (!endsWithAny(lower, format.suffixes)) continue;
    if (!seen.empty() && seen != format.name) refuseSuffix(name, seen);
    return format;
  }
  refuseSuffix(name, seen);
}

const VolumeFormat& chooseByPath(const std::string& name, const std::string& path) {
  std::error_code failure;
  const fs::file_status status = fs::status(path, failure);
  if (status.type() == fs::file_type::none) throw fs::filesystem_error(path, failure);  // its type cannot be found out
  if (fs::is_directory(status)) return formatNamed("DICOM series");
  if (!fs::exists(status)) {
    throw Error(Error::Code::kNotFound, name, "there is no such file or folder",
                "check the path, or use phantom:sphere");
  }
  if (!fs::is_regular_file(status)) throw Error(Error::Code::kBadInput, name, "it is no file", "give a volume's file");
  return chooseByFile(name, path);
}

const VolumeFormat& chooseFormat(const std::string& name) {
  if (name.starts_with("phantom:")) return formatNamed("phantom");
  const VolumeName parsed = parseVolumeName(name);
  const VolumeFormat& format = chooseByPath(name, parsed.path);
  if (parsed.path == name || format.has_parts) return format;
  throw Error(Error::Code::kBadInput, name,
              fmt::format("it names a part, \"{}\", and {} files have none", parsed.part, format.name),
              "leave the '#' and what follows out");
}

Volume readPhantom(const ReadRequest& request) {
  return phantomVolume(request.name, request.memory_budget_bytes);
}

// A volume too small for a finger most often has the wrong unit of length.
void remarkOnSize(Volume& volume) {
  constexpr double kShortest_m = 1e-3;
  const double longest_m = volume.size().cast<double>().cwiseProduct(volume.lattice().spacing_m).maxCoeff();
  if (longest_m >= kShortest_m) return;
  volume.remark(
      fmt::format("it is {:.3g} mm long; if metres were taken for millimetres, write the true voxel size into the file",
                  longest_m * kMillimetresPerMetre));
}

}  // namespace

const std::vector<VolumeFormat>& volumeFormats() {
  static const std::vector<VolumeFormat> kFormats = {
      {"NRRD", {".nrrd", ".nhdr"}, "NRRD, attached or detached: raw, gzip or text", readNrrd},
      {"NIfTI", {".nii", ".nii.gz", ".hdr", ".img"}, "NIfTI-1, one file or a pair; turned from RAS to LPS", readNifti},
      {"MetaImage", {".mha", ".mhd"}, "MetaImage, one file or header and data", readMeta},
      {"OpenVDB", {".vdb"}, "OpenVDB density or level set; file.vdb#grid names a grid", readVdb, true},
      {"InVesalius", {".inv3"}, "InVesalius project", readInvesalius},
      {"DICOM series",
       {},
       "folder of DICOM slices; folder#2 or folder#UID names one of several series",
       readDicom,
       true,
       true},
      {"phantom", {}, "phantom:NAME?size=64&spacing=1mm&noise=0&seed=1: a surface known exactly", readPhantom},
  };
  return kFormats;
}

Volume loadVolume(const std::string& name, std::size_t memory_budget_bytes) {
  const VolumeName parsed = parseVolumeName(name);
  const std::string plain = parsed.withPart();
  try {
    const VolumeFormat& format = chooseFormat(plain);
    if (parsed.resample && !format.resamples) {
      refuse(name, fmt::format("{} volumes are not resampled, only tilted slices of DICOM series are", format.name),
             "leave --resample out");
    }
    Volume volume = format.read({plain, memory_budget_bytes, parsed.instead_of_nan, parsed.resample});
    if (plain != name) volume.rename(name);
    remarkOnSize(volume);
    return volume;
  } catch (const std::bad_alloc&) {
    throw Error(Error::Code::kOutOfMemory, name, "there is no memory for it", "crop or resample it");
  } catch (const fs::filesystem_error& failure) {
    throw Error(Error::Code::kIo, name, failure.code().message(), "check the permissions of the file or folder");
  }
}

}  // namespace palpate
