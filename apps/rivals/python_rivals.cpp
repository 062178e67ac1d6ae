// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "apps/rivals/child_talk.hpp"
#include "apps/rivals/rivals.hpp"
#include "apps/rivals/scratch_folder.hpp"
#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

#include "rivals.py.inc"

std::vector<std::string> wordsOf(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream in(line);
  for (std::string word; std::getline(in, word, '\t');) words.push_back(word);
  words.resize(std::max<std::size_t>(words.size(), 1));
  return words;
}

void write(const std::string& file, std::span<const float> values) {
  std::ofstream out(file, std::ios::binary);
  const auto bytes = std::as_bytes(values);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) {
    throw Error(Error::Code::kIo, file, "the volume could not be written", "set TMPDIR to a folder with more room");
  }
}

std::vector<float> read(const std::string& file) {
  std::vector<float> values(std::filesystem::file_size(file) / sizeof(float));
  const auto bytes = std::as_writable_bytes(std::span(values));
  std::ifstream(file, std::ios::binary)
      .read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return values;
}

std::vector<std::string> command(std::vector<std::string> python) {
  python.emplace_back("-c");
  python.emplace_back(reinterpret_cast<const char*>(kRivalsPy), sizeof(kRivalsPy));
  return python;
}

}  // namespace

struct PythonRivals::State {
  explicit State(const std::vector<std::string>& python) : child(command(python)) {}

  // The words of the child's answer. Throws Error if it is not the expected answer.
  std::vector<std::string> ask(const std::string& line, const std::string& expected) {
    std::optional<std::string> answer;
    if (child.tell(line)) answer = child.hear();
    std::vector<std::string> words = wordsOf(answer.value_or("error\tit ended"));
    if (words[0] == expected) return words;
    throw Error(Error::Code::kDevice, "the Python child", words.back(), "see what it wrote above");
  }

  ChildTalk child;
  std::vector<std::pair<std::string, Rival>> rivals;  // by job
};

PythonRivals::PythonRivals(unsigned threads, const std::vector<std::string>& python)
    : state_(std::make_unique<State>(python)) {
  bool ready = false;
  for (bool talks = state_->child.tell(fmt::format("threads\t{}", threads)); talks && !ready;) {
    const std::optional<std::string> line = state_->child.hear();
    talks = line.has_value();
    const std::vector<std::string> words = wordsOf(line.value_or(""));
    ready = words[0] == "ready";
    if (words[0] == "missing" && words.size() >= 3)
      missing_.push_back({words[1], words[2], words.size() > 3 ? words[3] : ""});
    if (words[0] != "rival" || words.size() != 4) continue;
    const std::string ask = fmt::format("run\t{}\t{}\t{}", words[1], words[2], words[3]);
    const auto run = [state = state_.get(), ask](std::vector<float>* result) -> RunCost {
      std::optional<ScratchFolder> folder;
      if (result != nullptr) folder.emplace();
      const std::string file = folder ? (folder->path() / "result").string() : "";
      const auto cost = state->ask(folder ? fmt::format("{}\t{}", ask, file) : ask, "cost");
      if (folder) *result = read(file);
      return {std::stod(cost.at(1)), std::stod(cost.at(2))};
    };
    state_->rivals.emplace_back(words[2], Rival{words[1], words[3], run});
  }
  if (ready) return;
  state_->rivals.clear();
  missing_.clear();
  for (const char* library : {"SciPy", "VTK"}) {
    missing_.push_back(
        {library, fmt::format("{} did not start: apt-get install python3-scipy python3-vtk9", python[0])});
  }
}

PythonRivals::~PythonRivals() = default;

std::optional<std::string> PythonRivals::load(const RivalField& field) {
  if (state_->rivals.empty()) return std::nullopt;
  try {
    const ScratchFolder folder;
    const std::string file = (folder.path() / "volume").string();
    write(file, field.densities);
    const Vec3 spacing_mm = field.spacing_m / kMetresPerMillimetre;
    static_cast<void>(state_->ask(fmt::format("load\t{}\t{}\t{}\t{}\t{}\t{}\t{}", file, field.size.x(), field.size.y(),
                                              field.size.z(), spacing_mm.x(), spacing_mm.y(), spacing_mm.z()),
                                  "ok"));
    return std::nullopt;
  } catch (const Error& failure) {
    if (failure.code() == Error::Code::kCancelled) throw;
    state_->rivals.clear();  // they were made for the volume before
    return failure.what();
  }
}

void PythonRivals::see(const RivalView& view) {
  const Camera& camera = view.camera;
  const Vec3 at_mm = camera.position_W / kMetresPerMillimetre, forward = camera.forward_W, up = camera.up_W;
  static_cast<void>(
      state_->ask(fmt::format("see\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}", camera.width, camera.height,
                              view.isovalue, at_mm.x(), at_mm.y(), at_mm.z(), forward.x(), forward.y(), forward.z(),
                              up.x(), up.y(), up.z(), camera.vertical_fov_rad * kDegreesPerRadian),
                  "ok"));
}

std::vector<Rival> PythonRivals::rivalsOf(const std::string& job) {
  std::vector<Rival> found;
  for (const auto& [of, rival] : state_->rivals) {
    if (of == job) found.push_back(rival);
  }
  return found;
}

}  // namespace palpate
