// SPDX-License-Identifier: Apache-2.0
// Against the eigenvalues of the companion matrix where there are few roots, and where there are many, against loops
// whose limit of stability is known in closed form.
#include "servo/stability/late_feedback.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "support/seeded.hpp"

namespace palpate {
namespace late_feedback_test {

// Powers of z, the lowest first.
Eigen::VectorXd product(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  Eigen::VectorXd c = Eigen::VectorXd::Zero(a.size() + b.size() - 1);
  for (Eigen::Index i = 0; i < a.size(); ++i) c.segment(i, b.size()) += a[i] * b;
  return c;
}

Eigen::VectorXd powersOf(const std::vector<LoopFactor>& factors) {
  Eigen::VectorXd all = Eigen::VectorXd::Ones(1);
  for (const LoopFactor& f : factors) {
    const int degree = f.square != 0 ? 2 : f.linear != 0 ? 1 : 0;
    const Eigen::Vector3d one(f.constant - f.linear + f.square, f.linear - 2 * f.square, f.square);
    all = product(all, one.head(degree + 1));
  }
  return all;
}

// Nothing where a root lies so near the circle that rounding may move it across. The eigenvalues are those of a matrix
// that differs by its order times epsilon of its norm; a cluster of k roots moves by the k-th root of that, and more
// than four do not lie together by chance.
std::optional<int> insideByEigenvalues(const LateFeedback& loop) {
  const Eigen::VectorXd open = powersOf(loop.open), feedback = powersOf(loop.feedback);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(open.size() + loop.delay_ticks);
  f.tail(open.size()) = open;
  f.head(feedback.size()) += feedback;
  const Eigen::Index degree = f.size() - 1;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
  companion.bottomLeftCorner(degree - 1, degree - 1).setIdentity();
  companion.col(degree - 1) = -f.head(degree) / f[degree];
  const double rounding = static_cast<double>(degree) * std::numeric_limits<double>::epsilon() * companion.norm();
  int inside = 0;
  for (const std::complex<double>& root : companion.eigenvalues()) {
    if (std::abs(std::abs(root) - 1) < std::pow(rounding, 0.25)) return std::nullopt;
    if (std::abs(root) < 1) ++inside;
  }
  return inside;
}

// A factor with roots anywhere, real ones or a pair, seen from z = 1.
LoopFactor anyFactor(Seeded& dice, int degree) {
  if (degree == 0) return {dice.pick(2) == 0 ? -1.0 : 1.0};
  if (degree == 1) return {dice.between(-2, 3), 1};
  return {dice.between(-2, 4), dice.between(-1, 4), 1};
}

TEST(LateFeedback, CountsTheRootsThatTheCompanionMatrixHas) {
  Seeded dice(1);
  int counted = 0, all = 0, none = 0;
  for (int i = 0; i < 5000; ++i) {
    const LateFeedback loop = {
        .open = {anyFactor(dice, 2), anyFactor(dice, 1)},
        .feedback = {anyFactor(dice, dice.pick(2)), anyFactor(dice, dice.pick(2)), {dice.logBetween(1e-3, 1e2)}},
        .delay_ticks = dice.pick(4) == 0 ? dice.pick(41) : dice.pick(5)};
    const std::optional<int> exact = insideByEigenvalues(loop);
    if (!exact) continue;
    ++counted;
    EXPECT_EQ(rootsInside(loop), *exact) << i << " d " << loop.delay_ticks;
    const int degree = loop.delay_ticks + 3;
    EXPECT_EQ(allInside(loop), *exact == degree) << i;
    all += *exact == degree ? 1 : 0;
    none += *exact == 0 ? 1 : 0;
  }
  EXPECT_GT(counted, 3000);
  EXPECT_GT(all, 100);
  EXPECT_GT(none, 10);
}

// x_{k+1} = x_k - c x_{k-d} settles for 0 < c < 2 cos(d pi / (2 d + 1)) (Levin and May 1976). The closed form is
// rounded to some 1e-16 of its cosine's argument, so by 1e-16 (2 d + 1) of itself: 1e-9 is beyond that for all of
// these.
TEST(LateFeedback, AnIntegratorBearsWhatLevinAndMayFound) {
  for (const int d : {0, 1, 2, 7, 100, 1000, 10'000, 1'000'000}) {
    const double most = 2 * std::cos(d * M_PI / (2.0 * d + 1));
    const auto isStableWith = [d](double c) {
      return allInside({.open = {{0, 1}}, .feedback = {{c}}, .delay_ticks = d});
    };
    EXPECT_TRUE(isStableWith(most * (1 - 1e-9))) << d;
    EXPECT_FALSE(isStableWith(most * (1 + 1e-9))) << d;
    EXPECT_TRUE(isStableWith(most * 1e-6)) << d;
    EXPECT_FALSE(isStableWith(0)) << d;
    EXPECT_FALSE(isStableWith(-1e-6 * most)) << d;
  }
}

// z^n = -c has n roots of one size: all inside or none.
TEST(LateFeedback, ManyRootsOfOneSizeAreInsideOrOutside) {
  for (const int d : {0, 1, 5, 999, 9999}) {
    const std::vector<LoopFactor> z = {{1, 1}};
    EXPECT_EQ(rootsInside({.open = z, .feedback = {{0.999}}, .delay_ticks = d}), d + 1);
    EXPECT_EQ(rootsInside({.open = z, .feedback = {{-0.999}}, .delay_ticks = d}), d + 1);
    EXPECT_EQ(rootsInside({.open = z, .feedback = {{1.001}}, .delay_ticks = d}), 0);
    EXPECT_EQ(rootsInside({.open = z, .feedback = {{-1.001}}, .delay_ticks = d}), 0);
  }
}

// Without feedback the roots are those of A, and d at zero.
TEST(LateFeedback, WithoutFeedbackTheRootsAreThoseOfTheOpenLoop) {
  const LoopFactor nothing = {0}, slow = {0.1, 1}, fast = {-0.1, 1};  // roots z = 0.9, 1.1
  EXPECT_EQ(rootsInside({.open = {slow, fast}, .feedback = {nothing}, .delay_ticks = 50}), 51);
  EXPECT_EQ(rootsInside({.open = {slow, slow}, .feedback = {nothing}, .delay_ticks = 50}), 52);
  const LoopFactor pair_inside = {0.5, 1, 1}, pair_outside = {1.5, 1, 1};  // |z|^2 = 1 - linear + constant
  EXPECT_EQ(rootsInside({.open = {pair_inside}, .feedback = {nothing}}), 2);
  EXPECT_EQ(rootsInside({.open = {pair_outside}, .feedback = {nothing}}), 0);
  const LoopFactor twice = {0, 0, 1};  // a free mass: both roots at z = 1
  EXPECT_FALSE(allInside({.open = {twice}, .feedback = {nothing}}));
}

}  // namespace late_feedback_test
}  // namespace palpate
