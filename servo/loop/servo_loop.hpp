// SPDX-License-Identifier: Apache-2.0
// servo/loop/servo_loop.hpp: the haptic loop: device -> velocity -> algorithm -> safety gate -> device, every tick.
//
// One object is one run. Time is a grid: tick k is due k / rate after the start.
// Real clock: a thread of its own sleeps until each grid point. A tick that is not done when the next is due is flagged
// kOverrun. Grid points that have passed by then are left out, not made up for. Tick numbers keep to the grid: they
// have a gap there, and time_s stays tick / rate. A position that the device has reported before (device.hpp) is used
// again, but does not update the velocity. One that no motion of the device explains (hand_motion.hpp) counts as no
// answer, unless the next one lies near it; then the tool begins anew there, as at the start of a run. Simulated clock:
// the caller's thread runs every grid point, as fast as it can. Cost and lateness are 0. The same inputs give the same
// records, bit for bit. Real-time rule: between its first and last tick the servo thread allocates nothing, takes no
// lock, throws and prints nothing. It makes no system call but its sleep and the device's I/O (tests/servo/loop proves
// it). Frame W: world. Times: nanoseconds of CLOCK_MONOTONIC, or since the start with the simulated clock.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "servo/algorithms/algorithm.hpp"
#include "servo/contact/edit_ease.hpp"
#include "servo/devices/device.hpp"
#include "servo/loop/instability_guard.hpp"
#include "servo/loop/live_ticks.hpp"
#include "servo/loop/real_time.hpp"
#include "servo/loop/servo_changes.hpp"
#include "servo/loop/servo_links.hpp"
#include "servo/loop/tick_recorder.hpp"
#include "servo/loop/velocity.hpp"
#include "servo/safety/passivity.hpp"
#include "servo/safety/safety_gate.hpp"
#include "servo/safety/window_clock.hpp"
#include "servo/window/tool_pose.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {

struct LoopParameters {
  double rate_hz = 1000;           // 1 to 20000 [Hz]
  std::int64_t ticks = 5000;       // grid points of the run; 0: until requestStop() [tick]
  std::int64_t record_ticks = -1;  // newest ticks to keep; -1: all, then `ticks` may not be 0 [tick]
  bool real_time = true;           // ask for priority and locked memory (real clock)
  bool require_real_time = false;  // refuse to run unless both are granted
  int priority = 80;               // of SCHED_FIFO
  VelocityParameters velocity;
  SafetyParameters safety;
  PassivityParameters passivity;
  InstabilityParameters instability;
};

// A clock for runOn(). The loop's own thread calls it.
class ServoClock {
 public:
  virtual ~ServoClock() = default;
  [[nodiscard]] virtual std::int64_t now_ns() noexcept = 0;
  virtual void sleepUntil(std::int64_t due_ns) noexcept = 0;
};

struct LoopResult {
  std::vector<TickRecord> records;
  std::int64_t ticks_run = 0;      // ticks that were run [tick]
  std::int64_t ticks_skipped = 0;  // grid points left out after missed deadlines [tick]
  bool released = false;           // the device took a zero force at the end; false: it may still hold a force
  RealTimeStatus real_time;
  DeviceLimits device;            // of the device that was used
  std::int64_t first_due_ns = 0;  // when the first tick was due, on the run's clock [ns]
};

class ServoLoop {
 public:
  // All references must outlive the loop. The loop is the reader of `windows` and the writer of `tool`. The constructor
  // reads the device once, resets the algorithm to that position and publishes the first ToolPose (tick -1, time 0), so
  // that the engine can place the first window. Throws Error(kBadInput) on parameters out of range, Error(kDevice) if
  // the device cannot be read.
  ServoLoop(const LoopParameters& parameters, Algorithm& algorithm, Device& device, WindowExchange& windows,
            ToolPoseMailbox& tool);
  ~ServoLoop();  // stops and joins a running thread

