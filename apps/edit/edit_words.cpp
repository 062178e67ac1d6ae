// SPDX-License-Identifier: Apache-2.0
#include "apps/edit/edit_words.hpp"

#include <fmt/format.h>

#include "apps/report/words.hpp"
#include "base/byte_size.hpp"

namespace palpate {
namespace {

std::string historyWords(const EditRequest& request, const EditResult& result) {
  if (request.history_bytes == 0) return "no undo";
  std::string words = fmt::format("{} of {} for undo of {}", bytesInWords(result.history_bytes),
                                  bytesInWords(request.history_bytes), counted(result.history_steps, "edit"));
  if (result.history_forgotten > 0) words += fmt::format(", {} forgotten", result.history_forgotten);
  return words;
}

// The budget covers densities and samples only; tables, windows and lists come on top.
std::string gpuWords(const EditRequest& request, const EditResult& result) {
  std::string words = bytesInWords(result.gpu_budgeted_bytes);
  if (request.gpu_memory_bytes > 0) words += " of " + bytesInWords(request.gpu_memory_bytes);
  return words + fmt::format(" on the GPU for densities and samples, {} with all else", bytesInWords(result.gpu_bytes));
}

}  // namespace

std::string editWords(const EditRequest& request, const EditResult& result) {
  const Vec3i& size = result.file.size;
  std::string text = fmt::format("Edited    {} ({} x {} x {} voxels) at isovalue {} on {}\n", request.in, size.x(),
                                 size.y(), size.z(), shortNumber(result.isovalue), result.gpu);
  text += fmt::format("Commands  {} applied: {}, {}, {}; {} refused\n", result.applied(), counted(result.edits, "edit"),
                      counted(result.undone, "undo"), counted(result.redone, "redo"), result.refused);
  if (result.idle > 0) text.insert(text.size() - 1, fmt::format("; {} changed nothing", result.idle));
  if (result.applied() > 0) {
    text += fmt::format("Time      a command {} ms median, {} ms p99; {} s in all\n", shortNumber(result.edit_ms.p50),
                        shortNumber(result.edit_ms.p99), shortNumber(result.seconds));
  }
  text += fmt::format("Changed   {}\n", counted(result.changed_bricks, "brick"));
  text += fmt::format("Memory    {}; {}\n", gpuWords(request, result), historyWords(request, result));
  if (!request.journal.empty()) {
    text += fmt::format("Journal   {} of {} saved", result.journal_saved, counted(result.journal_records, "record"));
    // A journal that failed before its first record has been deleted.
    if (result.journal_bytes > 0)
      text += fmt::format(" in {}, {}", request.journal, bytesInWords(result.journal_bytes));
    text += "\n";
  }
  text += fmt::format("Volume    {}, content {:016x}\nFile      {}, {}", request.in, result.content, request.out,
                      bytesInWords(result.file.bytes));
  if (result.file.is_mesh) text += fmt::format(", {} triangles", result.file.triangles);
  text += "\n";
  const std::string surface = surfaceWords(request.out, result.isovalue);
  return surface.empty() ? text : text + "Surface   " + surface;
}

nlohmann::ordered_json editJson(const EditRequest& request, const EditResult& result) {
  const Vec3i& size = result.file.size;
  nlohmann::ordered_json json = {
      {"schema", "palpate.edit/1"},
      {"in", request.in},
      {"out", request.out},
      {"size_voxel", {size.x(), size.y(), size.z()}},
      {"isovalue", result.isovalue},
      {"vulkan_device", result.gpu},
      {"commands",
       {{"applied", result.applied()},
        {"edits", result.edits},
        {"undone", result.undone},
        {"redone", result.redone},
        {"refused", result.refused},
        {"changed_nothing", result.idle}}},
      {"command_ms", {{"p50", result.edit_ms.p50}, {"p99", result.edit_ms.p99}, {"max", result.edit_ms.max}}},
      {"changed_bricks", result.changed_bricks},
      {"gpu_bytes", result.gpu_bytes},
      {"gpu_budgeted_bytes", result.gpu_budgeted_bytes},
      {"history", nullptr},
      {"journal", nullptr},
      {"content", fmt::format("{:016x}", result.content)},
      {"file_bytes", result.file.bytes},
      {"time_s", result.seconds}};
  if (request.history_bytes > 0) {
    json["history"] = {
        {"steps", result.history_steps}, {"bytes", result.history_bytes}, {"forgotten", result.history_forgotten}};
  }
  if (!request.journal.empty()) {
    json["journal"] = {{"folder", request.journal},
                       {"records", result.journal_records},
                       {"saved", result.journal_saved},
                       {"bytes", result.journal_bytes}};
  }
  return json;
}

}  // namespace palpate
