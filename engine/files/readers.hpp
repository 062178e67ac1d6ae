// SPDX-License-Identifier: Apache-2.0
// engine/files/readers.hpp: one reader per format. Private to engine/files; loadVolume chooses among them.
//
// Each throws Error for a file that it cannot read; there is no partial result.
#pragma once

#include "engine/files/formats.hpp"

namespace palpate {

[[nodiscard]] Volume readVdb(const ReadRequest& request);
[[nodiscard]] Volume readNrrd(const ReadRequest& request);
[[nodiscard]] Volume readNifti(const ReadRequest& request);
[[nodiscard]] Volume readMeta(const ReadRequest& request);
[[nodiscard]] Volume readDicom(const ReadRequest& request);
[[nodiscard]] Volume readInvesalius(const ReadRequest& request);

}  // namespace palpate
