// SPDX-License-Identifier: Apache-2.0
#include "apps/study/field_rivals.hpp"

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

[[noreturn]] void hasNoWay(const std::string& library, const std::string& job, const std::string& why) {
  throw Error(Error::Code::kNotFound, fmt::format("{}, {}", library, job), why,
              "the other rows of the study do not need it");
}

}  // namespace

FieldRivals::FieldRivals(std::vector<std::string> python)
    : python_words_(std::move(python)), threads_(std::max(1U, std::thread::hardware_concurrency())) {}

RunCost FieldRivals::run(const std::string& library, const std::string& job, const RivalField& field, std::string& way,
                         std::vector<float>* result) {
  const std::vector<Rival> rivals = rivalsOf(library, job, field);
  if (rivals.empty()) hasNoWay(library, job, "it has no such way");
  way = rivals.front().way;
  return rivals.front().run(result);
}

std::vector<Rival> FieldRivals::rivalsOf(const std::string& library, const std::string& job, const RivalField& field) {
  if (library == "ITK") return itkRivals(job, field, threads_);
  if (library == "OpenVDB") {
    return openvdb_.try_emplace(field.densities.data(), field, threads_).first->second.rivalsOf(job);
  }
  return pythonRivalsOf(library, job, field);
}

std::vector<Rival> FieldRivals::pythonRivalsOf(const std::string& library, const std::string& job,
                                               const RivalField& field) {
  if (!python_) python_ = std::make_unique<PythonRivals>(threads_, python_words_);
  for (const MissingRival& missing : python_->missing()) {
    if (missing.library == library && (missing.job.empty() || missing.job == job)) hasNoWay(library, job, missing.why);
  }
  std::vector<Rival> rivals = python_->rivalsOf(job);
  std::erase_if(rivals, [&](const Rival& rival) { return rival.library != library; });
  if (rivals.empty() || python_has_ == field.densities.data()) return rivals;
  python_has_ = nullptr;
  if (const std::optional<std::string> why = python_->load(field)) hasNoWay(library, job, *why);
  python_has_ = field.densities.data();
  return rivals;
}

}  // namespace palpate
