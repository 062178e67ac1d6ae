// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/recording.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little, "recordings hold the low byte first");

constexpr std::string_view kMagic = "PALPREC2";
constexpr std::size_t kBlockTicks = 256;  // what a cut file loses at most
constexpr std::uint8_t kAnswered = 1, kMoved = 2, kAged = 4, kTaken = 8, kHeld = 16, kEdge = 32, kSwitchOn = 64,
                       kElapsed = 128;
constexpr std::int32_t kUsualElapsed = 1;
// An unusual tick has a word of 32 bits, from the lowest bit on: 23 bits for the periods since the tick before, one bit
// that says whether the tool leapt, four for why there is no force, four for why a calibration was refused.
constexpr std::int32_t kMostElapsed = 0x7fffff;
constexpr std::uint32_t kLeapt = 0x800000;
constexpr unsigned kOffShift = 24;
constexpr std::uint32_t kMostOff = 0xf;
constexpr unsigned kRefusedShift = 28;
constexpr std::uint8_t kFollows = 1, kIsHeld = 2, kSetsPace = 4, kMoves = 8;  // what is true of the device
constexpr double kMostRate_hz = 20000;                                        // ServoLoop's
constexpr int kMostDelay_ticks = 10000;                                       // SimulatedDevice's

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}
void put(std::string& bytes, const Vec3& v) {
  for (const double x : v) put(bytes, x);
}

// Takes values from the front of bytes; after a take that found too few, all are none.
class Taker {
 public:
  explicit Taker(std::string_view bytes) : left_(bytes) {}
  template <class T>
  T take() {
    T value{};
    const std::string_view bytes = takeBytes(sizeof value);
    if (bytes.size() == sizeof value) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  Vec3 takeVector() {
    const double x = take<double>(), y = take<double>(), z = take<double>();
    return {x, y, z};
  }
  std::string_view takeBytes(std::size_t count) {
    failed_ = failed_ || count > left_.size();
    if (failed_) return {};
    const std::string_view taken = left_.substr(0, count);
    left_.remove_prefix(count);
    return taken;
  }
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] std::string_view left() const { return left_; }

 private:
  std::string_view left_;
  bool failed_ = false;
};

std::string headerBytes(const Recording& r) {
  std::string bytes;
  put(bytes, r.rate_hz);
  put(bytes, r.contact.stiffness_N_per_m);
  put(bytes, r.contact.damping_Ns_per_m);
  for (const double limit : {r.limits.force_limit_N, r.limits.position_resolution_m, r.limits.slew_limit_N_per_s,
                             r.limits.stiffness_limit_N_per_m, r.limits.workspace_radius_m})
    put(bytes, limit);
  put(bytes, static_cast<std::int32_t>(r.limits.force_delay_ticks));
  const DeviceLimits& l = r.limits;
  put(bytes, static_cast<std::uint8_t>((l.follows_force ? kFollows : 0) | (l.is_held ? kIsHeld : 0) |
                                       (l.sets_pace ? kSetsPace : 0) | kMoves));
  put(bytes, l.motion.speed_m_per_s);
  put(bytes, l.motion.acceleration_m_per_s2);
  put(bytes, static_cast<std::uint8_t>(r.hands.size()));
  for (const HandParameters& h : r.hands) {
    for (const double value : {h.hand_mass_kg, h.hand_damping_Ns_per_m, h.hand_stiffness_N_per_m, h.device_mass_kg,
                               h.device_damping_Ns_per_m, h.device_friction_N})
      put(bytes, value);
  }
  put(bytes, static_cast<std::uint16_t>(r.device.size()));
  return bytes + r.device;
}

bool sameBits(const Vec3& a, const Vec3& b) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  return bits(a.x()) == bits(b.x()) && bits(a.y()) == bits(b.y()) && bits(a.z()) == bits(b.z());
}

