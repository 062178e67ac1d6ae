// SPDX-License-Identifier: Apache-2.0
// Ticks among objects take nothing from the heap and make no system call, Embree's queries included.
//
// A child process presses and slides over a mesh, a box, a ball and a plane under a seccomp filter that allows the exit
// alone; any other call kills it.
#include <cstddef>

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "servo/algorithms/registry.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/objects/shapes.hpp"
#include "support/test_meshes.hpp"
#include "support/tick_watch.hpp"

namespace palpate {
namespace object_guard_test {

constexpr int kNoSeccomp = 77;

class Among {
 public:
  explicit Among(std::string_view algorithm) {
    AlgorithmSetup setup;
    setup.isosurface = std::make_shared<const MeshObject>(sphereMesh(Vec3::Zero(), 20e-3, 4));
    mesh_ = std::make_shared<const MeshObject>(boxMesh({0, 0, 20e-3}, {30e-3, 10e-3, 5e-3}));
    setup.objects = {mesh_, std::make_shared<const BoxObject>(Vec3(15e-3, 0, 15e-3), Vec3::Constant(8e-3)),
                     std::make_shared<const SphereObject>(Vec3(-12e-3, 0, 20e-3), 5e-3),
                     std::make_shared<const PlaneObject>(Vec3(0, 8e-3, 0), -Vec3::UnitY())};
    algorithm_ = makeAlgorithm(algorithm, std::move(setup));
    algorithm_->reset({0, 0, 40e-3});
  }

  // Ticks in contact.
  int ticks() {
    int touching = 0;
    TickOutput out;
    for (int i = 0; i < 2000; ++i) {
      const double angle = 3e-3 * i;
      in_.hip_W = Vec3(18e-3 * std::sin(angle), 9e-3 * std::sin(3.1 * angle), 18e-3 * std::cos(angle));
      algorithm_->tick(in_, out);
      touching += out.in_contact ? 1 : 0;
      touching += mesh_->nearest(in_.hip_W).normal_W.norm() < 0.5 ? 1 : 0;  // never; asks Embree the other question
    }
    return touching;
  }

 private:
  SampleWindow window_;
  TickInput in_{Vec3::Zero(), Vec3::Zero(), &window_};
  std::shared_ptr<const MeshObject> mesh_;
  std::unique_ptr<Algorithm> algorithm_;
};

TEST(ObjectGuard, TicksTakeNothingFromTheHeap) {
  for (const char* algorithm : {"hri", "god-object"}) {
    Among among(algorithm);
    TickWatch::begin();
    const int touching = among.ticks();
    TickWatch::end();
    EXPECT_EQ(TickWatch::seen().all(), 0) << algorithm;
    EXPECT_GT(touching, 300) << algorithm;
  }
}

TEST(ObjectGuard, ADeliberateAllocationIsSeen) {
  TickWatch::begin();
  const auto taken = std::make_unique<double>(1);
  TickWatch::end();
  EXPECT_EQ(TickWatch::seen().allocations, 1);
}

bool allowOnlyExit() {
  constexpr auto kNumber = static_cast<unsigned>(offsetof(seccomp_data, nr));
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kNumber),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  sock_fprog filter{static_cast<unsigned short>(std::size(program)), program};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

int runChild(std::string_view algorithm, bool calls) {
  const pid_t child = fork();
  if (child == 0) {
    Among among(algorithm);
    if (!allowOnlyExit()) _exit(kNoSeccomp);
    const int touching = among.ticks();
    if (calls) static_cast<void>(syscall(SYS_getpid));
    _exit(touching > 300 ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(ObjectGuard, TicksMakeNoSystemCall) {
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "a sanitizer makes system calls of its own";
#endif
  for (const char* algorithm : {"hri", "god-object"}) {
    const int status = runChild(algorithm, false);
    ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
    if (WEXITSTATUS(status) == kNoSeccomp) GTEST_SKIP() << "no seccomp filters on this system";
    EXPECT_EQ(WEXITSTATUS(status), 0);
  }
  const int caught = runChild("hri", true);
  ASSERT_TRUE(WIFSIGNALED(caught)) << "a deliberate call is not caught";
  EXPECT_EQ(WTERMSIG(caught), SIGSYS);
}

}  // namespace object_guard_test
}  // namespace palpate
