// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/kept_settings.hpp"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/serve/live_setting.hpp"
#include "base/error.hpp"
#include "tests/apps/report/temporary_folder.hpp"
#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace kept_settings_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Kept : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "settings.json"; }
  // A service that begins with `scene`, in which it chooses the isovalue, is told something, and is killed.
  template <typename Told>
  void runs(const Scene& scene, const Told& told, bool ends = false) {
    KeptSettings settings(file(), scene, [this](const std::string& words) { said_.push_back(words); });
    Scene served = settings.taken();
    if (!served.isovalue) served.isovalue = 226;
    settings.begin(served);
    settings.look(served, 1'000'000'000);
    told(served);
    settings.look(served, 2'000'000'000);
    if (ends) settings.forget();
  }
  // What the next one begins with.
  [[nodiscard]] Scene next(const Scene& scene) {
    said_.clear();
    KeptSettings settings(file(), scene, [this](const std::string& words) { said_.push_back(words); });
    settings.begin(settings.taken());
    return settings.taken();
  }
  const TemporaryFolder folder_;
  std::vector<std::string> said_;
};

TEST_F(Kept, WhatWasToldComesBackAfterACrash) {
  const Scene scene;
  runs(scene, [](Scene& served) {
    served.stiffness_N_per_m = 432.1;
    served.isovalue = 300.25;
    served.filter = "gaussian:0.8mm";
  });
  const Scene again = next(scene);
  EXPECT_EQ(again.stiffness_N_per_m, 432.1);
  EXPECT_EQ(again.isovalue, 300.25);
  EXPECT_EQ(again.filter, "gaussian:0.8mm");
  EXPECT_THAT(said_, ElementsAre(HasSubstr("servo.stiffness_N_per_m = 432.1")));
  runs(scene, [](Scene&) {});  // it is killed again
  EXPECT_EQ(next(scene).stiffness_N_per_m, 432.1);
  runs(scene, [](Scene& served) { served.filter.clear(); });
  const Scene third = next(scene);
  EXPECT_EQ(third.filter, "");
  EXPECT_EQ(third.isovalue, 300.25);
}

TEST_F(Kept, WhatTheServiceChoseIsNotKept) {
  runs(Scene{}, [](Scene&) {});
  EXPECT_FALSE(std::filesystem::exists(file()));
  EXPECT_FALSE(next(Scene{}).isovalue);
}

// Also a filter that the scene has, and a value that is set back.
TEST_F(Kept, TheScenesOwnValuesAreNotKept) {
  Scene scene;
  scene.filter = "gaussian:0.8mm";
  scene.force_limit_N = 2;
  runs(scene, [](Scene& served) {
    served.filter.clear();
    served.force_limit_N = 1;
  });
  EXPECT_EQ(next(scene).filter, "");
  EXPECT_EQ(next(scene).force_limit_N, 1);
  runs(scene, [](Scene& served) { served.force_limit_N = 2; });
  EXPECT_EQ(next(scene).force_limit_N, 2);
  EXPECT_EQ(next(scene).filter, "");
  EXPECT_THAT(said_, ElementsAre(testing::Not(HasSubstr("force_limit"))));
}

TEST_F(Kept, ASceneThatWasChangedMeanwhileIsTheLaterWord) {
  Scene scene;
  runs(scene, [](Scene& served) {
    served.force_limit_N = 1;
    served.damping_Ns_per_m = 0.25;
  });
  scene.force_limit_N = 2;
  const Scene again = next(scene);
  EXPECT_EQ(again.force_limit_N, 2);
  EXPECT_EQ(again.damping_Ns_per_m, 0.25);
  EXPECT_THAT(said_, ElementsAre(HasSubstr("damping"), HasSubstr("the scene has changed: safety.force_limit_N")));
}

TEST_F(Kept, AnEndInGoodOrderForgets) {
  runs(
      Scene{}, [](Scene& served) { served.force_limit_N = 1; }, true);
  EXPECT_FALSE(std::filesystem::exists(file()));
  EXPECT_EQ(next(Scene{}).force_limit_N, Scene{}.force_limit_N);
}

TEST_F(Kept, ADamagedFileIsToldAndIgnored) {
  runs(Scene{}, [](Scene& served) {
    served.force_limit_N = 1;
    served.damping_Ns_per_m = 0.25;
  });
  std::ifstream in(file());
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  Seeded random(3);
  int ignored = 0;
  for (int i = 0; i < 400; ++i) {
    std::string text = whole;
    const auto at = static_cast<std::size_t>(random.pick(static_cast<int>(text.size())));
    if (i % 2 == 0) {
      text.resize(at);
    } else {
      text[at] = static_cast<char>(random.pick(256));
    }
    std::ofstream(file()) << text;
    const Scene scene = next(Scene{});  // throws nothing
    checkLiveSettings(Scene{}, scene);
    ignored += !said_.empty() && said_[0].find("are not taken") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(ignored, 150);
  for (const char* settings :
       {"[]", "7", R"({"safety.force_limit_N": {"scene": 3, "set": 1}})", "", R"({"servo.n": {}})"}) {
    std::ofstream(file()) << R"({"volume": "", "settings": )" << settings << "}";
    EXPECT_EQ(settingsText(next(Scene{}), {}), settingsText(Scene{}, {})) << settings;
  }
}

// An unknown key is no matter, and one that may not change is not taken.
TEST_F(Kept, OnlyWhatMayChangeIsTaken) {
  std::ofstream(file()) << R"({"volume": "", "settings": {"safety.release_s": {"scene": "1", "set": "9"},)"
                        << R"( "volume": {"scene": "", "set": "other"}}})";
  EXPECT_EQ(settingsText(next(Scene{}), {}), settingsText(Scene{}, {}));
  EXPECT_THAT(said_, IsEmpty());
}

TEST_F(Kept, AnotherVolumeTakesNone) {
  Scene scene;
  scene.volume = "a";
  runs(scene, [](Scene& served) { served.force_limit_N = 1; });
  Scene other = scene;
  other.volume = "b";
  EXPECT_EQ(next(other).force_limit_N, Scene{}.force_limit_N);
  EXPECT_THAT(said_, ElementsAre(HasSubstr("they are of a")));
  EXPECT_EQ(next(scene).force_limit_N, 1);
}

TEST_F(Kept, WhatDoesNotFitIsNotTaken) {
  runs(Scene{}, [](Scene& served) { served.force_limit_N = 1; });
  {
    KeptSettings settings(file(), Scene{}, [this](const std::string& words) { said_.push_back(words); });
    settings.check([](const Scene&) {});
    EXPECT_EQ(settings.taken().force_limit_N, 1);
    said_.clear();
    settings.check([](const Scene& scene) {
      EXPECT_EQ(scene.force_limit_N, 1);
      refuse("the scene", "it does not fit", "change it");
    });
    EXPECT_EQ(settings.taken().force_limit_N, Scene{}.force_limit_N);
    EXPECT_THAT(said_, ElementsAre(HasSubstr("it does not fit")));
    settings.check([](const Scene&) { ADD_FAILURE() << "there is nothing to check"; });
    settings.begin(settings.taken());
    settings.look(settings.taken(), 1'000'000'000);  // the file has it no more
  }
  EXPECT_EQ(next(Scene{}).force_limit_N, Scene{}.force_limit_N);
}

// The service may leave out what it cannot do here.
TEST_F(Kept, WhatTheServiceDidNotTakeIsForgotten) {
  runs(Scene{}, [](Scene& served) {
    served.force_limit_N = 1;
    served.damping_Ns_per_m = 0.25;
  });
  {
    said_.clear();
    KeptSettings settings(file(), Scene{}, [this](const std::string& words) { said_.push_back(words); });
    Scene served = settings.taken();
    served.damping_Ns_per_m = 0.5;  // what it chooses itself
    settings.begin(served);
    EXPECT_THAT(said_, ElementsAre("settings from before are taken again: safety.force_limit_N = 1",
                                   "settings from before are not taken, as they cannot be here: "
                                   "servo.damping_Ns_per_m = 0.25"));
    settings.look(served, 1'000'000'000);
  }
  EXPECT_EQ(next(Scene{}).force_limit_N, 1);
  EXPECT_FALSE(next(Scene{}).damping_Ns_per_m);
}

// A window can clear a table; no text of a flag stands for that.
TEST_F(Kept, ATableThatWasClearedStaysSo) {
  Scene scene;
  scene.stiffness_density = {{100, 1}, {200, 2}};
  runs(scene, [](Scene& served) { served.stiffness_density.clear(); });
  EXPECT_TRUE(next(scene).stiffness_density.empty());
  EXPECT_EQ(scene.stiffness_density.size(), 2U);
}

// While it is on its way the one before is kept, or none.
TEST_F(Kept, AnIsovalueIsKeptOnceItIsFelt) {
  Scene scene;
  scene.isovalue = 100;
  const auto isKept = [&] { return next(scene).isovalue; };
  {
    KeptSettings settings(file(), scene, [](const std::string&) {});
    Scene served = scene;
    settings.begin(served);
    served.isovalue = 200;
    served.force_limit_N = 1;
    settings.look(served, 1'000'000'000, false);
  }
  EXPECT_EQ(isKept(), 100);
  EXPECT_EQ(next(scene).force_limit_N, 1);
  for (const bool is_felt : {true, false}) {
    KeptSettings settings(file(), scene, [](const std::string&) {});
    Scene served = settings.taken();
    settings.begin(served);
    served.isovalue = is_felt ? 200 : 300;
    settings.look(served, 2'000'000'000, is_felt);
  }
  EXPECT_EQ(isKept(), 200);
}

// A file's name need not be UTF-8.
TEST_F(Kept, AVolumeMayHaveAnyName) {
  Scene scene;
  scene.volume =
      "sch\xe4"
      "del.nii";
  runs(scene, [](Scene& served) { served.force_limit_N = 1; });
  EXPECT_THAT(said_, IsEmpty());
  EXPECT_EQ(next(scene).force_limit_N, 1);
  Scene other = scene;
  other.volume = "schadel.nii";
  EXPECT_EQ(next(other).force_limit_N, Scene{}.force_limit_N);
}

// An overtaken value does not come back with the scene's first one.
TEST_F(Kept, AnOvertakenValueIsForgotten) {
  Scene scene;
  scene.force_limit_N = 2;
  runs(scene, [](Scene& served) { served.force_limit_N = 1; });
  Scene changed = scene;
  changed.force_limit_N = 2.5;
  runs(changed, [](Scene&) {});
  EXPECT_EQ(next(scene).force_limit_N, 2);
}

// What is set after the scene was read again is the later word, also if it is the value of the start.
TEST_F(Kept, ASceneThatIsReadAgainIsHeldAgainst) {
  for (const double set : {600., 800.}) {
    Scene scene, wanted;
    scene.stiffness_N_per_m = 600;
    wanted.stiffness_N_per_m = 700;
    std::filesystem::remove(file());
    {
      KeptSettings settings(file(), scene, [](const std::string&) {});
      Scene served = scene;
      settings.begin(served);
      settings.reread(wanted);
      served.stiffness_N_per_m = 700;
      settings.look(served, 1'000'000'000);
      EXPECT_FALSE(std::filesystem::exists(file())) << "as the scene has it";
      served.stiffness_N_per_m = set;
      settings.look(served, 2'000'000'000);
    }
    EXPECT_EQ(next(wanted).stiffness_N_per_m, set);
  }
}

TEST_F(Kept, IsDueNowAndThen) {
  KeptSettings settings({}, Scene{}, [](const std::string&) {});
  settings.begin(Scene{});
  EXPECT_TRUE(settings.isDue(KeptSettings::kEvery_ns));
  settings.look(Scene{}, KeptSettings::kEvery_ns);
  EXPECT_FALSE(settings.isDue(2 * KeptSettings::kEvery_ns - 1));
  EXPECT_TRUE(settings.isDue(2 * KeptSettings::kEvery_ns));
}

// It is tried again, and told once.
TEST_F(Kept, AFolderThatIsNotThereIsToldOnce) {
  std::atomic<int> told = 0;
  KeptSettings settings(folder_.path() / "none" / "settings.json", Scene{}, [&](const std::string& words) {
    said_.push_back(words);
    ++told;
  });
  Scene served;
  settings.begin(served);
  for (int i = 1; i < 4; ++i) {
    served.force_limit_N = 0.1 * i;
    settings.look(served, i * 1'000'000'000LL);
    for (int waits = 0; waits < 6000 && told == 0; ++waits) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the later ones tell nothing
  }
  std::filesystem::create_directory(folder_.path() / "none");
  // Nothing has changed. A look while it still writes does nothing.
  for (int i = 0; i < 6000 && !std::filesystem::exists(folder_.path() / "none" / "settings.json"); ++i) {
    settings.look(served, (9 + i) * 1'000'000'000LL);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "none" / "settings.json"));
  settings.forget();
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "none" / "settings.json"));
  EXPECT_THAT(said_, ElementsAre(HasSubstr("would not outlive a crash")));
}

TEST_F(Kept, WithoutAFileNothingIsKept) {
  KeptSettings settings({}, Scene{}, [](const std::string& words) { ADD_FAILURE() << words; });
  Scene served;
  settings.begin(served);
  served.force_limit_N = 1;
  settings.look(served, 1'000'000'000);
  settings.forget();
}

}  // namespace kept_settings_test
}  // namespace palpate
