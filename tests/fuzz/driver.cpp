// SPDX-License-Identifier: Apache-2.0
// A small substitute for libFuzzer that works with any compiler. It replays the inputs of a corpus, then changes them
// at random, and keeps the input at which a target fails.
//
//   fuzz_NAME [--runs N] [--seed S] [--seconds LIMIT] FILE-OR-FOLDER...
//
// An input of the corpus whose name begins with "ok" must be accepted, one that begins with "bad" refused. Some inputs
// must be accepted and some refused. Exit status 0: all went well. 1: an input was judged otherwise. A signal: the
// target failed, and the input is kept.
#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "fuzz_target.hpp"
#include "mutator.hpp"

// Defined only if a sanitizer is linked.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the sanitizers' name
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)());
// The undefined-behaviour sanitizer has no such callback when it is a library of its own. So it is made to send a
// signal.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the sanitizers' name
extern "C" const char* __ubsan_default_options() {
  return "abort_on_error=1";
}

namespace {

namespace fs = std::filesystem;
using palpate::fuzz::Verdict;

constexpr rlim_t kMostBytes = rlim_t{2} << 30U;  // of memory that a target may use beyond its memory at the start

struct Input {
  std::string name, bytes;
};
std::string current;                // the input that the target is given
std::array<char, 512> kept_name{};  // file for that input if the target fails
volatile std::sig_atomic_t is_kept = 0;

void say(const char* text) {
  static_cast<void>(write(STDERR_FILENO, text, std::strlen(text)));
}

// Calls only functions that a signal handler may call.
void keepInput() {
  if (std::exchange(is_kept, 1) != 0) return;
  const int descriptor = open(kept_name.data(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  static_cast<void>(write(descriptor, current.data(), current.size()));
  close(descriptor);
  say("fuzz: the input is kept as ");
  say(kept_name.data());
  say("\n");
}

void onSignal(int number) {
  if (number == SIGALRM) say("fuzz: the target takes too long\n");
  keepInput();
  std::signal(number, SIG_DFL);
  raise(number);
}

void watch(const std::string& name) {
  const std::string kept = (fs::temp_directory_path() / (name + "-" + std::to_string(getpid()) + ".input")).string();
  std::copy_n(kept.data(), std::min(kept.size(), kept_name.size() - 1), kept_name.data());
  for (const int number : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM}) std::signal(number, onSignal);
  if (__sanitizer_set_death_callback != nullptr) {
    __sanitizer_set_death_callback(keepInput);
    return;  // its shadow memory exceeds any limit
  }
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t most = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + kMostBytes;
  const rlimit limit{most, most};
  setrlimit(RLIMIT_AS, &limit);
}

std::vector<Input> inputsIn(const std::vector<std::string>& places) {
  std::vector<fs::path> files;
  for (const std::string& place : places) {
    if (fs::is_directory(place)) {
      std::copy(fs::directory_iterator(place), {}, std::back_inserter(files));
    } else {
      files.emplace_back(place);
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<Input> inputs;
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    if (!in) palpate::fuzz::fail("the input cannot be read: " + file.string());
    inputs.push_back({file.filename(), {std::istreambuf_iterator<char>(in), {}}});
  }
  return inputs;
}

std::array<std::uint64_t, 3> counts{};  // number of inputs, by verdict

Verdict judged(std::string bytes, unsigned limit_s) {
  current = std::move(bytes);
  palpate::fuzz::verdict = Verdict::kNone;
  alarm(limit_s);
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(current.data()), current.size());
  alarm(0);
  ++counts[static_cast<std::size_t>(palpate::fuzz::verdict)];
  return palpate::fuzz::verdict;
}

// Number of inputs whose verdict differs from what their names say.
int replay(const std::vector<Input>& inputs, unsigned limit_s) {
  int wrong = 0;
  for (const Input& input : inputs) {
    const Verdict verdict = judged(input.bytes, limit_s);
    const bool must_pass = input.name.starts_with("ok"), must_fail = input.name.starts_with("bad");
    if ((!must_pass || verdict == Verdict::kAccepted) && (!must_fail || verdict == Verdict::kRefused)) continue;
    std::fprintf(stderr, "fuzz: %s was not %s\n", input.name.c_str(), must_pass ? "accepted" : "refused");
    ++wrong;
  }
  return wrong;
}

struct Arguments {
  std::uint64_t runs = 0, seed = 1;
  unsigned limit_s = 5;
  std::vector<std::string> places;
};

Arguments argumentsOf(int argc, char** argv) {
  Arguments arguments;
  for (int n = 1; n < argc; ++n) {
    const std::string word = argv[n];
    const bool is_flag = word == "--runs" || word == "--seed" || word == "--seconds";
    if (!is_flag || n + 1 == argc) {
      arguments.places.push_back(word);
      continue;
    }
    const std::uint64_t number = std::strtoull(argv[++n], nullptr, 10);
    if (word == "--runs") arguments.runs = number;
    if (word == "--seed") arguments.seed = number;
    if (word == "--seconds") arguments.limit_s = static_cast<unsigned>(number);
  }
  return arguments;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = argumentsOf(argc, argv);
  const std::vector<Input> inputs = inputsIn(arguments.places);
  if (inputs.empty()) {
    std::fprintf(stderr, "fuzz: there are no inputs; name files or folders\n");
    return 1;
  }
  watch(fs::path(argv[0]).filename());
  const int wrong = replay(inputs, arguments.limit_s);
  std::vector<std::string> corpus;
  for (const Input& input : inputs) corpus.push_back(input.bytes);
  palpate::fuzz::Mutator mutator(corpus, arguments.seed);
  for (std::uint64_t n = 0; n < arguments.runs; ++n) judged(mutator.next(), arguments.limit_s);
  std::printf("%zu inputs and %llu changed ones: %llu accepted, %llu refused\n", inputs.size(),
              static_cast<unsigned long long>(arguments.runs), static_cast<unsigned long long>(counts[1]),
              static_cast<unsigned long long>(counts[2]));
  const bool seen_both = counts[1] > 0 && counts[2] > 0;
  if (arguments.runs > 0 && !seen_both)
    std::fprintf(stderr, "fuzz: all were judged alike, so the corpus is of no use\n");
  return wrong == 0 && (arguments.runs == 0 || seen_both) ? 0 : 1;
}
