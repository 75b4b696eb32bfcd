#include "tests/support/scripted_slave.h"

#include <algorithm>
#include <array>

namespace support {
namespace {

using canopen::Duration;
using canopen::Frame;
using canopen::ObjectAddress;
using Bytes = ScriptedSlave::Bytes;

constexpr Duration kTick = std::chrono::milliseconds(1);
constexpr ObjectAddress kHeartbeatTime{0x1017, 0};

ObjectAddress address_of(const Bytes& request) {
  return {static_cast<std::uint16_t>(request[1] | (request[2] << 8U)), request[3]};
}

Bytes addressed(std::uint8_t command, ObjectAddress object) {
  return {command,
          static_cast<std::uint8_t>(object.index & 0xFFU),
          static_cast<std::uint8_t>(object.index >> 8U),
          object.sub,
          0,
          0,
          0,
          0};
}

}  // namespace

ScriptedSlave::ScriptedSlave(boost::asio::any_io_executor executor, canopen::VirtualBus& bus, std::uint8_t node)
    : bus_(bus), node_(node), timer_(executor), link_(bus_.connect()) {
  link_->open(*this);
  arm();
}

ScriptedSlave::~ScriptedSlave() {
  link_->close();
}

void ScriptedSlave::set(ObjectAddress object, canopen::DataType type, canopen::Raw raw) {
  std::array<std::uint8_t, 8> bytes{};
  const unsigned length = canopen::encode_raw(type, raw, bytes);
  objects_[object] = Bytes(bytes.begin(), bytes.begin() + length);
}

std::uint64_t ScriptedSlave::value(ObjectAddress object) const {
  const auto found = objects_.find(object);
  std::uint64_t value = 0;
  for (std::size_t i = 0; found != objects_.end() && i < found->second.size(); ++i) {
    value |= std::uint64_t{found->second[i]} << (8 * i);
  }
  return value;
}

void ScriptedSlave::boot_up() {
  state_ = 127;
  toggle_ = 0;
  send(0x700U + node_, {0});
  next_heartbeat_ = {};
}

void ScriptedSlave::send(std::uint32_t cob_id, Bytes bytes) {
  if (!unplugged_) {
    static_cast<void>(link_->send(canopen::make_frame(cob_id, bytes)));
  }
}

std::vector<Frame> ScriptedSlave::heard_on(std::uint32_t cob_id) const {
  std::vector<Frame> found;
  std::copy_if(heard_.begin(), heard_.end(), std::back_inserter(found),
               [&](const Frame& frame) { return frame.id == cob_id; });
  return found;
}

std::vector<ObjectAddress> ScriptedSlave::writes() const {
  std::vector<ObjectAddress> found;
  for (const Frame& frame : heard_on(0x600U + node_)) {
    if ((frame.data[0] & 0xE0U) == 0x20) {
      found.push_back(address_of(Bytes(frame.data.begin(), frame.data.end())));
    }
  }
  return found;
}

std::vector<ObjectAddress> ScriptedSlave::reads() const {
  std::vector<ObjectAddress> found;
  for (const Frame& frame : heard_on(0x600U + node_)) {
    if ((frame.data[0] & 0xE0U) == 0x40) {
      found.push_back(address_of(Bytes(frame.data.begin(), frame.data.end())));
    }
  }
  return found;
}

void ScriptedSlave::on_frames(std::span<const canopen::Received> frames) {
  for (const canopen::Received& received : frames) {
    const Frame& frame = received.frame;
    if (unplugged_) {
      continue;
    }
    heard_.push_back(frame);
    if (frame.remote && frame.id == 0x700U + node_ && guarding_) {
      send(frame.id, {static_cast<std::uint8_t>(state_ | toggle_)});
      toggle_ ^= toggles_ ? 0x80U : 0U;
    } else if (frame.id == 0x600U + node_ && !sdo_muted_) {
      on_sdo(Bytes(frame.data.begin(), frame.data.begin() + frame.size));
    } else if (frame.id == 0 && frame.size == 2 && (frame.data[1] == 0 || frame.data[1] == node_)) {
      on_nmt(frame);
    }
  }
}

void ScriptedSlave::on_nmt(const Frame& frame) {
  if (nmt_ignored_) {
    return;
  }
  switch (frame.data[0]) {
    case 1:
      state_ = 5;
      break;
    case 2:
      state_ = 4;
      break;
    case 128:
      state_ = 127;
      break;
    default:
      boot_up();
  }
}

void ScriptedSlave::on_sdo(const Bytes& request) {
  if (script_) {
    if (const auto answers = script_(request)) {
      for (const Bytes& bytes : *answers) {
        answer(bytes);
      }
      return;
    }
  }
  const unsigned command = request[0] >> 5U;
  const ObjectAddress object = address_of(request);
  if (command == 4) {
    segments_.clear();
    return;
  }
  if (command == 0 || command == 3) {
    on_segment(request);
    return;
  }
  if (muted_.contains(object)) {
    return;
  }
  if (command == 2) {
    read_object(object);
  } else if ((request[0] & 0x02U) != 0) {
    write_object(object, Bytes(request.begin() + 4, request.begin() + 8 - ((request[0] >> 2U) & 0x03U)));
  } else {
    segmented_ = object;
    segments_.clear();
    segmented_write_ = true;
    answer(addressed(0x60, object));
  }
}

void ScriptedSlave::read_object(ObjectAddress object) {
  const auto found = objects_.find(object);
  if (found == objects_.end()) {
    abort(object, 0x06020000);
    return;
  }
  const Bytes& data = found->second;
  if (data.size() > 4) {
    Bytes accepted = addressed(0x41, object);
    accepted[4] = static_cast<std::uint8_t>(data.size());
    segmented_ = object;
    segments_ = data;
    segment_offset_ = 0;
    segmented_write_ = false;
    answer(accepted);
    return;
  }
  Bytes expedited = addressed(static_cast<std::uint8_t>(0x43 | ((4 - data.size()) << 2U)), object);
  std::copy(data.begin(), data.end(), expedited.begin() + 4);
  answer(expedited);
}

void ScriptedSlave::write_object(ObjectAddress object, Bytes data) {
  if (const auto refused = refused_writes_.find(object); refused != refused_writes_.end()) {
    abort(object, refused->second);
    return;
  }
  if (!objects_.contains(object)) {
    abort(object, 0x06020000);
    return;
  }
  if (!ignored_writes_.contains(object)) {
    objects_[object] = std::move(data);
  }
  if (on_write_) {
    on_write_(object);
  }
  answer(addressed(0x60, object));
}

void ScriptedSlave::on_segment(const Bytes& request) {
  const auto toggle = static_cast<std::uint8_t>(request[0] & 0x10U);
  if (segmented_write_) {
    const auto count = static_cast<std::ptrdiff_t>(7 - ((request[0] >> 1U) & 0x07U));
    segments_.insert(segments_.end(), request.begin() + 1, request.begin() + 1 + count);
    if ((request[0] & 0x01U) != 0) {
      if (const auto refused = refused_writes_.find(segmented_); refused != refused_writes_.end()) {
        abort(segmented_, refused->second);
        return;
      }
      objects_[segmented_] = segments_;
    }
    answer({static_cast<std::uint8_t>(0x20U | toggle), 0, 0, 0, 0, 0, 0, 0});
    return;
  }
  const std::size_t count = std::min<std::size_t>(7, segments_.size() - segment_offset_);
  const bool last = segment_offset_ + count == segments_.size();
  Bytes segment(8, 0);
  segment[0] = static_cast<std::uint8_t>(toggle | ((7 - count) << 1U) | (last ? 1U : 0U));
  std::copy_n(segments_.begin() + static_cast<std::ptrdiff_t>(segment_offset_), count, segment.begin() + 1);
  segment_offset_ += count;
  answer(segment);
}

void ScriptedSlave::abort(ObjectAddress object, std::uint32_t code) {
  Bytes bytes = addressed(0x80, object);
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[4 + i] = static_cast<std::uint8_t>(code >> (8 * i));
  }
  answer(bytes);
}

void ScriptedSlave::answer(Bytes bytes) {
  if (answer_delay_ == Duration::zero()) {
    send(0x580U + node_, std::move(bytes));
    return;
  }
  pending_.push_back({canopen::Clock::now() + answer_delay_, std::move(bytes)});
}

void ScriptedSlave::tick() {
  const canopen::TimePoint now = canopen::Clock::now();
  while (!pending_.empty() && pending_.front().at <= now) {
    const Bytes bytes = pending_.front().bytes;
    pending_.erase(pending_.begin());
    send(0x580U + node_, bytes);
  }
  const std::uint64_t period = value(kHeartbeatTime);
  if (period != 0 && !heartbeat_off_ && now >= next_heartbeat_) {
    send(0x700U + node_, {state_});
    next_heartbeat_ = now + std::chrono::milliseconds(period);
  }
}

void ScriptedSlave::arm() {
  timer_.expires_after(kTick);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      tick();
      arm();
    }
  });
}

}  // namespace support