  // Set before a run: where changes come from, and who else sees each tick. Both must outlive the loop. A change is
  // made between two ticks. A new algorithm takes over a contact where it is (Algorithm::resume()). For a while both
  // algorithms run, and the force goes over from the old one's to the new one's. A tick in which the new force is the
  // old one or less of it, along the same line within 14 degrees, counts as one of kChangeOver_s. Every other tick
  // counts as one of EditEase::kTime_s, as an edit comes in: so does each after an unstable contact, whose old
  // algorithm keeps the share that was left of its force, and each in which the new one sees no surface yet. A new
  // force limit is reached in the same times; it stays within the device's own. While a contact is only remembered
  // (TickOutput::at_surface without contact), changes wait.
  static constexpr double kChangeOver_s = 0.1;  // [s]
  void takeChangesFrom(ServoChanges& changes) noexcept { changes_ = &changes; }
  void tellTicksTo(LiveTicks& live) noexcept { live_ = &live; }
  // Set before a run: where another engine's windows come from. A change that is under way is completed first. What the
  // new engine's windows add to the force comes in as what an edit adds. If the force had faded, it begins at zero,
  // once the gate lets the whole through.
  void takeLinksFrom(ServoLinks& links) noexcept { links_ = &links; }

  // Simulated clock: the whole run, in the caller's thread. `before_tick` is called before each tick with its number
  // and time [ns], for an engine that publishes in step. It may allocate, lock and throw, and may be empty.
  using Hook = std::function<void(std::int64_t tick, std::int64_t time_ns)>;
  [[nodiscard]] LoopResult runSimulated(const Hook& before_tick = {});

  // The loop of the real clock, but in the caller's thread and on the given clock. That clock can play stalls, missed
  // deadlines and clock steps.
  [[nodiscard]] LoopResult runOn(ServoClock& clock);

  // Real clock: start() starts the thread, wait() joins it and gives the result. Throws std::system_error if no thread
  // can be made, and Error(kDevice) if priority or locked memory are required and the system refuses one; then no tick
  // has begun.
  void start();
  [[nodiscard]] LoopResult wait();
  // What the system gave when start() returned; of the thread that called it.
  [[nodiscard]] const RealTimeStatus& realTime() const noexcept { return real_time_; }
  [[nodiscard]] bool running() const noexcept { return running_.load(std::memory_order_acquire); }
  // Of the newest tick, but for its overrun, which is not known before its end (faults.hpp). Any thread, any time.
  [[nodiscard]] std::uint32_t newestFaults() const noexcept { return newest_faults_.load(std::memory_order_relaxed); }

  // Any thread, any time. No tick begins after the servo has seen the request. At the end of every run the force fades
  // to zero as in a fault, within fade_s or as long as the slew limit asks for. Without a force that takes one write.
  // After a second of refusals the loop gives up (LoopResult::released).
  void requestStop() noexcept { stop_.store(true, std::memory_order_relaxed); }

 private:
  struct Due {
    std::int64_t tick = 0;
    std::int64_t lateness_ns = 0;
    int elapsed_ticks = 0;  // since the last tick that ran; 0 before the first
  };
  // What the force of a tick grew by when the servo went over to another engine: taken in as an edit is.
  class NextEngine {
   public:
    explicit NextEngine(double rate_hz) noexcept : ease_(rate_hz) {}
    // `shown_N`: the force until now; `wait_ticks`: of contact, until the easing begins.
    void begin(double shown_N, std::int64_t wait_ticks) noexcept;
    void ease(TickOutput& out) noexcept;