void putTick(std::string& bytes, const RecordedTick& tick, const Vec3& before_W) {
  const bool moved = !sameBits(tick.position_W, before_W);
  const bool edge = tick.boundary.stored_J != 0 || !tick.boundary.force_W.isZero(0);
  const bool unusual = tick.elapsed_ticks != kUsualElapsed || tick.force_off != ForceOff::kNone || tick.leapt ||
                       tick.refused != CalibrationRefusal::kNone;
  const auto flag = [](bool on, std::uint8_t bit) { return on ? bit : std::uint8_t{0}; };
  put(bytes, static_cast<std::uint8_t>(flag(tick.answered, kAnswered) | flag(moved, kMoved) |
                                       flag(tick.report_age_ns != 0, kAged) | flag(tick.taken, kTaken) |
                                       flag(tick.held_differs, kHeld) | flag(edge, kEdge) |
                                       flag(tick.pressed, kSwitchOn) | flag(unusual, kElapsed)));
  if (unusual) {
    const auto periods = static_cast<std::uint32_t>(std::min(tick.elapsed_ticks, kMostElapsed));
    put(bytes, periods | (tick.leapt ? kLeapt : 0) | static_cast<std::uint32_t>(tick.force_off) << kOffShift |
                   static_cast<std::uint32_t>(tick.refused) << kRefusedShift);
  }
  if (moved) put(bytes, tick.position_W);
  if (tick.report_age_ns != 0) put(bytes, tick.report_age_ns);
  if (tick.held_differs) put(bytes, tick.held_W);
  if (edge) put(bytes, tick.boundary.force_W);
  if (edge) put(bytes, tick.boundary.stored_J);
}

RecordedTick takeTick(Taker& taker, Vec3& position_W) {
  RecordedTick tick;
  const auto flags = taker.take<std::uint8_t>();
  const auto has = [&](std::uint8_t bit) { return (flags & bit) != 0; };
  tick.answered = has(kAnswered);
  tick.taken = has(kTaken);
  tick.pressed = has(kSwitchOn);
  tick.held_differs = has(kHeld);
  const auto periods = has(kElapsed) ? taker.take<std::uint32_t>() : std::uint32_t{kUsualElapsed};
  tick.elapsed_ticks = static_cast<std::int32_t>(periods & std::uint32_t{kMostElapsed});
  tick.leapt = (periods & kLeapt) != 0;
  tick.force_off = static_cast<ForceOff>(periods >> kOffShift & kMostOff);
  tick.refused = static_cast<CalibrationRefusal>(periods >> kRefusedShift);
  if (has(kMoved)) position_W = taker.takeVector();
  tick.position_W = position_W;
  if (has(kAged)) tick.report_age_ns = taker.take<std::int64_t>();
  if (has(kHeld)) tick.held_W = taker.takeVector();
  if (has(kEdge)) {
    tick.boundary.force_W = taker.takeVector();
    tick.boundary.stored_J = taker.take<double>();
  }
  return tick;
}

bool canBe(const RecordedTick& tick) {
  return tick.force_off <= ForceOff::kClutched && tick.refused <= CalibrationRefusal::kAway &&
         tick.report_age_ns >= 0 && tick.held_W.allFinite() && tick.boundary.force_W.allFinite() &&
         std::isfinite(tick.boundary.stored_J);
}

// Empty: the block is damaged.
std::optional<std::vector<RecordedTick>> ticksOf(std::string_view block, std::uint32_t count, Vec3& position_W) {
  Taker taker(block);
  std::vector<RecordedTick> ticks;
  for (std::uint32_t i = 0; i < count && !taker.failed(); ++i) {
    ticks.push_back(takeTick(taker, position_W));
    if (!canBe(ticks.back())) return {};
  }
  if (taker.failed() || !taker.left().empty()) return {};
  return ticks;
}

bool canBe(const Recording& r) {
  const DeviceLimits& l = r.limits;
  bool can = r.rate_hz >= 1 && r.rate_hz <= kMostRate_hz && l.force_delay_ticks >= 0 &&
             l.force_delay_ticks <= kMostDelay_ticks && l.motion.speed_m_per_s > 0;
  for (const double limit : {l.force_limit_N, l.position_resolution_m, l.slew_limit_N_per_s, l.stiffness_limit_N_per_m,
                             l.workspace_radius_m, l.motion.speed_m_per_s, l.motion.acceleration_m_per_s2,
                             r.contact.stiffness_N_per_m, r.contact.damping_Ns_per_m})
    can = can && limit >= 0 && std::isfinite(limit);
  for (const HandParameters& h : r.hands) {
    for (const double value : {h.hand_mass_kg, h.hand_damping_Ns_per_m, h.hand_stiffness_N_per_m, h.device_mass_kg,
                               h.device_damping_Ns_per_m, h.device_friction_N})
      can = can && value >= 0 && std::isfinite(value);
    can = can && h.hand_mass_kg + h.device_mass_kg > 0;
  }
  return can;
}

