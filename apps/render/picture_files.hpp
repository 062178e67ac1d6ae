// SPDX-License-Identifier: Apache-2.0
// apps/render/picture_files.hpp: the names of the files of a picture, and what is refused of them. Set-up code.
#pragma once

#include <string>
#include <vector>

#include "apps/render/render_request.hpp"

namespace palpate {

// Of one frame.
struct PictureFiles {
  std::string picture;  // "out.png"; of several frames "out_007.png", with as many digits as the last one needs
  std::string depth;    // the same of the depth image; empty: none
};
[[nodiscard]] std::vector<PictureFiles> pictureFiles(const RenderRequest& request);

// Throws Error(kBadInput) for a picture that is no .png, a depth image that is no .pfm, two outputs of one name, and an
// output that is the input or an existing file in the input's folder.
void checkPictureFiles(const RenderRequest& request);

// Throws Error(kIo) where one of the files, the JSON file too, cannot be written. Cost: some system calls a file.
void checkPicturesWritable(const RenderRequest& request);

}  // namespace palpate
