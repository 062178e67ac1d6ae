// SPDX-License-Identifier: Apache-2.0
// apps/study/field_rivals.hpp: other libraries' filters and gradients for the cells of a study, which come in any order
// and on several volumes. One thread.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/rivals/rivals.hpp"

namespace palpate {

class FieldRivals {
 public:
  // `python`: as of PythonRivals, which start when they are first needed.
  explicit FieldRivals(std::vector<std::string> python);

  // Runs a library's way to do a job, its first one if it has several, on a field that lives as long as this. `way`
  // receives how the library calls it. Throws Error: kNotFound if the library is not installed or has no such way; as
  // the rivals do.
  RunCost run(const std::string& library, const std::string& job, const RivalField& field, std::string& way,
              std::vector<float>* result);

 private:
  [[nodiscard]] std::vector<Rival> rivalsOf(const std::string& library, const std::string& job,
                                            const RivalField& field);
  [[nodiscard]] std::vector<Rival> pythonRivalsOf(const std::string& library, const std::string& job,
                                                  const RivalField& field);

  std::vector<std::string> python_words_;
  unsigned threads_;
  std::unique_ptr<PythonRivals> python_;
  const float* python_has_ = nullptr;              // the field that the child has loaded
  std::map<const float*, OpenVdbRivals> openvdb_;  // by field
};

}  // namespace palpate
