#include <fmt/format.h>
#include <unistd.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <exception>
#include <iostream>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "canopen/bus/socketcan/socketcan_link.h"
#include "daemon/announced_link.h"
#include "daemon/commands.h"
#include "daemon/descriptors.h"
#include "daemon/heard_nodes.h"
#include "daemon/output.h"
#include "daemon/simulated_site.h"
#include "daemon/stop_signal.h"
#include "daemon/terminal.h"

namespace gateway {
namespace {

constexpr std::chrono::seconds kListening(2);

/// A SocketCAN interface with the nodes that are to be simulated there.
struct SimulatedBus {
  std::string interface;
  std::set<std::uint8_t> nodes;
};

/// Everything of one `simulate`.
class Simulator {
 public:
  Simulator(const boost::asio::any_io_executor& executor, LiveOutput& output,
            const simulator::DriveOptions& commissioning)
      : executor_(executor),
        output_(output),
        site_(
            executor, [&output](std::string_view text) { output.write(text); }, commissioning),
        watch_(executor) {}

  /// Throws NotSimulated.
  void add(const std::string& interface, const std::vector<SimulatedDrive>& drives) {
    const std::size_t network = add_interface(interface);
    for (const SimulatedDrive& drive : drives) {
      site_.add_drive(network, drive.kind, drive.node);
      buses_.back().nodes.insert(drive.node);
    }
  }
  void add(const config::Model& model) {
    for (std::size_t bus = 0; bus < model.buses.size(); ++bus) {
      site_.add_drives(add_interface(model.buses[bus].interface), model, bus);
      for (const config::Drive& drive : model.drives) {
        if (drive.bus == bus) {
          buses_.back().nodes.insert(drive.node.node);
        }
      }
    }
  }

  /// Listens to all buses, and where no node is heard that is to be simulated switches the drives on. False: they stay
  /// off.
  boost::asio::awaitable<bool> begin() {
    for (const SimulatedBus& bus : buses_) {
      output_.write(fmt::format("Listening on {} for {} s, whether a node id is in use there.\n", bus.interface,
                                kListening.count()));
    }
    // Together: while one is waited for, somebody may come to another.
    const std::vector<HeardNodes> heard = co_await watch_.listen(kListening);
    if (ended_) {
      co_return false;
    }
    bool free = true;
    for (std::size_t i = 0; i < buses_.size(); ++i) {
      free = refuse(buses_[i], heard[i]) && free;
    }
    if (free) {
      start();
    }
    co_return free;
  }
  void end() {
    ended_ = true;
    watch_.stop();
    if (started_) {
      site_.stop();
    }
  }

 private:
  std::size_t add_interface(const std::string& interface) {
    if (interface == config::kVirtualInterface) {
      throw NotSimulated(
          "a virtual bus is inside of one process, nothing else can be on it; name a SocketCAN interface, or use "
          "`demo`");
    }
    auto link = canopen::make_socketcan_link(executor_, interface,
                                             [](const std::string& text) { std::cerr << text << std::endl; });
    link = make_announced_link(std::move(link), interface, std::cerr);
    watch_.add(*link);
    buses_.push_back({interface, {}});
    return site_.add_network(std::move(link));
  }

  static bool refuse(const SimulatedBus& bus, const HeardNodes& heard) {
    bool free = true;
    for (const auto& [node, by] : heard) {
      if (bus.nodes.contains(node)) {
        complain(
            fmt::format("{}: node {} is there already: {} was heard; two nodes of one id disturb each other. "
                        "Simulate another node id, or take that node off the bus",
                        bus.interface, node, by));
        free = false;
      }
    }
    return free;
  }
  void start() {
    started_ = true;
    site_.start();
    const bool one = site_.drives().size() == 1;
    output_.write(fmt::format("{} {} simulated; type help for what can be done to {}\n", site_.drives().size(),
                              one ? "drive" : "drives", one ? "it" : "them"));
  }

  boost::asio::any_io_executor executor_;
  LiveOutput& output_;
  SimulatedSite site_;
  NodeWatch watch_;
  std::vector<SimulatedBus> buses_;
  bool started_ = false;
  bool ended_ = false;
};

void rethrow(const std::exception_ptr& error) {
  if (error) {
    std::rethrow_exception(error);
  }
}

}  // namespace

int simulate(const Options& options, const Simulation& simulation) {
  outlive_job_control();
  boost::asio::io_context loop(1);
  StopSignal stop(loop.get_executor(), StopSignal::HangUp::ends_it);
  LiveOutput output(STDOUT_FILENO, [&stop] { stop.stop(); });
  simulator::DriveOptions commissioning;
  commissioning.tpdo_event_ms = simulation.tpdo_event_ms;
  Simulator simulator(loop.get_executor(), output, commissioning);
  const bool by_configuration = simulation.interface.empty();
  try {
    if (!by_configuration) {
      simulator.add(simulation.interface, simulation.drives);
    } else if (const std::optional<config::Model> model = load_or_complain(options, Secrets::leave)) {
      simulator.add(*model);
    } else {
      return kConfigurationError;
    }
  } catch (const NotSimulated& reason) {
    complain(reason.what());
    return by_configuration ? kConfigurationError : kUsage;
  }
  int code = kDone;
  boost::asio::co_spawn(loop, simulator.begin(), [&](const std::exception_ptr& error, bool begun) {
    rethrow(error);
    if (!begun) {
      code = kFailed;
      stop.stop();
    }
  });
  boost::asio::co_spawn(loop, stop.wait(), [&](const std::exception_ptr& error) {
    rethrow(error);
    simulator.end();
    loop.stop();
  });
  loop.run();
  output.require_written();
  return code;
}

}  // namespace gateway
