// SPDX-License-Identifier: Apache-2.0
// What a service and a window tell each other comes out as it was, and what is none is refused.
#include "apps/onlook/onlook_messages.hpp"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/any_settings.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace onlook_messages_test {

using testing::HasSubstr;

// Through the bytes of a message.
wire::AnswerT sent(wire::AnswerT answer) {
  wire::BodyUnion body = decoded(encoded(std::move(answer)), "test");
  return std::move(*contentOf<wire::AnswerT>(body));
}
wire::AskT sent(wire::AskT ask) {
  wire::BodyUnion body = decoded(encoded(std::move(ask)), "test");
  return std::move(*contentOf<wire::AskT>(body));
}

ServedFacts anyFacts(Seeded& random) {
  ServedFacts facts;
  SeenVolume& volume = facts.volume;
  volume.name = random.pick(2) == 0 ? "phantom:knot" : "/a file \xC3\xA9.nii";
  volume.size = {1 + random.pick(2000), 1 + random.pick(2000), 1 + random.pick(2000)};
  volume.lattice = {.origin_W = random.inCube(1),
                    .R_WL = random.axes(random.pick(2) == 0),
                    .spacing_m = Vec3::Constant(1e-4) + 1e-3 * random.direction().cwiseAbs()};
  volume.statistics = {.minimum = random.between(-1000, 0),
                       .maximum = random.between(1, 3000),
                       .mean = random.between(0, 1),
                       .histogram = {.low = random.between(-1000, 0), .bin_width = random.between(0, 9), .counts = {}},
                       .fill_share = random.between(0, 1),
                       .suggestions = {}};
  for (int i = 0; i < 256; ++i)
    volume.statistics.histogram.counts.push_back(static_cast<std::uint64_t>(random.logBetween(1, 1e15)));
  for (int i = random.pick(4); i > 0; --i)
    volume.statistics.suggestions.push_back({random.between(-1, 1), "Otsu's threshold"});
  volume.object.middle_W = random.inCube(1);
  for (int i = 0; i < 1 + random.pick(50); ++i) volume.object.points_W.push_back(random.inCube(1));
  facts.device = "polhem-v1";
  facts.device_is_held = random.pick(2) == 0;
  facts.keeps_journal = random.pick(2) == 0;
  for (int i = random.pick(40); i > 0; --i)
    facts.plan.push_back({random.pick(2) == 0, "gradient of 7 bricks", "they are felt", 1ULL << random.pick(40)});
  facts.settings = anySettings(random);
  return facts;
}

void expectSame(const ServedFacts& a, const ServedFacts& b) {
  EXPECT_EQ(a.volume.name, b.volume.name);
  EXPECT_EQ(a.volume.size, b.volume.size);
  EXPECT_EQ(a.volume.lattice.origin_W, b.volume.lattice.origin_W);
  EXPECT_EQ(a.volume.lattice.R_WL, b.volume.lattice.R_WL);
  EXPECT_EQ(a.volume.lattice.spacing_m, b.volume.lattice.spacing_m);
  const VolumeStatistics &s = a.volume.statistics, &t = b.volume.statistics;
  EXPECT_EQ(std::tuple(s.minimum, s.maximum, s.mean, s.fill_share, s.histogram.low, s.histogram.bin_width),
            std::tuple(t.minimum, t.maximum, t.mean, t.fill_share, t.histogram.low, t.histogram.bin_width));
  EXPECT_EQ(s.histogram.counts, t.histogram.counts);
  ASSERT_EQ(s.suggestions.size(), t.suggestions.size());
  for (std::size_t i = 0; i < s.suggestions.size(); ++i) {
    EXPECT_EQ(s.suggestions[i].isovalue, t.suggestions[i].isovalue);
    EXPECT_EQ(s.suggestions[i].reason, t.suggestions[i].reason);
  }
  EXPECT_EQ(a.volume.object.middle_W, b.volume.object.middle_W);
  EXPECT_EQ(a.volume.object.points_W, b.volume.object.points_W);
  EXPECT_EQ(a.device, b.device);
  EXPECT_EQ(std::pair(a.device_is_held, a.keeps_journal), std::pair(b.device_is_held, b.keeps_journal));
  ASSERT_EQ(a.plan.size(), b.plan.size());
  for (std::size_t i = 0; i < a.plan.size(); ++i)
    EXPECT_EQ(std::tuple(a.plan[i].done, a.plan[i].what, a.plan[i].why, a.plan[i].saved_bytes),
              std::tuple(b.plan[i].done, b.plan[i].what, b.plan[i].why, b.plan[i].saved_bytes));
  EXPECT_EQ(a.settings, b.settings);
}

TEST(OnlookMessages, OfWhatIsServedComeOutAsTheyWere) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Seeded random(seed);
    const ServedFacts facts = anyFacts(random);
    wire::AnswerT answer;
    answer.facts = wireOf(facts);
    expectSame(factsOf(sent(std::move(answer)).facts), facts);
  }
}

