// SPDX-License-Identifier: Apache-2.0
#include "apps/convert/convert_job.hpp"

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/mesh/mesh_writer.hpp"
#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "base/units.hpp"
#include "engine/field/isosurface_mesh.hpp"
#include "engine/field/statistics.hpp"

namespace palpate {
namespace {

void checkOptions(const ConvertRequest& request) {
  const bool mesh = isMeshFileName(request.out);
  if (!mesh && !isVolumeFileName(request.out)) {
    refuse(request.out, "its suffix names no format that can be written",
           fmt::format("use {} for the volume, {} for the isosurface", volumeFileSuffixes(), kMeshFileSuffixes));
  }
  if (mesh && request.exact) refuse("--exact", "a mesh keeps no densities", "leave it out, or write a volume");
  if (!mesh && request.isovalue) refuse("--iso", "a volume has no isovalue", "leave it out, or write a mesh");
  if (!mesh && request.adaptivity) refuse("--adaptivity", "a volume has none", "leave it out, or write a mesh");
  if (request.adaptivity && !(*request.adaptivity >= 0 && *request.adaptivity <= 1)) {
    refuse("--adaptivity", fmt::format("{:g} is not in [0, 1]", *request.adaptivity),
           "0 follows the surface most closely, 1 joins most triangles");
  }
}

// A mesh keeps no densities.
void tellWhatChanges(const Volume& volume, const ConvertRequest& request) {
  if (isMeshFileName(request.out)) return tellRemark(volume);
  tellRemark(volume, TellRounding::kAlways);
  const Rounding written = roundedByWriting(volume, request.out, request.unit);
  if (written.count > 0) tellUser(request.out + ": " + written.words());
}

struct Output {
  const Volume& volume;
  const ConvertRequest& request;
  const std::string& work;
  AtomicFile& file;
  Progress& progress;
  ConvertResult result{};

  // Where the bytes go.
  void take(std::string_view bytes) {
    throwIfInterrupted(work);
    result.bytes += bytes.size();
    file.write(bytes);
  }
  void writeMeshOf() {
    result.isovalue = request.isovalue.value_or(0);
    if (!request.isovalue) result.isovalue = defaultIsovalue(volume);
    checkIsovalue(volume, result.isovalue);
    checkTouchable(volume);  // a volume one voxel thick encloses nothing
    progress.stage("meshing");
    const TriangleMesh mesh = isosurfaceMesh(volume, result.isovalue, request.adaptivity.value_or(0));
    if (mesh.triangles.empty()) {
      refuse(request.in, fmt::format("isovalue {:g} gives no surface", result.isovalue),
             "choose another with --iso; where edits or filters came before, they may have taken all of the object");
    }
    throwIfInterrupted(work);
    result.triangles = mesh.triangles.size();
    result.vertices = mesh.vertices_W.size();
    progress.stage("writing " + request.out);
    const double units_per_metre = request.unit == LengthUnit::kMetre ? 1 : kMillimetresPerMetre;
    result.collapsed = collapsedTriangles(mesh, units_per_metre);
    writeMesh(mesh, request.out, units_per_metre, [&](std::string_view bytes) { take(bytes); });
  }
  void writeVolumeItself() {
    progress.stage("writing " + request.out);
    writeVolume(volume, request.out, request.unit, [&](std::string_view bytes) { take(bytes); });
  }
};

}  // namespace

void checkExact(const Volume& volume, const ConvertRequest& request) {
  const VolumeFacts& facts = volume.facts();
  if (facts.rounded.count > 0) {
    refuse(request.in, facts.rounded.words(), "leave --exact out if rounded ones will do, or keep the file as it is");
  }
  if (facts.replaced > 0) {
    refuse(request.in, fmt::format("{} of its voxels have no density in the file, and were given one", facts.replaced),
           "leave --exact out, or replace them in the file");
  }
  if (facts.clamped > 0) {
    refuse(request.in,
           fmt::format("{} of its pixels, packed with losses, lay beyond BitsStored and were held within it",
                       facts.clamped),
           "leave --exact out, or unpack the series in another program");
  }
  if (facts.resampled) {
    refuse(request.in, "its slices are tilted, and were resampled upright",
           "leave --exact out, or keep the slices as they are");
  }
  const Rounding written = roundedByWriting(volume, request.out, request.unit);
  if (written.count > 0) refuse(request.out, written.words(), "give --unit m, which keeps them, or leave --exact out");
}

void checkOutput(const ConvertRequest& request) {
  checkOptions(request);
  checkNotInput(request.in, request.out);
}

ConvertResult writeOutput(const Volume& volume, const ConvertRequest& request, const std::string& work,
                          AtomicFile& file, Progress& progress) {
  Output output{volume, request, work, file, progress};
  output.result.size = volume.size();
  output.result.is_mesh = isMeshFileName(request.out);
  output.result.is_mesh ? output.writeMeshOf() : output.writeVolumeItself();
  return output.result;
}

ConvertResult convert(const ConvertRequest& request, Progress& progress) {
  const Stopwatch watch;
  checkOutput(request);
  AtomicFile file(
      request.out,
      Rights::kPrivate);  // opened before the long work, so that a folder without write permission is refused at once
  progress.stage("loading " + request.in);
  const Volume volume = loadVolume(request.in);
  progress.done();
  if (request.exact) checkExact(volume, request);  // a refusal has the same words
  tellWhatChanges(volume, request);
  throwIfInterrupted("palpate convert");
  ConvertResult result = writeOutput(volume, request, "palpate convert", file, progress);
  file.commit();
  progress.done();
  result.seconds = watch.seconds();
  return result;
}

std::string convertWords(const ConvertRequest& request, const ConvertResult& result) {
  const std::string size = fmt::format("{} x {} x {} voxels", result.size.x(), result.size.y(), result.size.z());
  const std::string what = result.is_mesh ? fmt::format("{} triangles, {} vertices, isosurface {:g} of {}",
                                                        result.triangles, result.vertices, result.isovalue, size)
                                          : size;
  std::string words =
      fmt::format("{}: {}, {}, {:.2f} s", request.out, what, bytesInWords(result.bytes), result.seconds);
  if (result.collapsed > 0) {
    words += fmt::format(
        "\n{} of the triangles without area: coordinates are 32-bit floats, "
        "and so far from the origin these cannot tell their corners apart; move the volume nearer to it",
        result.collapsed);
  }
  return words;
}

std::string surfaceWords(const std::string& out, double isovalue) {
  if (isMeshFileName(out)) return "";
  if (out.ends_with(".vdb")) return fmt::format("its surface is at {:g}, which the file keeps\n", isovalue);
  return fmt::format("its surface is at {:g}, which this format cannot keep: give --iso {:g} where it is used\n",
                     isovalue, isovalue);
}

}  // namespace palpate
