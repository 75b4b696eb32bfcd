#include "tests/unit/canopen/scale_bench.h"

#include <algorithm>
#include <utility>

#include "canopen/bus/bus_load.h"
#include "tests/support/spawn.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

// Timers of the master are met no later than that.
constexpr Duration kLongestStep = 500us;

BusSettings bus_settings(std::optional<std::uint32_t> bitrate) {
  BusSettings settings;
  settings.bitrate = bitrate;
  settings.node_id = ScaleBench::kOwnNode;
  settings.heartbeat = 500ms;
  return settings;
}

}  // namespace

void TroubleCount::on_status(const NodeStatus& status) {
  const bool letter = is_letter(status.boot_result);
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
    : ScaleBench(nullptr, bitrate, tpdo_event_timer, bitrate_known) {}

ScaleBench::ScaleBench(support::HandDrivenLoop& loop, std::uint32_t bitrate) : ScaleBench(&loop, bitrate, 0, true) {}

ScaleBench::ScaleBench(support::HandDrivenLoop* loop, std::uint32_t bitrate, std::uint16_t tpdo_event_timer,
                       bool bitrate_known)
    : own_loop_(loop == nullptr ? std::make_unique<support::HandDrivenLoop>() : nullptr),
      loop_(loop == nullptr ? *own_loop_ : *loop),
      wire_(loop_.executor(), bitrate),
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
  const Duration time = act(end) - Clock::now();
  loop_.advance(time, time);
}

TimePoint ScaleBench::act(TimePoint end) {
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
  return std::min(next, wire_.next_departure().value_or(kNever));
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
  settings.sdo.patience = patience_;
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