// Whatever the volume, they fit a packet of 64 KiB.
TEST(OnlookMessages, OfALargeObjectFitAPacket) {
  Seeded random(1);
  ServedFacts facts = anyFacts(random);
  facts.volume.name.assign(4000, 'x');
  for (int i = 0; i < 20'000; ++i) facts.volume.object.points_W.push_back(random.direction());
  facts.plan.assign(100, {true, std::string(60, 'x'), std::string(60, 'y'), 1});
  wire::AnswerT answer;
  answer.facts = wireOf(facts);
  EXPECT_EQ(answer.facts->object_points.size() % 3, 0U);
  EXPECT_LE(encoded(std::move(answer)).size(), 65536U);
}

TEST(OnlookMessages, OfWhatIsNoVolumeAreRefused) {
  const auto refusal = [](const std::function<void(wire::FactsT&)>& spoil) {
    Seeded random(3);
    auto facts = wireOf(anyFacts(random));
    spoil(*facts);
    return refusalOf([&] { static_cast<void>(factsOf(facts)); });
  };
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([](wire::FactsT& f) { f.rows = 0; }), HasSubstr("it has no voxels"));
  EXPECT_THAT(refusal([](wire::FactsT& f) { f.axes.pop_back(); }), HasSubstr("8 numbers for its axes"));
  EXPECT_NE(refusal([](wire::FactsT& f) { f.spacing = nullptr; }), "");
  EXPECT_NE(refusal([&](wire::FactsT& f) { f.axes[4] = none; }), "");
  EXPECT_THAT(refusal([&](wire::FactsT& f) { f.mean = none; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([&](wire::FactsT& f) { f.object_points[1] = none; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([](wire::FactsT& f) { f.object_points.pop_back(); }), HasSubstr("are no places"));
  EXPECT_THAT(refusal([](wire::FactsT& f) { f.object_points.clear(); }), HasSubstr("0 numbers are no places"));
  EXPECT_THAT(refusal([&](wire::FactsT& f) { f.object_middle->x = none; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([](wire::FactsT& f) { f.settings = nullptr; }), HasSubstr("has none"));
  EXPECT_THAT(refusalOf([] { static_cast<void>(factsOf(nullptr)); }), HasSubstr("nothing is said of it"));
}

Looked anyLooked(Seeded& random, std::size_t steps) {
  Looked looked;
  looked.has_servo = random.pick(2) == 0;
  looked.can_edit = random.pick(2) == 0;
  looked.force_off = static_cast<ForceOff>(random.pick(3));
  for (std::size_t i = 0; i < steps; ++i)
    looked.edits.steps.push_back(
        {static_cast<EditKind>(random.pick(kEditKinds)), static_cast<std::uint32_t>(random.logBetween(1, 4e9))});
  looked.has_steps = steps > 0;
  looked.edits.edits = 7;
  looked.edits.refused = 3;
  looked.edits.content_version = 1ULL << 40;
  looked.edits.done = 5;
  looked.edits.undone = 6;
  looked.edits.waiting = 2;
  looked.older_steps = steps > 0 ? 10 : 0;
  looked.settings = anySettings(random);
  looked.drawing_failure = "no";
  looked.journal_failure = "full";
  return looked;
}

TEST(OnlookMessages, OfHowItGoesComeOutAsTheyWere) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Seeded random(seed);
    const std::size_t steps = seed % 3 == 0 ? 0 : seed % 3 == 1 ? 5 : kMostSteps + 5;
    const Looked looked = anyLooked(random, steps);
    wire::AnswerT answer;
    answer.looked = wireOf(looked);
    const std::vector<std::byte> bytes = encoded(sent(std::move(answer)));
    EXPECT_LE(bytes.size(), 65536U);
    wire::BodyUnion body = decoded(bytes, "test");
    const Looked out = lookedOf(contentOf<wire::AnswerT>(body)->looked);
    EXPECT_EQ(std::tuple(out.has_servo, out.can_edit, out.force_off, out.has_steps),
              std::tuple(looked.has_servo, looked.can_edit, looked.force_off, looked.has_steps));
    EXPECT_EQ(std::tuple(out.edits.edits, out.edits.refused, out.edits.content_version, out.edits.done,
                         out.edits.undone, out.edits.waiting, out.edits.editing),
              std::tuple(7U, 3U, 1ULL << 40, 5U, 6U, 2U, looked.can_edit));
    const std::size_t kept = std::min(steps, kMostSteps);
    ASSERT_EQ(out.edits.steps.size(), kept);
    EXPECT_EQ(out.older_steps, looked.older_steps + steps - kept);
    for (std::size_t i = 0; i < kept; ++i) {
      EXPECT_EQ(out.edits.steps[i].kind, looked.edits.steps[steps - kept + i].kind);
      EXPECT_EQ(out.edits.steps[i].edits, looked.edits.steps[steps - kept + i].edits);
    }
    EXPECT_EQ(out.settings, looked.settings);
    EXPECT_EQ(std::pair(out.drawing_failure, out.journal_failure), std::pair(std::string("no"), std::string("full")));
  }
}

TEST(OnlookMessages, OfHowItGoesAreRefusedIfTheyAreNone) {
  const auto refusal = [](const std::function<void(wire::LookedT&)>& spoil) {
    Seeded random(3);
    auto looked = wireOf(anyLooked(random, 5));
    spoil(*looked);
    return refusalOf([&] { static_cast<void>(lookedOf(looked)); });
  };
  EXPECT_THAT(refusal([](wire::LookedT& l) { l.step_kinds[2] = kEditKinds; }), HasSubstr("unknown kind"));
  EXPECT_THAT(refusal([](wire::LookedT& l) { l.step_edits.pop_back(); }), HasSubstr("differ in length"));
  EXPECT_THAT(refusal([](wire::LookedT& l) { l.settings = nullptr; }), HasSubstr("has none"));
  EXPECT_THAT(refusalOf([] { static_cast<void>(lookedOf(nullptr)); }), HasSubstr("how it goes"));
}

ViewRequest anyView(Seeded& random) {
  const Mat3 axes = random.axes(false);
  ViewRequest view;
  view.camera = {.position_W = random.inCube(1),
                 .forward_W = axes.col(0),
                 .right_W = axes.col(1),
                 .up_W = axes.col(2),
                 .vertical_fov_rad = random.between(0.01, 3),
                 .width = 1 + random.pick(4000),
                 .height = 1 + random.pick(4000)};
  view.style.occlusion = random.pick(2) == 0;
  view.style.normals = random.pick(2) == 0;
  for (int i = random.pick(7); i > 0; --i)
    view.style.clips.push_back({random.between(0.1, 9) * random.direction(), random.between(-1, 1)});
  for (int i = random.pick(4); i > 0; --i) view.style.slices.push_back({random.direction(), random.between(-1, 1)});
  view.style.slice_black = random.between(-1000, 0);
  view.style.slice_white = random.between(0, 1000);
  if (random.pick(2) == 0) view.style.other_isovalue = random.between(-1000, 1000);
  view.style.other_opacity = random.between(0, 1);
  view.order = static_cast<DrawOrder>(random.pick(2));
  return view;
}

TEST(OnlookMessages, OfAViewComeOutAsTheyWere) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Seeded random(seed);
    const ViewRequest view = anyView(random);
    wire::AskT ask = asking(wire::Verb::Show);
    ask.view = wireOf(view);
    EXPECT_EQ(viewOf(sent(std::move(ask)).view), view) << seed;
  }
}

TEST(OnlookMessages, OfAViewAreRefusedIfTheyAreNone) {
  const auto refusal = [](const std::function<void(wire::ViewT&)>& spoil) {
    Seeded random(3);
    auto view = wireOf(anyView(random));
    spoil(*view);
    return refusalOf([&] { static_cast<void>(viewOf(view)); });
  };
  EXPECT_EQ(refusal([](wire::ViewT&) {}), "accepted");
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.width = 0; }), HasSubstr("no picture has 0 x"));
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.height = -5; }), HasSubstr("no picture has"));
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.width = PICTURE_MOST_SIDE + 1; }), HasSubstr("no picture has"));
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.width = v.height = PICTURE_MOST_SIDE; }), HasSubstr("no picture has"));
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.vertical_fov_rad = 0; }), HasSubstr("no camera sees 0 rad"));
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.vertical_fov_rad = 3.2; }), HasSubstr("no camera sees 3.2 rad"));
  EXPECT_THAT(refusal([&](wire::ViewT& v) { v.vertical_fov_rad = none; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([&](wire::ViewT& v) { v.position->y = none; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.up = nullptr; }), HasSubstr("not of length 1"));
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.right->x += 0.01; }), HasSubstr("not of length 1"));
  EXPECT_THAT(refusal([&](wire::ViewT& v) { v.slice_white = none; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([&](wire::ViewT& v) { v.other_opacity = none; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.order = 2; }), HasSubstr("the number 2"));
  EXPECT_THAT(refusal([](wire::ViewT& v) {
                v.clips.clear();
                for (int i = 0; i < 17; ++i) v.clips.push_back(std::make_unique<wire::PlaneT>());
              }),
              HasSubstr("17 planes"));
  EXPECT_THAT(refusal([](wire::ViewT& v) { v.slices.clear(), v.slices.emplace_back(); }),
              HasSubstr("a plane is missing"));
  EXPECT_THAT(refusalOf([] { static_cast<void>(viewOf(nullptr)); }), HasSubstr("the question has none"));
}

}  // namespace onlook_messages_test
}  // namespace palpate
