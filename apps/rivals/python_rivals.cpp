// SPDX-License-Identifier: Apache-2.0
#include "apps/rivals/python_rivals.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/rivals/child_talk.hpp"
#include "base/error.hpp"
#include "base/leftover.hpp"
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

// A file that goes away with its last user.
class TemporaryFile {
 public:
  TemporaryFile() {
    name_ = (std::filesystem::temp_directory_path() / "palpate_bench_XXXXXX").string();
    leftover_ = Leftover::file([this]() -> std::filesystem::path {
      const int file = mkstemp(name_.data());
      if (file < 0) return {};
      close(file);
      return name_;
    });
    if (!leftover_) {
      throw Error(Error::Code::kIo, name_, "no file can be made there", "set TMPDIR to a folder that may be written");
    }
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(name_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  void write(std::span<const float> values) const {
    std::ofstream out(name_, std::ios::binary);
    const auto bytes = std::as_bytes(values);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) {
      throw Error(Error::Code::kIo, name_, "the volume could not be written", "set TMPDIR to a folder with more room");
    }
  }
  [[nodiscard]] std::vector<float> read() const {
    std::vector<float> values(std::filesystem::file_size(name_) / sizeof(float));
    const auto bytes = std::as_writable_bytes(std::span(values));
    std::ifstream(name_, std::ios::binary)
        .read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return values;
  }

 private:
  std::string name_;
  Leftover leftover_;
};

std::vector<std::string> command(std::vector<std::string> python) {
  python.emplace_back("-c");
  python.emplace_back(reinterpret_cast<const char*>(kRivalsPy), sizeof(kRivalsPy));
  return python;
}

}  // namespace

struct PythonRivals::State {
  explicit State(const std::vector<std::string>& python) : child(command(python)) {}

  // Its answer's words; throws Error where it is not the one that was expected.
  std::vector<std::string> ask(const std::string& line, const std::string& expected) {
    std::optional<std::string> answer;
    if (child.tell(line)) answer = child.hear();
    const std::vector<std::string> words = wordsOf(answer.value_or("error\tit ended"));
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
    if (words[0] == "missing" && words.size() == 3) missing_.push_back({words[1], words[2]});
    if (words[0] != "rival" || words.size() != 4) continue;
    const std::string ask = fmt::format("run\t{}\t{}\t{}", words[1], words[2], words[3]);
    const auto run = [state = state_.get(), ask](std::vector<float>* result) -> RunCost {
      std::unique_ptr<TemporaryFile> file = result != nullptr ? std::make_unique<TemporaryFile>() : nullptr;
      const auto cost = state->ask(file ? ask + "\t" + file->name() : ask, "cost");
      if (file) *result = file->read();
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
    const TemporaryFile file;
    file.write(field.densities);
    const Vec3 spacing_mm = field.spacing_m / kMetresPerMillimetre;
    static_cast<void>(
        state_->ask(fmt::format("load\t{}\t{}\t{}\t{}\t{}\t{}\t{}", file.name(), field.size.x(), field.size.y(),
                                field.size.z(), spacing_mm.x(), spacing_mm.y(), spacing_mm.z()),
                    "ok"));
    return std::nullopt;
  } catch (const Error& failure) {
    if (failure.code() == Error::Code::kCancelled) throw;
    state_->rivals.clear();  // they would work on the volume before, or not at all
    return failure.what();
  }
}

std::vector<Rival> PythonRivals::rivalsOf(const std::string& job) {
  std::vector<Rival> found;
  for (const auto& [of, rival] : state_->rivals) {
    if (of == job) found.push_back(rival);
  }
  return found;
}

}  // namespace palpate
