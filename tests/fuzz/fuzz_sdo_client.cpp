// An SDO client on the in-process bus: reads, commands and stops of any length in any order, whatever a node answers
// and whenever. Each ends in time, is sent no oftener than may be and not after its deadline; no success without an
// answer behind the request; each frame of ours has eight bytes.
//
// Byte 0: bit 0 short answers, 1 upload-style confirmations, 2 block transfer. Then steps: the low three bits say what.
// 0 time passes: milliseconds; 1 a read; 2 a command: its length; 3 a stop; 4 the node sends: length, bytes; 5 the node
// confirms the newest request as an honest one would: form; 6 another client asks; 7 the life of the node is over.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/sdo/block_frames.h"
#include "canopen/sdo/client.h"
#include "tests/fuzz/byte_input.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace {

using namespace std::chrono_literals;
using canopen::Clock;
using canopen::Frame;
using canopen::ObjectAddress;
using canopen::TimePoint;

constexpr ObjectAddress kReadObject{0x2000, 1};
constexpr ObjectAddress kStopObject{0x2001, 0};
constexpr std::uint16_t kCommands = 0x3000;  ///< The first index of the commands: each has its own.
constexpr std::size_t kMaxSteps = 60;
constexpr canopen::Duration kDeadline = 300ms;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

/// The node's end of the bus.
class Node final : private canopen::LinkEvents {
 public:
  explicit Node(canopen::VirtualBus& bus) : link_(bus.connect()) { link_->open(*this); }
  ~Node() { link_->close(); }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  void send(std::uint32_t id, std::span<const std::uint8_t> bytes) {
    answered_at_ = Clock::now();
    static_cast<void>(link_->send(canopen::make_frame(id, bytes)));
  }
  /// What an honest server says to the newest request, in one of its forms.
  void confirm(std::uint8_t form) {
    if (requests_.empty()) {
      return;
    }
    const Frame& request = requests_.back().frame;
    std::array<std::uint8_t, 8> answer{0, request.data[1], request.data[2], request.data[3], form, 0, 0, 0};
    const auto toggle = static_cast<std::uint8_t>(request.data[0] & 0x10U);
    switch (request.data[0] >> 5U) {
      case 0:
        answer = {static_cast<std::uint8_t>(0x20U | toggle)};
        break;
      case 1:
        answer[0] = 0x60;
        break;
      case 2:
        answer[0] = (form & 1U) != 0 ? 0x41 : 0x43;
        break;
      case 3:
        answer = {static_cast<std::uint8_t>(toggle | (form & 1U)), 1, 2, 3, 4, 5, 6, 7};
        break;
      case 5:
        answer[0] = 0xC2;
        break;
      case 6:
        answer[0] = 0xA0;
        break;
      default:
        answer[0] = 0x80;
        break;
    }
    send(0x585, answer);
  }

  struct Request {
    Frame frame;
    TimePoint at;
  };
  [[nodiscard]] const std::vector<Request>& requests() const noexcept { return requests_; }
  [[nodiscard]] TimePoint answered_at() const noexcept { return answered_at_; }
  /// Downloads of that object that were begun.
  [[nodiscard]] std::vector<TimePoint> begun(ObjectAddress object) const {
    std::vector<TimePoint> times;
    for (const Request& request : requests_) {
      const std::uint8_t kind = request.frame.data[0] >> 5U;
      // A segment of a block download begins with its number, and holds what those of this target never do: an index.
      if ((kind == 1 || request.frame.data[0] == 0xC6) && canopen::address_of(request.frame.bytes()) == object) {
        times.push_back(request.at);
      }
    }
    return times;
  }

