// SPDX-License-Identifier: Apache-2.0
// Files of a volume that is edited while it is touched, and its end.
#include "apps/live/live_volume.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/console/progress.hpp"
#include "engine/files/volume_file.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace live_volume_test {

using testing::HasSubstr;

class Live : public testing::Test {
 protected:
  Live() {
    Progress silent(nullptr);
    live_.emplace(
        LiveVolumeRequest{.volume = "phantom:sphere?size=16", .plan = makePlan({.edits = true}), .work = "a test"},
        silent, [this](const std::string& words) { told_.push_back(words); });
  }
  [[nodiscard]] EditCommand edit() {
    EditCommand command;
    command.kind = EditKind::kAdd;
    command.from_W = command.to_W = live_->volume().lattice().toWorld(Vec3::Constant(2));
    command.radius_m = 1e-3;
    return command;
  }
  // What became of a file that is asked for.
  void save() {
    live_->save((folder_.path() / "out.vdb").string(), 0,
                [this](const LiveVolume::Saved& saved) { outcomes_.push_back(saved); });
  }
  TemporaryFolder folder_;
  std::vector<std::string> told_;
  std::vector<LiveVolume::Saved> outcomes_;
  std::optional<LiveVolume> live_;
};

// Whoever asks before the first look is told of the edits that were made again, and so is who reads the messages.
TEST_F(Live, KnowsTheEditsOfAJournalFromTheStart) {
  Progress silent(nullptr);
  std::string said;
  const auto opened = [&](const std::string& journal, const std::string& recovers) {
    LiveVolumeRequest request{.volume = "phantom:sphere?size=16", .plan = makePlan({.edits = true}), .work = "a test"};
    request.journal = folder_.path() / journal;
    if (!recovers.empty()) request.recovers = folder_.path() / recovers;
    return LiveVolume(request, silent, [&](const std::string& words) { said += words; });
  };
  const EditCommand command = edit();
  {
    LiveVolume first = opened("first", "");
    EXPECT_EQ(said, "");
    for (int i = 0; i < 3; ++i) {
      first.edits().edit({command}, [](const std::optional<Error>& refusal) { EXPECT_FALSE(refusal); });
      first.edits().doWaiting(0);
    }
    static_cast<void>(first.session().edit({&command, 1}, 0, UndoStep::kLast));  // the last one's stroke goes on
  }
  const LiveVolume again = opened("again", "first");
  EXPECT_EQ(again.edits().counts().edits, 4U);
  EXPECT_EQ(again.edits().counts().done, 3U);
  EXPECT_EQ(said, "edits of the session before that are in the volume again: 4; steps that can be undone: 3");
  EXPECT_TRUE(again.isUnsaved());
}

TEST_F(Live, AFileThatIsAskedForHasEveryEditUntilThen) {
  const EditCommand command = edit();
  live_->edits().edit({command}, [](const std::optional<Error>& refusal) { EXPECT_FALSE(refusal); });
  live_->edits().doWaiting(0);
  EXPECT_TRUE(live_->isUnsaved());
  save();
  live_->edits().doWaiting(0);
  live_->close();
  ASSERT_EQ(outcomes_.size(), 1U);
  EXPECT_TRUE(outcomes_[0].written) << outcomes_[0].words;
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out.vdb"));
  EXPECT_FALSE(live_->isUnsaved());
}

// It is told at once, and with the reason.
TEST_F(Live, AFileIsRefusedWhereTooManyEditsWait) {
  const EditCommand command = edit();
  for (std::size_t i = 0; i < RigEdits::kMostWaiting; ++i)
    live_->edits().edit({command}, [](const std::optional<Error>& refusal) { EXPECT_FALSE(refusal); });
  save();
  ASSERT_EQ(outcomes_.size(), 1U);
  EXPECT_FALSE(outcomes_[0].written);
  EXPECT_THAT(outcomes_[0].words,
              HasSubstr("out.vdb: it was not written: too many requests wait, or editing has ended"));
  EXPECT_EQ(live_->errands(), 0U);
  live_->edits().doWaiting(0);
  save();
  live_->close();
  ASSERT_EQ(outcomes_.size(), 2U);
  EXPECT_TRUE(outcomes_[1].written) << outcomes_[1].words;
}

// What a live volume of this name says, with the filters of its plan.
std::vector<std::string> saidOf(const std::string& volume, const std::string& filter, bool takes_filters = true) {
  std::vector<std::string> said;
  Progress silent(nullptr);
  const LiveVolume live({.volume = volume,
                         .plan = makePlan({.filter = filter, .edits = true}),
                         .work = "a test",
                         .takes_filters = takes_filters},
                        silent, [&](const std::string& words) { said.push_back(words); });
  return said;
}

// A window and a service tell of it by the same words as `palpate touch`; a window has no filters.
TEST(LiveMask, IsSaidToBeFeltAsStairs) {
  const TemporaryFolder folder;
  const std::string mask = (folder.path() / "mask.nrrd").string();
  const Volume ball = loadVolume("phantom:sphere?size=24");
  std::vector<float> values = ball.toDense();
  for (float& value : values) value = value > 0 ? 1 : 0;
  saveVolume(Volume::fromDense(ball.size(), ball.lattice(), values, {}), mask);
  EXPECT_THAT(saidOf(mask, ""), testing::ElementsAre(HasSubstr("2 values (0, 1), so its surface is felt as stairs: "
                                                               "--filter gaussian:1.5")));
  EXPECT_THAT(saidOf(mask, "", false), testing::ElementsAre(HasSubstr("palpate filter IN -o smooth.vdb --filter")));
  EXPECT_THAT(saidOf(mask, "gaussian:1.5"), testing::IsEmpty());
  EXPECT_THAT(saidOf("phantom:sphere?size=24", ""), testing::IsEmpty());
}

// For another isovalue the same words as a start at it would say, though the volume is the saver's meanwhile.
TEST(LiveMask, IsSaidAtAnyIsovalueThatPartsIt) {
  const TemporaryFolder folder;
  const std::string labels = (folder.path() / "labels.nrrd").string();
  const Volume ball = loadVolume("phantom:sphere?size=24");
  std::vector<float> values = ball.toDense();
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = values[n] <= 0 ? 0 : n % 24 < 12 ? 3 : 1;  // two halves
  saveVolume(Volume::fromDense(ball.size(), ball.lattice(), values, {}), labels);
  Progress silent(nullptr);
  const auto at = [&](double isovalue) {
    return LiveVolume({.volume = labels, .isovalue = isovalue, .plan = makePlan({.edits = true}), .work = "a test"},
                      silent, [](const std::string&) {});
  };
  const LiveVolume live = at(0.5);
  const Plan plain = makePlan({.edits = true});
  EXPECT_THAT(live.stairsAt(0.5, plain), HasSubstr("isovalue 0.5 feels those from 1 to 3 as one object"));
  EXPECT_THAT(live.stairsAt(2, plain), HasSubstr("isovalue 2 feels label 3 alone"));
  EXPECT_EQ(live.stairsAt(2, plain), at(2).stairsAt(2, plain));
  EXPECT_THAT(live.stairsAt(2, makePlan({.filter = "gaussian:1.5"})), HasSubstr("isovalue 2 feels label 3 alone"));
  for (const double beyond : {-1.0, 3.0, 1e9}) EXPECT_EQ(live.stairsAt(beyond, plain), "") << beyond;
}

}  // namespace live_volume_test
}  // namespace palpate
