#include "daemon/doctor/hearing.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <net/if.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <vector>

#include "canopen/bus/socketcan/raw_socket.h"
#include "canopen/bus/socketcan/receive_batch.h"
#include "canopen/cob_id.h"
#include "canopen/survey/error_counts.h"

namespace gateway::doctor {
namespace {

using Time = std::chrono::steady_clock;

// What a node itself sends under its own number: emergencies, TPDO 1 to 4, SDO answers, heartbeat (CiA 301 table 39).
bool is_of_the_node(std::uint32_t function) noexcept {
  switch (function) {
    case 0x080:
    case 0x180:
    case 0x280:
    case 0x380:
    case 0x480:
    case 0x580:
    case 0x700:
      return true;
    default:
      return false;
  }
}

struct Expected {
  std::vector<std::string> silent;   ///< `pump1 (node 5)`
  std::vector<std::string> strange;  ///< `node 12`
  std::size_t drives = 0;
};

Expected compare(const config::Model& model, std::size_t bus, const Hearing& hearing) {
  Expected result;
  std::array<bool, 128> known{};
  known.at(model.buses.at(bus).node_id) = true;
  for (const config::Drive& drive : model.drives) {
    if (drive.bus != bus) {
      continue;
    }
    known.at(drive.node.node) = true;
    if (drive.enabled) {
      ++result.drives;
      if (!hearing.nodes.at(drive.node.node)) {
        result.silent.push_back(fmt::format("{} (node {})", drive.name, drive.node.node));
      }
    }
  }
  for (std::size_t node = 1; node < known.size(); ++node) {
    if (hearing.nodes.at(node) && !known.at(node)) {
      result.strange.push_back(fmt::format("node {}", node));
    }
  }
  return result;
}

std::string what_a_master_did(const Hearing& hearing) {
  std::vector<std::string> signs;
  if (hearing.nmt) {
    signs.emplace_back("NMT commands");
  }
  if (hearing.sync) {
    signs.emplace_back("SYNC");
  }
  for (std::size_t node = 1; node < hearing.asked.size(); ++node) {
    if (hearing.asked.at(node)) {
      signs.push_back(fmt::format("SDO requests to node {}", node));
    }
  }
  return fmt::format("{}", fmt::join(signs, ", "));
}

// Whose it is cannot be told: the gateway sends the same.
void tell_of_others(Lines& lines, const config::Bus& bus, const Hearing& hearing) {
  std::string heard = what_a_master_did(hearing);
  if (bus.node_id != 0 && hearing.nodes.at(bus.node_id)) {
    heard += fmt::format("{}node id {}", heard.empty() ? "" : ", ", bus.node_id);
  }
  if (!heard.empty()) {
    lines.push_back({Verdict::warning, "bus " + bus.name,
                     fmt::format("heard: {}; from the gateway or from somebody else, that is not known", heard),
                     "look again while the gateway answers, or while it is stopped; its line above says why it is not "
                     "known"});
  }
}

void judge_others(Lines& lines, const config::Bus& bus, const Hearing& hearing) {
  const std::string subject = "bus " + bus.name;
  if (bus.node_id != 0 && hearing.nodes.at(bus.node_id)) {
    lines.push_back({Verdict::error, subject, fmt::format("somebody else has the gateway's node id {}", bus.node_id),
                     "give one of the two another: `node_id` in [[bus]], or at the other device"});
  }
  if (const std::string signs = what_a_master_did(hearing); !signs.empty() && !bus.other_master) {
    lines.push_back({Verdict::warning, subject, "another master is at work: " + signs,
                     "let one of them command the drives; where both are wanted, `other_master = true`"});
  }
}

}  // namespace

void Hearing::add(const canopen::Frame& frame) noexcept {
  if (frame.error) {
    const canopen::ErrorCounts counts = canopen::error_counts_of(frame);
    errors += counts.wire > 0 || counts.ack > 0 ? 1U : 0U;  // not those that tell of the controller's state
    return;
  }
  ++frames;
  if (frame.extended || frame.remote || frame.id > canopen::kMaxCobId) {
    return;
  }
  const std::uint32_t node = frame.id & 0x7FU;
  const std::uint32_t function = frame.id & 0x780U;
  if (node == 0) {
    nmt = nmt || frame.id == 0x000;
    sync = sync || frame.id == 0x080;
  } else if (is_of_the_node(function)) {
    nodes[node] = true;
  } else if (function == 0x600) {
    asked[node] = true;
  }
}

std::chrono::milliseconds listening_time(const config::Model& model, std::size_t bus) {
  canopen::Duration longest = std::chrono::seconds(3);
  for (const config::Drive& drive : model.drives) {
    if (drive.bus == bus && drive.enabled) {
      longest = std::max(longest, drive.node.error_control.heartbeat_timeout);
    }
  }
  return std::chrono::ceil<std::chrono::milliseconds>(std::min<canopen::Duration>(longest, std::chrono::minutes(1)));
}

Hearing listen(const std::string& interface, std::chrono::milliseconds time, std::error_code& failed) {
  Hearing hearing;
  const canopen::socketcan::RawSocket socket =
      canopen::socketcan::open_raw_socket(static_cast<int>(::if_nametoindex(interface.c_str())));
  failed = socket.error;
  const auto batch = std::make_unique<canopen::socketcan::ReceiveBatch>();
  const Time::time_point end = Time::now() + time;
  while (!failed) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Time::now());
    if (left.count() <= 0) {
      break;
    }
    pollfd waiting{.fd = socket.descriptor.get(), .events = POLLIN, .revents = 0};
    if (::poll(&waiting, 1, static_cast<int>(left.count())) < 0 && errno != EINTR) {
      failed = std::error_code(errno, std::generic_category());
    }
    const int count = failed ? 0 : batch->read(socket.descriptor.get());
    if (count < 0 && errno != EAGAIN && errno != EINTR) {
      failed = std::error_code(errno, std::generic_category());
    }
    for (int i = 0; i < count; ++i) {
      hearing.add(batch->item(static_cast<std::size_t>(i)).frame);
    }
  }
  return hearing;
}

