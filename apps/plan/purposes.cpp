// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/purposes.hpp"

#include <span>

namespace palpate {
namespace {

struct Purpose {
  std::string_view name;  // or how it begins
  std::string_view words;
};

// The first row whose name the other begins with.
std::string_view findBeginning(std::span<const Purpose> rows, std::string_view name) noexcept {
  for (const Purpose& row : rows)
    if (name.starts_with(row.name)) return row.words;
  return {};
}

std::string_view findWhole(std::span<const Purpose> rows, std::string_view name) noexcept {
  for (const Purpose& row : rows)
    if (name == row.name) return row.words;
  return {};
}

constexpr Purpose kKernels[] = {
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

constexpr Purpose kBuffers[] = {
    {"page table", "where each brick of densities is, or the one value that it holds"},
    {"density", "densities of the volume"},
    {"filtered density", "the filtered field"},
    {"smoothed", "the field that gradients are taken of"},
    {"pages to write", "bricks of the filtered field whose pages an edit changes"},
    {"sample", "gradient and density of the bricks that the isosurface needs"},
    {"window", "the samples around the tool, three times, so that nobody waits"},
    {"brick bounds", "lowest and highest density of each brick"},
    {"edit", "what an edit changes, and bricks before it is taken over"},
    {"bounds tasks", "bricks whose bounds an edit changes"},
    {"brick tasks", "bricks whose samples an edit changes"},
    {"given bricks", "bricks that an undo puts back"},
    {"touched bricks", "copies of edited bricks, for main memory"},
    {"stamps", "shapes of brushes from volumes"},
    {"filter", "lists of bricks and weights of filters"},
    {"gradient", "lists of bricks whose gradients are computed"},
    {"picture", "the picture"},
    {"planes of the picture", "the picture"},
    {"tiles of the picture", "the picture"},
    {"draw", "the picture"},
    {"bricks of the cell tree", "the tree of cells that the isosurface crosses, for pictures"},
    {"cell", "the tree of cells that the isosurface crosses, for pictures"},
    {"blocks of cells", "the tree of cells that the isosurface crosses, for pictures"},
    {"staging", "on the way between main memory and the device"},
    {"transfer", "on the way between main memory and the device"},
};

constexpr Purpose kThreads[] = {
    {"palpate", "set-up, progress and results"},
    {"engine", "windows around the tool, edits and pictures, on the Vulkan device"},
    {"servo", "the force, tick by tick"},
    {"servo link", "what the servo's process says, with --service"},
    {"device", "a real device's reports, so that the servo never waits for the bus"},
    {"stop", "ends the program on Ctrl-C where its work does not look"},
    {"journal", "edits to the disk"},
    {"saver", "the edited volume to its file, beside the run"},
};

constexpr Purpose kConstants[] = {
    {"kSlabCount", "slabs of 128 MiB that the densities lie in; with one there is no choice among them"},
    {"kDensitySlabs", "the same of the field that is not smoothed"},
    {"kHalf", "1: samples are halves"},
    {"kRun", "rows of a brick that one invocation computes"},
    {"kAxis", "axis of the step: 0, 1 or 2"},
    {"kReachX", "how far it reads along the first axis [voxel]"},
    {"kReachY", "how far it reads along the second axis [voxel]"},
    {"kReachZ", "how far it reads along the third axis [voxel]"},
    {"kReach", "how far it reads [voxel]"},
    {"kEdge", "1: for bricks at the border of the volume; 0: for all others, which need not look for it"},
    {"kBorder", "what stands beyond the border; 0: the nearest voxel, 1: a mirror image"},
    {"kExtreme", "0: the highest, 1: the lowest"},
    {"kExponential", "1: diffusion falls off exponentially; 0: rationally"},
    {"kKind", "kind of edit"},
    {"kLevels", "levels of the tree of cells"},
    {"kClips", "1: parts are cut away"},
    {"kSlices", "1: slices are shown"},
    {"kOther", "1: there is a second isosurface"},
    {"kOcclusion", "1: ambient occlusion"},
    {"kNormals", "1: the colour is the normal"},
};

constexpr Purpose kEffects[] = {
    {"force shading", "the force turns with the surface between renewals of the plane"},
    {"recovery time", "a new plane takes effect over a time"},
    {"texture", "fine relief"},
    {"friction", "the tool sticks and slips"},
    {"stiffness by density", "the surface is as stiff as what lies under it"},
};

constexpr Purpose kModules[] = {
    {"assimp", "meshes in OBJ files"},
    {"cairo", "pictures"},
    {"embree", "mesh objects, and the algorithm that touches a mesh of the isosurface"},
    {"gdcm", "DICOM slices packed as JPEG"},
    {"hidraw", "a haptic device, by the kernel's hidraw"},
    {"hidusb", "a haptic device, by libusb (--hid libusb)"},
    {"invesalius", "volumes in InVesalius projects (.inv3)"},
    {"itk", "volumes in NRRD and MetaImage"},
    {"openvdb", "the volume's grid, of whatever format"},
    {"rivals", "benches beside other libraries"},
};

}  // namespace

std::string_view kernelPurpose(std::string_view name) noexcept {
  return findBeginning(kKernels, name);
}
std::string_view bufferPurpose(std::string_view name) noexcept {
  return findBeginning(kBuffers, name);
}
std::string_view threadPurpose(std::string_view name) noexcept {
  return findWhole(kThreads, name);
}
std::string_view constantPurpose(std::string_view name) noexcept {
  return findWhole(kConstants, name);
}
std::string_view effectPurpose(std::string_view name) noexcept {
  return findWhole(kEffects, name);
}
std::string_view modulePurpose(std::string_view name) noexcept {
  return findWhole(kModules, name);
}

std::vector<std::string> moduleNames() {
  std::vector<std::string> names;
  for (const Purpose& row : kModules) names.emplace_back(row.name);
  return names;
}

}  // namespace palpate
