#include "tests/unit/canopen/scale_drive.h"

#include <algorithm>
#include <array>
#include <utility>

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr Duration kAnswerTime = 2ms;
constexpr std::uint8_t kOtherType = 254;
constexpr std::uint32_t kNoObject = 0x06020000;
constexpr ObjectAddress kHeartbeatObject{0x1017, 0};

Frame answer_frame(std::uint8_t node, std::uint8_t command, const Frame& request, std::uint32_t value) {
  const std::array bytes{command,
                         request.data[1],
                         request.data[2],
                         request.data[3],
                         static_cast<std::uint8_t>(value & 0xFFU),
                         static_cast<std::uint8_t>(value >> 8U & 0xFFU),
                         static_cast<std::uint8_t>(value >> 16U & 0xFFU),
                         static_cast<std::uint8_t>(value >> 24U)};
  return make_frame(0x580U + node, bytes);
}

}  // namespace

ScaleDrive::ScaleDrive(VirtualBus& bus, NodeSettings settings) : settings_(std::move(settings)), link_(bus.connect()) {
  link_->open(*this);
}

void ScaleDrive::switch_on() {
  on_ = true;
  install(false);
  state_ = NmtState::pre_operational;
  send(0x700U + settings_.node, std::array<std::uint8_t, 1>{0});
}

void ScaleDrive::run() {
  on_ = true;
  install(true);
  state_ = NmtState::operational;
  // Drives that run for long are not in step.
  next_heartbeat_ = Clock::now() + settings_.node * 1ms;
}

void ScaleDrive::install(const PdoSettings& pdo, std::uint16_t base, bool as_wanted) {
  const auto communication = static_cast<std::uint16_t>(base + pdo.number - 1);
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  dictionary_[{communication, 1}] = {pdo.cob_id, 4};
  dictionary_[{communication, 2}] = {as_wanted ? pdo.transmission_type.value_or(0) : kOtherType, 1};
  dictionary_[{communication, 3}] = {0, 2};
  dictionary_[{communication, 5}] = {pdo.event_timer.value_or(0), 2};
  dictionary_[{mapping, 0}] = {static_cast<std::uint32_t>(pdo.mapping.size()), 1};
  std::uint8_t sub = 0;
  for (const MappedObject& mapped : pdo.mapping) {
    dictionary_[{mapping, ++sub}] = {
        std::uint32_t{mapped.object.index} << 16U | std::uint32_t{mapped.object.sub} << 8U | mapped.bits, 4};
    dictionary_[mapped.object] = {0, 2};
  }
}

void ScaleDrive::install(bool as_wanted) {
  dictionary_[kHeartbeatObject] = {as_wanted ? 500U : 0U, 2};
  dictionary_[{0x1000, 0}] = {0x192, 4};
  for (const PdoSettings& tpdo : settings_.tpdos) {
    install(tpdo, 0x1800, as_wanted);
  }
  for (const PdoSettings& rpdo : settings_.rpdos) {
    install(rpdo, 0x1400, as_wanted);
  }
}

TimePoint ScaleDrive::next_action() const noexcept {
  const TimePoint others = std::min(next_heartbeat_, next_tpdos_);
  return answers_.empty() ? others : std::min(others, answers_.front().at);
}

void ScaleDrive::act() {
  const TimePoint now = Clock::now();
  while (!answers_.empty() && answers_.front().at <= now) {
    static_cast<void>(link_->send(answers_.front().frame));
    answers_.pop_front();
  }
  if (next_heartbeat_ <= now) {
    heartbeat();
    next_heartbeat_ += heartbeat_period();
  }
  if (next_tpdos_ <= now) {
    for (const PdoSettings& tpdo : settings_.tpdos) {
      send(tpdo.cob_id, std::array<std::uint8_t, 8>{});
    }
    next_tpdos_ += tpdo_period();
  }
}

void ScaleDrive::on_frames(std::span<const Received> frames) {
  for (const Received& received : frames) {
    const Frame& frame = received.frame;
    if (!on_) {
      continue;
    }
    if (frame.id == 0x600U + settings_.node) {
      on_request(frame);
    } else if (frame.id == 0x200U + settings_.node) {
      ++rpdos_;
    } else if (frame.id == 0 && frame.data[1] == settings_.node) {
      on_nmt(NmtCommand{frame.data[0]});
    }
  }
}

void ScaleDrive::on_request(const Frame& frame) {
  ++requests_;
  if (Clock::now() < awake_at_) {
    return;
  }
  const ObjectAddress object{static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8U), frame.data[3]};
  const auto found = dictionary_.find(object);
  const TimePoint at = Clock::now() + kAnswerTime;
  if (found == dictionary_.end()) {
    answers_.push_back({at, answer_frame(settings_.node, 0x80, frame, kNoObject)});
    return;
  }
  Entry& entry = found->second;
  if (frame.data[0] >> 5U == 2) {
    const auto command = static_cast<std::uint8_t>(0x43U | ((4U - entry.size) << 2U));
    answers_.push_back({at, answer_frame(settings_.node, command, frame, entry.value)});
    return;
  }
  std::uint32_t value = 0;
  for (unsigned i = 0; i < entry.size; ++i) {
    value |= std::uint32_t{frame.data[4 + i]} << (8 * i);
  }
  entry.value = object == kept_ ? entry.value : value;
  if (object == kHeartbeatObject) {
    next_heartbeat_ = entry.value == 0 ? kNever : Clock::now() + heartbeat_period();
  }
  answers_.push_back({at, answer_frame(settings_.node, 0x60, frame, 0)});
}

void ScaleDrive::on_nmt(NmtCommand command) {
  if (command != NmtCommand::start) {
    return;
  }
  state_ = NmtState::operational;
  heartbeat();
  if (tpdo_period() > Duration::zero()) {
    next_tpdos_ = Clock::now() + tpdo_period();
  }
}

void ScaleDrive::heartbeat() {
  send(0x700U + settings_.node, std::array<std::uint8_t, 1>{static_cast<std::uint8_t>(state_)});
}

void ScaleDrive::send(std::uint32_t cob_id, std::span<const std::uint8_t> bytes) {
  static_cast<void>(link_->send(make_frame(cob_id, bytes)));
}

Duration ScaleDrive::heartbeat_period() const {
  return std::chrono::milliseconds(value(kHeartbeatObject));
}

Duration ScaleDrive::tpdo_period() const {
  return std::chrono::milliseconds(settings_.tpdos.front().event_timer.value_or(0));
}

}  // namespace canopen
