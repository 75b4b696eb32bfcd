#include "tests/unit/canopen/scale_bench.h"

#include <algorithm>
#include <utility>

#include "canopen/bus_load.h"
#include "tests/support/spawn.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr Duration kAnswerTime = 2ms;
// Timers of the master are met no later than that.
constexpr Duration kLongestStep = 500us;
constexpr std::uint8_t kOtherType = 254;
constexpr std::uint32_t kNoObject = 0x06020000;
constexpr ObjectAddress kHeartbeatObject{0x1017, 0};

BusSettings bus_settings(std::optional<std::uint32_t> bitrate) {
  BusSettings settings;
  settings.bitrate = bitrate;
  settings.node_id = ScaleBench::kOwnNode;
  settings.heartbeat = 500ms;
  return settings;
}

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
  entry.value = 0;
  for (unsigned i = 0; i < entry.size; ++i) {
    entry.value |= std::uint32_t{frame.data[4 + i]} << (8 * i);
  }
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

void TroubleCount::on_status(const NodeStatus& status) {
  const bool letter = status.boot_result != kBootOk && status.boot_result != kNotBooted;
  if (letter && status.boot_result != letter_) {
    ++letters;
    text = static_cast<char>(status.boot_result) + (" " + status.boot_text);
  }
  letter_ = status.boot_result;
  if (status.lost && !lost_) {
    ++losses;
  }
  lost_ = status.lost;
}

void HeartbeatEar::on_frames(std::span<const Received> frames) {
  for (const Received& received : frames) {
    ++frames_;
    bits_ += bits_on_wire(received.frame);
    if (received.frame.id <= 0x700 || received.frame.data[0] == 0) {
      continue;
    }
    Gap& gap = gaps_.at(received.frame.id - 0x700U);
    if (gap.last) {
      gap.longest = std::max(gap.longest, received.at - *gap.last);
    }
    gap.last = received.at;
  }
}

ScaleBench::ScaleBench(std::uint32_t bitrate, std::uint16_t tpdo_event_timer, bool bitrate_known)
    : wire_(loop_.executor(), bitrate),
      bus_(loop_.executor(), wire_.connect(), bus_settings(bitrate_known ? std::optional(bitrate) : std::nullopt)),
      ear_(wire_),
      tpdo_event_timer_(tpdo_event_timer) {
  bus_.start();
  loop_.settle();
}

ScaleBench::~ScaleBench() {
  for (const std::unique_ptr<Member>& member : members_) {
    support::spawn(loop_.executor(), member->node->stop());
    loop_.settle();
    member->node.reset();
  }
  support::spawn(loop_.executor(), bus_.stop());
  loop_.settle();
}

ScaleBench::Member& ScaleBench::add(std::uint8_t node) {
  Member& member = *members_.emplace_back(std::make_unique<Member>());
  const NodeSettings settings = settings_of(node);
  member.drive = std::make_unique<ScaleDrive>(wire_, settings);
  member.node = std::make_unique<RemoteNode>(loop_.executor(), bus_, settings, member.troubles);
  member.node->start();
  return member;
}

void ScaleBench::step(TimePoint end) {
  const TimePoint now = Clock::now();
  TimePoint next = std::min(end, now + kLongestStep);
  bool acted = false;
  for (const std::unique_ptr<Member>& member : members_) {
    if (member->drive->next_action() <= now) {
      member->drive->act();
      acted = true;
    }
    next = std::min(next, member->drive->next_action());
  }
  if (acted) {
    loop_.settle();  // A frame may have begun.
  }
  next = std::min(next, wire_.next_departure().value_or(kNever));
  loop_.advance(next - now, next - now);
}

bool ScaleBench::all_online() const {
  return std::all_of(members_.begin(), members_.end(), [](const auto& member) { return member->online(); });
}

std::size_t ScaleBench::letters() const {
  std::size_t count = 0;
  for (const std::unique_ptr<Member>& member : members_) {
    count += member->troubles.letters;
  }
  return count;
}

std::size_t ScaleBench::losses() const {
  std::size_t count = 0;
  for (const std::unique_ptr<Member>& member : members_) {
    count += member->troubles.losses;
  }
  return count;
}

std::string ScaleBench::a_letter() const {
  const auto found =
      std::find_if(members_.begin(), members_.end(), [](const auto& member) { return member->troubles.letters > 0; });
  return found == members_.end()
             ? ""
             : "node " + std::to_string((*found)->node->settings().node) + ": " + (*found)->troubles.text;
}

NodeSettings ScaleBench::settings_of(std::uint8_t node) const {
  NodeSettings settings;
  settings.node = node;
  settings.gateway_node = kOwnNode;
  for (std::uint16_t number = 1; number <= 3; ++number) {
    PdoSettings tpdo;
    tpdo.number = number;
    tpdo.cob_id = 0x080U + 0x100U * number + node;
    tpdo.transmission_type = std::uint8_t{255};
    tpdo.event_timer = tpdo_event_timer_;
    tpdo.period = std::chrono::milliseconds(tpdo_event_timer_);
    for (unsigned field = 0; field < 4; ++field) {
      const auto sub = static_cast<std::uint8_t>(number * 4U + field);
      tpdo.mapping.push_back({{0x2021, sub}, DataType::u16, 16, FieldUse::commanded});
    }
    settings.tpdos.push_back(std::move(tpdo));
  }
  PdoSettings rpdo;
  rpdo.cob_id = 0x200U + node;
  rpdo.transmission_type = std::uint8_t{255};
  for (std::uint8_t sub = 1; sub <= 3; ++sub) {
    rpdo.mapping.push_back({{0x2030, sub}, DataType::u16, 16, FieldUse::commanded});
  }
  settings.rpdos.push_back(std::move(rpdo));
  return settings;
}

}  // namespace canopen