Lines judge(const config::Model& model, std::size_t bus, const Hearing& hearing, const Listened& listened) {
  const config::Bus& on = model.buses.at(bus);
  const std::string subject = "bus " + on.name;
  const Expected expected = compare(model, bus, hearing);
  const double seconds = std::chrono::duration<double>(listened.time).count();
  Lines lines;
  if (hearing.frames == 0) {
    lines.push_back({Verdict::warning, subject, fmt::format("nothing was heard in {:.1f} s", seconds),
                     "are the drives powered, at this bit rate, and wired; drives that nobody has set up may be silent "
                     "until the gateway runs"});
  } else if (!expected.silent.empty()) {
    lines.push_back(
        {Verdict::warning, subject, fmt::format("not heard in {:.1f} s: {}", seconds, fmt::join(expected.silent, ", ")),
         "compare node id and bit rate at the keypad; drives that nobody has set up may be silent until the "
         "gateway runs"});
  } else if (expected.drives == 0) {
    lines.push_back({Verdict::ok, subject,
                     fmt::format("{} frames in {:.1f} s; no drive is configured here", hearing.frames, seconds)});
  } else {
    lines.push_back(
        {Verdict::ok, subject,
         fmt::format("{} frames in {:.1f} s, all {} drives heard", hearing.frames, seconds, expected.drives)});
  }
  if (!expected.strange.empty()) {
    lines.push_back({Verdict::warning, subject,
                     fmt::format("heard, and not in the configuration: {}", fmt::join(expected.strange, ", ")),
                     "add a [[drive]] for it, or see whether a drive has the wrong node id"});
  }
  if (hearing.errors > 0) {
    lines.push_back({Verdict::warning, subject,
                     fmt::format("the driver told of {} errors in {:.1f} s", hearing.errors, seconds),
                     "look at bit rate, wiring and termination; `ip -details -statistics link show " + on.interface +
                         "` counts them"});
  }
  if (listened.gateway == Presence::absent) {
    judge_others(lines, on, hearing);
  } else if (listened.gateway == Presence::unknown) {
    tell_of_others(lines, on, hearing);
  }
  return lines;
}

}  // namespace gateway::doctor
