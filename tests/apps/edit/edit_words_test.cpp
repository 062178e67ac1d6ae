// SPDX-License-Identifier: Apache-2.0
// A result in which no two figures are equal, to the letter; and one of nothing.
#include "apps/edit/edit_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace edit_words_test {

EditRequest request() {
  EditRequest request;
  request.in = "in.nrrd";
  request.out = "out.vdb";
  request.journal = "kept";
  request.history_bytes = 1U << 20U;
  request.gpu_memory_bytes = 1U << 30U;
  return request;
}

EditResult result() {
  EditResult result;
  result.gpu = "a device";
  result.isovalue = 0.5;
  result.edits = 4;
  result.undone = 2;
  result.redone = 1;
  result.refused = 3;
  result.idle = 5;
  result.edit_ms = {7, 1.5, 2, 2.5, 3, 4};
  result.changed_bricks = 21;
  result.gpu_bytes = 3U << 20U;
  result.gpu_budgeted_bytes = 2U << 20U;
  result.history_steps = 11;
  result.history_forgotten = 6;
  result.history_bytes = 512U << 10U;
  result.journal_records = 9;
  result.journal_saved = 8;
  result.journal_bytes = 500;
  result.content = 0xabc;
  result.file.size = Vec3i(64, 65, 66);
  result.file.bytes = 2048;
  result.seconds = 12;
  return result;
}

TEST(EditWords, AreATableToTheLetter) {
  EXPECT_EQ(editWords(request(), result()),
            R"(Edited    in.nrrd (64 x 65 x 66 voxels) at isovalue 0.5 on a device
Commands  7 applied: 4 edits, 2 undos, 1 redo; 3 refused; 5 changed nothing
Time      a command 1.5 ms median, 2.5 ms p99; 12 s in all
Changed   21 bricks
Memory    2 MiB of 1 GiB on the GPU for densities and samples, 3 MiB with all else; 512 KiB of 1 MiB for undo of 11 edits, 6 forgotten
Journal   8 of 9 records saved in kept, 500 B
Volume    in.nrrd, content 0000000000000abc
File      out.vdb, 2 KiB
Surface   its surface is at 0.5, which the file keeps
)");
}

TEST(EditWords, LeaveOutWhatIsNotThere) {
  EditRequest asked;
  asked.in = "in.nrrd";
  asked.out = "a.stl";
  asked.history_bytes = 0;
  EditResult none;
  none.gpu = "a device";
  none.file.is_mesh = true;
  none.file.triangles = 12;
  const std::string before =
      "Edited    in.nrrd (0 x 0 x 0 voxels) at isovalue 0 on a device\n"
      "Commands  0 applied: 0 edits, 0 undos, 0 redos; 0 refused\n"
      "Changed   0 bricks\n"
      "Memory    0 B on the GPU for densities and samples, 0 B with all else; ";
  const std::string after = "Volume    in.nrrd, content 0000000000000000\nFile      a.stl, 0 B, 12 triangles\n";
  EXPECT_EQ(editWords(asked, none), before + "no undo\n" + after);
  asked.history_bytes = 1024;
  asked.journal = "kept";  // it failed before its first record
  EXPECT_EQ(editWords(asked, none),
            before + "0 B of 1 KiB for undo of 0 edits\nJournal   0 of 0 records saved\n" + after);
}

TEST(EditWords, AreJsonToTheLetter) {
  using Json = nlohmann::ordered_json;
  Json expected = Json::parse(R"({"schema": "palpate.edit/1", "in": "in.nrrd", "out": "out.vdb",
    "size_voxel": [64, 65, 66], "isovalue": 0.5, "vulkan_device": "a device",
    "commands": {"applied": 7, "edits": 4, "undone": 2, "redone": 1, "refused": 3, "changed_nothing": 5},
    "command_ms": {"p50": 1.5, "p99": 2.5, "max": 4}, "changed_bricks": 21, "gpu_bytes": 3145728,
    "gpu_budgeted_bytes": 2097152, "history": {"steps": 11, "bytes": 524288, "forgotten": 6},
    "journal": {"folder": "kept", "records": 9, "saved": 8, "bytes": 500},
    "content": "0000000000000abc", "file_bytes": 2048, "time_s": 12})");
  EXPECT_EQ(editJson(request(), result()), expected);
  EditRequest asked = request();
  asked.journal = "";
  asked.history_bytes = 0;
  expected["journal"] = expected["history"] = nullptr;
  EXPECT_EQ(editJson(asked, result()), expected);
}

}  // namespace edit_words_test
}  // namespace palpate