 private:
  void on_frames(std::span<const canopen::Received> frames) override {
    for (const canopen::Received& received : frames) {
      require(received.frame.id != 0x605 || received.frame.size == 8);
      if (received.frame.id == 0x605) {
        requests_.push_back({received.frame, Clock::now()});
      }
    }
  }
  void on_echo(const canopen::Received&) override {}
  void on_bus_state(const canopen::BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

  std::unique_ptr<canopen::Link> link_;
  std::vector<Request> requests_;
  TimePoint answered_at_{};
};

/// A command or a stop, and when it is over at the latest.
struct Command {
  support::Spawned<canopen::Result<void>> result;
  ObjectAddress object;
  TimePoint asked;
  unsigned most_sent = 1;  ///< Of all that have this object.
};

class Bench {
 public:
  explicit Bench(std::uint8_t choice) {
    canopen::SdoSettings settings;
    settings.accept_short_answers = (choice & 1U) != 0;
    settings.accept_upload_style_write_answer = (choice & 2U) != 0;
    settings.block = (choice & 4U) != 0;
    block_ = settings.block;
    bus_.start();
    loop_.settle();
    client_ = std::make_unique<canopen::SdoClient>(loop_.executor(), bus_, 5, settings);
  }
  ~Bench() {
    client_->close();
    loop_.settle();
    require(client_->idle());
    client_.reset();
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    require(*stopped);
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  void step(fuzz::ByteInput& input) {
    switch (input.byte() & 7U) {
      case 0:
        loop_.advance(std::chrono::milliseconds(input.byte()));
        break;
      case 1:
        reads_.push_back(support::spawn(loop_.executor(), client_->read_bytes(kReadObject, 0)));
        break;
      case 2:
        command(1U + input.byte());
        break;
      case 3:
        stop();
        break;
      case 4: {
        const std::size_t length = input.byte() % 9U;
        node_.send(0x585, input.bytes(length));
        break;
      }
      case 5:
        node_.confirm(input.byte());
        break;
      case 6:
        other_.send(0x605, std::array<std::uint8_t, 8>{0x40, 0x00, 0x20, 0x01});
        break;
      default:
        client_->interrupt();
        break;
    }
    loop_.settle();
    look();
  }

  /// Nobody says anything any more, so each request in turn takes its time.
  void end() {
    for (int i = 0; i < 3000 && !all_done(); ++i) {
      loop_.advance(100ms, 10ms);
      look();
    }
    require(all_done());
    for (const Command& command : commands_) {
      const std::vector<TimePoint> times = node_.begun(command.object);
      require(times.size() <= command.most_sent * (command.object == kStopObject ? stops_ : 1U));
      if (command.object != kStopObject) {
        require(times.empty() || times.front() < command.asked + kDeadline);
        require(command.result.get().has_error() || !times.empty());
      }
    }
  }

 private:
  /// A command is never repeated; but where block transfer is refused, it begins in segments.
  [[nodiscard]] unsigned most_sent(std::size_t length) const {
    return block_ && length > canopen::kBlockWorthFrom ? 2 : 1;
  }
  void command(std::size_t length) {
    show_life();
    const ObjectAddress object{static_cast<std::uint16_t>(kCommands + commands_.size()), 0};
    const std::vector<std::uint8_t> data(length, 0xFF);
    commands_.push_back(
        {support::spawn(loop_.executor(), client_->write_command(object, data, Clock::now() + kDeadline)), object,
         Clock::now(), most_sent(length)});
  }
  void stop() {
    show_life();
    ++stops_;
    commands_.push_back({support::spawn(loop_.executor(), client_->write_stop(kStopObject, canopen::DataType::u16, 6,
                                                                              Clock::now() + kDeadline)),
                         kStopObject, Clock::now(), 8});
  }
  /// Commands leave only while something is heard on the bus.
  void show_life() {
    other_.send(0x706, std::array<std::uint8_t, 1>{5});
    loop_.settle();
  }
  void look() {
    for (const Command& command : commands_) {
      require(command.result.done() || Clock::now() <= command.asked + kDeadline + 1ms);
      const bool well = command.result.done() && command.result.get().has_value();
      require(!well || node_.answered_at() >= command.asked);
    }
  }
  [[nodiscard]] bool all_done() const {
    return std::ranges::all_of(commands_, [](const Command& command) { return command.result.done(); }) &&
           std::ranges::all_of(reads_, [](const auto& read) { return read.done(); });
  }

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  Node node_{wire_};
  Node other_{wire_};
  canopen::Bus bus_{loop_.executor(), wire_.connect(), {}};
  std::unique_ptr<canopen::SdoClient> client_;
  std::vector<support::Spawned<canopen::Result<std::vector<std::uint8_t>>>> reads_;
  std::vector<Command> commands_;
  std::size_t stops_ = 0;
  bool block_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size < 2) {
    return 0;
  }
  fuzz::ByteInput input({bytes, size});
  Bench bench(input.byte());
  for (std::size_t step = 0; step < kMaxSteps && !input.empty(); ++step) {
    bench.step(input);
  }
  bench.end();
  return 0;
}
