#include "daemon/simulated_site.h"

#include <utility>

namespace gateway {

SimulatedSite::SimulatedSite(const boost::asio::any_io_executor& executor, Answers answers,
                             const simulator::DriveOptions& commissioning)
    : executor_(executor),
      commissioning_(commissioning),
      reader_(executor, [this, answers = std::move(answers)](std::string_view line) {
        if (const std::string answer = console_.execute(line); !answer.empty()) {
          answers(answer + "\n");
        }
      }) {}

std::size_t SimulatedSite::add_network(std::unique_ptr<canopen::Link> link) {
  networks_.push_back(std::make_unique<simulator::Network>(executor_, std::move(link)));
  return networks_.size() - 1;
}

void SimulatedSite::add_drive(std::size_t network, std::string_view kind, std::uint8_t node) {
  std::unique_ptr<simulator::Drive> drive = simulator::make_drive(kind, node, *networks_.at(network), commissioning_);
  if (!drive) {
    throw NotSimulated(simulator::why_no_drive(kind, node));
  }
  if (!console_.add(*drive)) {
    throw NotSimulated("node " + std::to_string(node) + " is simulated already; give each drive its own node");
  }
  drives_.push_back(std::move(drive));
}

void SimulatedSite::add_drives(std::size_t network, const config::Model& model, std::size_t bus) {
  for (const config::Drive& drive : model.drives) {
    if (drive.bus != bus) {
      continue;
    }
    try {
      add_drive(network, drive.profile, drive.node.node);
    } catch (const NotSimulated& reason) {
      throw NotSimulated("drive \"" + drive.name + "\": " + reason.what());
    }
  }
}

void SimulatedSite::start() {
  for (const auto& network : networks_) {
    network->open();
  }
  for (const auto& drive : drives_) {
    drive->power_on();
  }
  reader_.start();
}

void SimulatedSite::stop() {
  reader_.stop();
  for (const auto& drive : drives_) {
    drive->power_off();
  }
  for (const auto& network : networks_) {
    network->close();
  }
}

}  // namespace gateway