   private:
    EditEase ease_;        // of the force's size [N]
    double shown_N_ = -1;  // before the first tick after begin(); else below 0
    std::int64_t wait_ticks_ = 0;
  };
  [[nodiscard]] std::int64_t offset_ns(std::int64_t tick) const noexcept;  // of a tick, from the start [ns]
  [[nodiscard]] std::int64_t firstTickFrom(std::int64_t tick, std::int64_t time_ns) const noexcept;
  [[nodiscard]] bool wanted(std::int64_t tick) const noexcept;
  template <typename Clock>
  void runOnGrid(Clock& clock);
  void beginChange(const SampleWindow& window) noexcept;
  [[nodiscard]] ServoLink* lookForLink() noexcept;
  void goOver(ServoLink& link) noexcept;
  void remember(const TickOutput& out) noexcept;
  [[nodiscard]] std::uint32_t askDevice(std::int64_t gap_ns) noexcept;
  void takeOver(Algorithm& next, const SampleWindow& window) const noexcept;
  void tickAlgorithm(const TickInput& in, TickOutput& out) noexcept;
  void goOn(const TickInput& in, TickOutput& out) noexcept;
  [[nodiscard]] bool onlyShrinks(const TickOutput& left, const TickOutput& out) const noexcept;
  void endChange() noexcept;
  const SampleWindow& runTick(const Due& due, std::int64_t now_ns, TickRecord& record) noexcept;
  [[nodiscard]] bool believes(const Vec3& read_W) noexcept;
  [[nodiscard]] double sinceReport_s() const noexcept;
  void beginAt(const Vec3& read_W) noexcept;
  [[nodiscard]] bool readDevice(int elapsed_ticks, std::int64_t gap_ns, std::int64_t& report_age_ns) noexcept;
  [[nodiscard]] bool offer(const Vec3& force_W) noexcept;
  template <typename Pause>
  void endForce(Pause pause) noexcept;
  [[nodiscard]] LoopResult result();

  LoopParameters parameters_;
  Algorithm* algorithm_;
  Device& device_;
  WindowExchange* windows_;
  ToolPoseMailbox* tool_;
  SafetyGate gate_;
  WindowClock window_clock_;
  Passivity passivity_;
  InstabilityGuard guard_;
  VelocityEstimate velocity_;
  TickRecorder recorder_;
  Vec3 hip_W_ = Vec3::Zero();   // last position that could be read [m]
  Vec3 leap_W_ = Vec3::Zero();  // the last reading, if no motion explains it
  bool leapt_ = false;
  MotionLaw motion_;
  double position_waits_s_;  // how much older than its tick a position may be [s]
  bool begins_;  // the first position of a run is still to come, and may be anywhere: a person holds the device
  std::uint32_t leaps_ = 0;  // that were believed
  int ticks_since_report_ = 0;
  std::int64_t last_now_ns_ = 0;      // when the last tick began
  std::uint32_t carried_faults_ = 0;  // of the last tick, after its gate
  std::uint32_t overrun_ = 0;         // of the last tick: its bit
  TickOutput last_;                   // the algorithm's last output
  bool way_known_ = false;            // the tool has been seen outside or in contact since its way was last unknown
  ServoChanges* changes_ = nullptr;
  LiveTicks* live_ = nullptr;
  ServoLinks* links_ = nullptr;
  ServoChange* change_ = nullptr;               // the change under way; null: none
  Algorithm* leaving_ = nullptr;                // the algorithm that it replaces; null: it replaces none
  std::unique_ptr<Algorithm> given_algorithm_;  // owns algorithm_, if that came with a change
  double most_force_N_;                         // the device's own limit [N]
  double limit_from_N_ = 0;
  double leaving_share_ = 1;      // of its force, as the guard left it
  std::int64_t change_tick_ = 0;  // ticks of the change that have run
  // How far the force has gone over, of ticks_to_grow_ * ticks_to_fall_. A tick adds one share of 1 / ticks_to_grow_,
  // or where the force only shrinks of 1 / ticks_to_fall_.
  std::int64_t gone_over_ = 0;
  const std::int64_t ticks_to_grow_;  // EditEase::kTime_s in ticks
  const std::int64_t ticks_to_fall_;  // kChangeOver_s in ticks
  NextEngine next_engine_;
  std::int64_t ticks_run_ = 0;
  std::int64_t ticks_skipped_ = 0;
  std::int64_t first_due_ns_ = 0;
  bool released_ = false;
  RealTimeStatus real_time_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> running_{false};
  std::atomic<std::uint32_t> newest_faults_{0};
  std::jthread thread_;  // last member: it uses the others
};

}  // namespace palpate