Recording takeHeader(Taker& taker) {
  Recording r;
  r.rate_hz = taker.take<double>();
  r.contact.stiffness_N_per_m = taker.take<double>();
  r.contact.damping_Ns_per_m = taker.take<double>();
  for (double* limit : {&r.limits.force_limit_N, &r.limits.position_resolution_m, &r.limits.slew_limit_N_per_s,
                        &r.limits.stiffness_limit_N_per_m, &r.limits.workspace_radius_m})
    *limit = taker.take<double>();
  r.limits.force_delay_ticks = taker.take<std::int32_t>();
  const auto traits = taker.take<std::uint8_t>();
  r.limits.follows_force = (traits & kFollows) != 0;
  r.limits.is_held = (traits & kIsHeld) != 0;
  r.limits.sets_pace = (traits & kSetsPace) != 0;
  if ((traits & kMoves) != 0) {
    r.limits.motion.speed_m_per_s = taker.take<double>();
    r.limits.motion.acceleration_m_per_s2 = taker.take<double>();
  }
  r.hands.resize(taker.take<std::uint8_t>());
  for (HandParameters& h : r.hands) {
    for (double* value : {&h.hand_mass_kg, &h.hand_damping_Ns_per_m, &h.hand_stiffness_N_per_m, &h.device_mass_kg,
                          &h.device_damping_Ns_per_m, &h.device_friction_N})
      *value = taker.take<double>();
  }
  r.device = taker.takeBytes(taker.take<std::uint16_t>());
  return r;
}

}  // namespace

std::int64_t Recording::gridTicks() const noexcept {
  std::int64_t sum = 0;
  for (const RecordedTick& tick : ticks) sum += tick.elapsed_ticks;
  return sum + 1;
}

std::string recordingBytes(const Recording& recording) {
  const std::string header = headerBytes(recording);
  std::string bytes(kMagic);
  put(bytes, static_cast<std::uint32_t>(header.size()));
  bytes += header;
  put(bytes, crc32c(header));
  Vec3 before_W = Vec3::Zero();
  std::string block;
  std::uint32_t in_block = 0;
  const auto close = [&] {
    put(bytes, in_block);
    put(bytes, static_cast<std::uint32_t>(block.size()));
    bytes += block;
    put(bytes, crc32c(block));
    block.clear();
    in_block = 0;
  };
  for (const RecordedTick& tick : recording.ticks) {
    putTick(block, tick, before_W);
    before_W = tick.position_W;
    if (++in_block == kBlockTicks) close();
  }
  if (in_block > 0) close();
  close();  // an empty block: the end
  return bytes;
}

Recording readRecording(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with(kRecordingBegin))
    refuse(name, "it is no recording of a device", "record one with 'palpate touch ... --record FILE'");
  if (!bytes.starts_with(kMagic))
    refuse(name, formatted("it is a recording of another form than {}", kMagic),
           "play it with the Palpate that recorded it");
  Taker taker(bytes.substr(kMagic.size()));
  const std::string_view header = taker.takeBytes(taker.take<std::uint32_t>());
  const bool holds = taker.take<std::uint32_t>() == crc32c(header) && !taker.failed();
  Taker header_taker(header);
  Recording recording;
  if (holds) recording = takeHeader(header_taker);
  if (!holds || header_taker.failed() || !header_taker.left().empty() || !canBe(recording))
    refuse(name, "its header is damaged", "record it again");
  Vec3 position_W = Vec3::Zero();
  std::size_t number = 0;
  for (bool ended = false; !ended;) {
    ++number;
    const std::size_t begin = bytes.size() - taker.left().size();
    const auto count = taker.take<std::uint32_t>();
    const std::string_view block = taker.takeBytes(taker.take<std::uint32_t>());
    const bool whole = taker.take<std::uint32_t>() == crc32c(block) && !taker.failed();
    const auto ticks = whole ? ticksOf(block, count, position_W) : std::nullopt;
    if (!ticks) {
      recording.damage = formatted("block {} of {} ticks, at byte {}, {}", number, kBlockTicks, begin,
                                   taker.failed() ? "is cut short" : "is damaged");
      break;
    }
    ended = count == 0;
    recording.ticks.insert(recording.ticks.end(), ticks->begin(), ticks->end());
  }
  if (recording.damage.empty() && !taker.left().empty())
    recording.damage = formatted("{} bytes follow its end", taker.left().size());
  if (recording.ticks.empty()) refuse(name, "no tick of it can be read", "record it again");
  return recording;
}

}  // namespace palpate
