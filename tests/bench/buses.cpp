// What a frame costs with one, two and four buses of 126 drives each, from the link to the process image; and what the
// survey of a bus and the recorder that keeps the frame add to it.

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "bridges/process/plant.h"
#include "bridges/recorder/frame_ring.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/link.h"
#include "canopen/survey/bus_survey.h"
#include "config/load.h"
#include "tests/bench/parts.h"
#include "tests/bench/rates.h"

namespace bench {
namespace {

constexpr unsigned kDrives = 126;
constexpr std::uint8_t kOperational = 5;
/// What the recorder may add to the way of a frame.
constexpr double kMostOfRecorder = 1.05;

/// What this thread has used.
double processor_seconds() {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

/// A bus without a wire: what 126 running drives send is told when turn() is called. They refuse every object.
class FedLink final : public canopen::Link {
 public:
  void open(canopen::LinkEvents& events) override {
    events_ = &events;
    open_ = true;
  }
  void close() override { events_ = nullptr; }
  canopen::SendResult send(const canopen::Frame& frame) override {
    sent_.push_back(frame);
    return canopen::SendResult::handed_over;
  }

  /// Echoes and SDO answers; then a heartbeat and `tpdos` TPDOs of each drive. How many frames the drives sent.
  std::size_t turn(unsigned tpdos) {
    if (events_ == nullptr) {
      return 0;
    }
    if (std::exchange(open_, false)) {
      events_->on_bus_state({canopen::BusCondition::error_active, 0, 0});
    }
    const canopen::TimePoint now = canopen::Clock::now();
    const canopen::WallTime wall = canopen::wall_now();
    batch_.clear();
    for (const canopen::Frame& frame : std::exchange(sent_, {})) {
      events_->on_echo({frame, now, {}});
      if (frame.id > 0x600 && frame.id < 0x680) {
        batch_.push_back({refusal(frame), now, wall});
      }
    }
    for (unsigned round = 0; round <= tpdos; ++round) {
      for (std::uint32_t node = 1; node <= kDrives; ++node) {
        const std::array<std::uint8_t, 4> values{0x27, 0x02, static_cast<std::uint8_t>(++counter_), 0};
        batch_.push_back({round == 0 ? canopen::make_frame(0x700U + node, std::array{kOperational})
                                     : canopen::make_frame(0x180U + node, values),
                          now, wall});
      }
    }
    events_->on_frames(batch_);
    return batch_.size();
  }

 private:
  static canopen::Frame refusal(const canopen::Frame& request) {
    const std::array<std::uint8_t, 8> abort{0x80, request.data[1], request.data[2], request.data[3], 0, 0, 0x02, 0x06};
    return canopen::make_frame(request.id - 0x80U, abort);
  }

  canopen::LinkEvents* events_ = nullptr;
  bool open_ = false;
  std::vector<canopen::Frame> sent_;
  std::vector<canopen::Received> batch_;
  std::uint64_t counter_ = 0;
};

/// So that a drive which refuses every object can be served.
void assume_settings(std::vector<canopen::PdoSettings>& pdos) {
  for (canopen::PdoSettings& pdo : pdos) {
    pdo.communication = canopen::SetupPolicy::assume;
    pdo.mapping_policy = canopen::SetupPolicy::assume;
  }
}

config::Model model_of(unsigned buses) {
  std::string site;
  for (unsigned bus = 0; bus < buses; ++bus) {
    site += fmt::format("[[bus]]\nname = \"can{}\"\ninterface = \"virtual\"\n", bus);
  }
  for (unsigned bus = 0; bus < buses; ++bus) {
    for (unsigned node = 1; node <= kDrives; ++node) {
      site += fmt::format(
          "[[drive]]\nname = \"d{}-{}\"\nbus = \"can{}\"\nnode = {}\nunit = \"none\"\nprofile = \"cia402-velocity\"\n",
          bus, node, bus, node);
    }
  }
  config::Loaded loaded = config::load_text(
      site, {.file = "buses.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "bench"});
  if (!loaded.model) {
    throw std::runtime_error("the site does not load: " + config::to_string(loaded.findings.front()));
  }
  for (config::Drive& drive : loaded.model->drives) {
    assume_settings(drive.node.tpdos);
    assume_settings(drive.node.rpdos);
  }
  return std::move(*loaded.model);
}

/// Buses of 126 drives that all run.
class FullBuses {
 public:
  explicit FullBuses(unsigned buses) : model_(model_of(buses)) {
    const double begin = processor_seconds();
    std::vector<process::Plant::BusPort> ports;
    for (unsigned i = 0; i < buses; ++i) {
      auto link = std::make_unique<FedLink>();
      links_.push_back(link.get());
      buses_.push_back(std::make_unique<canopen::Bus>(loop_.get_executor(), std::move(link), canopen::BusSettings{}));
      ports.push_back({buses_.back().get(), {}});
    }
    plant_ = std::make_unique<process::Plant>(loop_.get_executor(), model_, std::move(ports));
    for (const auto& bus : buses_) {
      bus->start();
    }
    plant_->start();
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (plant_->online() < plant_->size()) {
      if (std::chrono::steady_clock::now() > end) {
        throw std::runtime_error(fmt::format("{} of {} drives came online", plant_->online(), plant_->size()));
      }
      static_cast<void>(turn(0));
    }
    start_up_ = processor_seconds() - begin;
  }
  ~FullBuses() {
    bool stopped = false;
    boost::asio::co_spawn(
        loop_,
        [](FullBuses& all) -> boost::asio::awaitable<void> {
          co_await all.plant_->stop();
          for (const auto& bus : all.buses_) {
            co_await bus->stop();
          }
        }(*this),
        [&](const std::exception_ptr&) { stopped = true; });
    while (!stopped) {
      loop_.poll();
    }
  }
  FullBuses(const FullBuses&) = delete;
  FullBuses& operator=(const FullBuses&) = delete;

  /// Seconds of the processor until all drives were online, what the drives sent meanwhile included.
  [[nodiscard]] double start_up() const noexcept { return start_up_; }
  [[nodiscard]] canopen::Bus& bus(std::size_t index) { return *buses_[index]; }
  std::size_t turn(unsigned tpdos) {
    std::size_t frames = 0;
    for (FedLink* link : links_) {
      frames += link->turn(tpdos);
    }
    loop_.poll();
    return frames;
  }
  /// Whether the buses are looked at.
  void survey(bool on) {
    surveys_.clear();
    for (const auto& bus : buses_) {
      if (on) {
        surveys_.push_back(std::make_unique<canopen::BusSurvey>(
            loop_.get_executor(), *bus,
            canopen::BusSurvey::Handlers{.known = [] { return canopen::BusSurvey::Known{}; }}));
        surveys_.back()->start();
      }
    }
  }
  /// Nanoseconds of the processor a frame, of the fastest of some turns: what else runs on the machine stops us now and
  /// then, and empties the caches.
  double cost() {
    double best = 1e9;
    for (int i = 0; i < 40; ++i) {
      const double begin = processor_seconds();
      const std::size_t frames = turn(8);
      best = std::min(best, (processor_seconds() - begin) * 1e9 / static_cast<double>(frames));
    }
    return best;
  }

 private:
  boost::asio::io_context loop_{1};
  config::Model model_;
  std::vector<FedLink*> links_;
  std::vector<std::unique_ptr<canopen::Bus>> buses_;
  std::unique_ptr<process::Plant> plant_;
  std::vector<std::unique_ptr<canopen::BusSurvey>> surveys_;
  double start_up_ = 0;
};

}  // namespace

void buses() {
  FullBuses one(1);
  for (const unsigned count : {2U, 4U}) {
    FullBuses several(count);
    std::vector<double> ratios;
    std::vector<double> costs;
    std::vector<double> costs_of_one;
    for (int round = 0; round < 9; ++round) {
      costs_of_one.push_back(one.cost());
      costs.push_back(several.cost());
      ratios.push_back(costs.back() / costs_of_one.back());
    }
    fmt::print("frames to image, {} buses of {} drives: 1 bus {:.0f} ns a frame, {} buses {:.0f} ns, ratio {:.2f}\n",
               count, kDrives, median(costs_of_one), count, median(costs), median(ratios));
    fmt::print("start-up, {} buses of {} drives: 1 bus {:.0f} us a drive, {} buses {:.0f} us\n", count, kDrives,
               one.start_up() * 1e6 / kDrives, count, several.start_up() * 1e6 / (kDrives * count));
  }
}

void survey() {
  FullBuses bus(1);
  std::vector<double> ratios;
  std::vector<double> without;
  std::vector<double> with;
  for (int round = 0; round < 15; ++round) {
    bus.survey(false);
    without.push_back(bus.cost());
    bus.survey(true);
    with.push_back(bus.cost());
    ratios.push_back(with.back() / without.back());
  }
  fmt::print("frames to image, bus health: without {:.0f} ns a frame, with it {:.0f} ns, ratio {:.3f}\n",
             median(without), median(with), median(ratios));
}

void recorder() {
  FullBuses buses(1);
  recorder::FrameRing ring(std::chrono::seconds(10), recorder::most_frames(1'000'000, std::chrono::seconds(15)));
  std::vector<double> ratios;
  std::vector<double> costs;
  std::vector<double> costs_without;
  for (int round = 0; round < 21; ++round) {
    costs_without.push_back(buses.cost());
    const canopen::Subscription tap = buses.bus(0).add_tap(ring);
    costs.push_back(buses.cost());
    ratios.push_back(costs.back() / costs_without.back());
  }
  fmt::print("frames to image, recorder: without {:.0f} ns a frame, with it {:.0f} ns, ratio {:.3f}; {} kB of frames\n",
             median(costs_without), median(costs), median(ratios), ring.memory() / 1000);
  if (median(ratios) > kMostOfRecorder) {
    throw std::runtime_error(fmt::format("the recorder costs too much: {:.3f} > {}", median(ratios), kMostOfRecorder));
  }
}

}  // namespace bench
