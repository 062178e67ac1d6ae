// SPDX-License-Identifier: Apache-2.0
#include "apps/render/picture_files.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <system_error>

#include <fmt/format.h>

#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {
namespace {

constexpr std::size_t kFewestDigits = 3;

// "a/out.png" with 7 becomes "a/out_007.png".
std::string numbered(const std::string& name, int frame, std::size_t digits) {
  const std::size_t dot = name.rfind('.');
  return fmt::format("{}_{:0{}}{}", name.substr(0, dot), frame, digits, name.substr(dot));
}

// `like`: a good name.
void checkSuffix(const std::string& name, const char* what, const char* like) {
  const std::string suffix = std::filesystem::path(like).extension();
  const std::string last = std::filesystem::path(name).filename();
  if (last.size() > suffix.size() && last.ends_with(suffix)) return;
  refuse(name.empty() ? "''" : name, fmt::format("{} is written as {} only", what, suffix),
         fmt::format("give a name like {}", like));
}

// For the name of a later frame. Where it is free, or an older file has it, the first frame's folder has answered.
void checkReplaceable(const std::string& name) {
  std::error_code ignored;
  const std::filesystem::file_status there = std::filesystem::symlink_status(name, ignored);
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) checkWritable(name);
}

}  // namespace

std::vector<PictureFiles> pictureFiles(const RenderRequest& request) {
  if (request.frames == 1) return {{request.out, request.depth}};
  const std::size_t digits = std::max(kFewestDigits, std::to_string(request.frames - 1).size());
  std::vector<PictureFiles> files;
  for (int frame = 0; frame < request.frames; ++frame) {
    files.push_back({numbered(request.out, frame, digits),
                     request.depth.empty() ? std::string() : numbered(request.depth, frame, digits)});
  }
  return files;
}

void checkPictureFiles(const RenderRequest& request) {
  checkSuffix(request.out, "a picture", "picture.png");
  if (!request.depth.empty()) checkSuffix(request.depth, "a depth image", "depth.pfm");
  if (!request.json.empty()) checkNotInput(request.in, request.json);
  for (const PictureFiles& files : pictureFiles(request)) {
    checkOutputsDiffer({files.picture, files.depth, request.json});
    checkNotInput(request.in, files.picture);
    if (!files.depth.empty()) checkNotInput(request.in, files.depth);
  }
}

void checkPicturesWritable(const RenderRequest& request) {
  const std::vector<PictureFiles> all = pictureFiles(request);
  checkWritable(all.front().picture);
  if (!request.depth.empty()) checkWritable(all.front().depth);
  if (!request.json.empty()) checkWritable(request.json);
  for (const PictureFiles& files : std::span(all).subspan(1)) {
    checkReplaceable(files.picture);
    if (!files.depth.empty()) checkReplaceable(files.depth);
  }
}

}  // namespace palpate
