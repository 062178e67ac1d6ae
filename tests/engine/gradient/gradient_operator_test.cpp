// SPDX-License-Identifier: Apache-2.0
#include "engine/gradient/gradient_operator.hpp"

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/typo.hpp"

namespace palpate {
namespace gradient_operator_test {

using testing::HasSubstr;

TEST(GradientOperator, IsFoundByItsName) {
  EXPECT_EQ(GradientOperator().kind.name, "central");
  for (const GradientKind& row : gradientKinds()) {
    const GradientOperator gradient_operator =
        gradientOperator(std::string(row.name) + (row.parameter.empty() ? "" : ":1"));
    EXPECT_EQ(gradient_operator.kind.name, row.name);
    EXPECT_EQ(gradient_operator.kind.stencil, row.stencil);
    EXPECT_EQ(gradient_operator.smooths(), !row.parameter.empty());
    EXPECT_FALSE(row.description.empty());
    EXPECT_THAT(gradientNames(), HasSubstr(std::string(row.name)));
  }
  EXPECT_EQ(gradientOperator("central4").kind.reach, 2);
  EXPECT_EQ(gradientOperator("sobel").kind.reach, 1);
  EXPECT_EQ(gradientOperator("central").kind.reach, 1);
  EXPECT_EQ(gradientOperator("gaussian:1").kind.reach, 1);
  EXPECT_EQ(gradientNames(), "central, sobel, central4, gaussian:0.8mm");
}

TEST(GradientOperator, OfAGaussianTakesItsKeys) {
  const GradientOperator gradient_operator = gradientOperator("gaussian:0.8mm:truncate=4");
  ASSERT_EQ(gradient_operator.smoothing.size(), 1U);
  EXPECT_DOUBLE_EQ(gradient_operator.smoothing[0].size.value, 0.8e-3);
  EXPECT_TRUE(gradient_operator.smoothing[0].size.in_metres);
  EXPECT_EQ(gradient_operator.smoothing[0].truncate, 4);
}

TEST(GradientOperator, RefusesWhatIsNone) {
  for (const char* text : {"", "prewitt", "Sobel", "central:1", "sobel:1mm", "gaussian", "gaussian:", "gaussian:0",
                           "gaussian:-1mm", "gaussian:1parsec", "gaussian:1 median:1", "gaussian:1 ", ":1"}) {
    try {
      (void)gradientOperator(text);
      ADD_FAILURE() << "'" << text << "' was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput) << text;
    }
  }
  const auto refusal = [](const char* text) { return refusalOf([&] { static_cast<void>(gradientOperator(text)); }); };
  const std::string use = "; use central, sobel, central4, gaussian:0.8mm";
  EXPECT_EQ(refusal("prewitt"), "gradient operator 'prewitt': there is none of this name" + use);
  EXPECT_EQ(refusal("central:1"), "gradient operator 'central:1': central takes nothing behind its name" + use);
  EXPECT_EQ(refusal("gaussian:1 median:1"), "gradient operator 'gaussian:1 median:1': it is more than one word" + use);
}

TEST(GradientOperator, ANameWithATypoIsRecognised) {
  std::vector<std::string> names;
  for (const GradientKind& row : gradientKinds()) names.emplace_back(row.name);
  forEachTypo(names, [](const std::string& name, const std::string& typed) {
    const std::string message = refusalOf([&] { static_cast<void>(gradientOperator(typed + ":1")); });
    EXPECT_THAT(suggestedIn(message), HasSubstr(name)) << message;
  });
}

}  // namespace gradient_operator_test
}  // namespace palpate
