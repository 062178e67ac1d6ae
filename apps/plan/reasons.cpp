// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/reasons.hpp"

#include <span>

namespace palpate {
namespace {

struct Reason {
  std::string_view name;  // or how it begins
  std::string_view words;
};

// The first row whose name the other begins with.
std::string_view findBeginning(std::span<const Reason> rows, std::string_view name) noexcept {
  for (const Reason& row : rows)
    if (name.starts_with(row.name)) return row.words;
  return {};
}

std::string_view findWhole(std::span<const Reason> rows, std::string_view name) noexcept {
  for (const Reason& row : rows)
    if (name == row.name) return row.words;
  return {};
}

constexpr Reason kKernels[] = {
    {"brick_bounds", "finds which bricks the isosurface crosses"},
    {"gradient_smoothed", "gradients of a smoothed field, beside densities that are not smoothed"},
    {"gradient", "gradients of the bricks that need them"},
    {"window", "gathers the samples around the tool, which the servo reads"},
    {"edit_stencil", "edits that read neighbours: smooth, flatten, inflate and their like"},
    {"edit", "edits of single voxels: remove, add, paint"},
    {"brick_commit", "takes edited bricks over into the volume"},
    {"page_write", "keeps the filtered field's pages up to date under edits"},
    {"filter_", "a step of a filter, or of the smoothing that a gradient operator asks for"},
    {"cell_", "the tree of cells that the isosurface crosses, for pictures"},
    {"draw", "the picture"},
    {"half_voxel_march", "the picture as it was drawn before, for benches"},
};

constexpr Reason kBuffers[] = {
    {"page table", "where each brick of densities is, or the one value that it holds"},
    {"density", "densities of the volume and of filtered fields"},
    {"sample", "gradient and density of the bricks that the isosurface needs"},
    {"window", "the samples around the tool, three times, so that nobody waits"},
    {"brick bounds", "lowest and highest density of each brick"},
    {"edit", "what an edit changes, and bricks before it is taken over"},
    {"filter", "lists of bricks and weights of filters"},
    {"gradient", "lists of bricks whose gradients are computed"},
    {"picture", "the picture"},
    {"draw", "the picture"},
    {"cell", "the tree of cells that the isosurface crosses, for pictures"},
    {"blocks of cells", "the tree of cells that the isosurface crosses, for pictures"},
    {"transfer", "on the way between main memory and the device"},
};

constexpr Reason kThreads[] = {
    {"palpate", "set-up, progress and results"},
    {"engine", "windows around the tool, edits and pictures, on the Vulkan device"},
    {"servo", "the force, tick by tick"},
    {"journal", "edits to the disk"},
    {"saver", "the edited volume to its file, beside the run"},
};

constexpr Reason kModules[] = {
    {"assimp", "meshes in OBJ files"},
    {"cairo", "pictures"},
    {"embree", "mesh objects, and the algorithm that touches a mesh of the isosurface"},
    {"invesalius", "volumes in InVesalius projects (.inv3)"},
    {"itk", "volumes in DICOM, NRRD and MetaImage"},
    {"openvdb", "the volume's grid, of whatever format"},
    {"rivals", "benches beside other libraries"},
};

}  // namespace

std::string_view kernelReason(std::string_view name) noexcept {
  return findBeginning(kKernels, name);
}
std::string_view bufferReason(std::string_view name) noexcept {
  return findBeginning(kBuffers, name);
}
std::string_view threadReason(std::string_view name) noexcept {
  return findWhole(kThreads, name);
}
std::string_view moduleReason(std::string_view name) noexcept {
  return findWhole(kModules, name);
}

std::vector<std::string> moduleNames() {
  std::vector<std::string> names;
  for (const Reason& row : kModules) names.emplace_back(row.name);
  return names;
}

}  // namespace palpate
