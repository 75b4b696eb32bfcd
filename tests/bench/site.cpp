#include "tests/bench/site.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <chrono>
#include <future>
#include <stdexcept>

#include "config/load.h"
#include "daemon/demo_config.h"

namespace bench {

std::uint16_t free_port() {
  const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  const bool bound = bind(descriptor, generic, length) == 0 && getsockname(descriptor, generic, &length) == 0;
  close(descriptor);
  if (!bound) {
    throw std::runtime_error("no free port on loopback");
  }
  return ntohs(address.sin_port);
}

config::Model demo_model(std::uint16_t modbus_port, std::uint16_t broker_port) {
  config::LoadOptions options;
  options.file = "demo.toml";
  options.profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"};
  config::Loaded loaded = config::load_text(gateway::demo_config(), options);
  if (!loaded.model) {
    throw std::runtime_error("the demo's configuration does not load");
  }
  config::Model model = std::move(*loaded.model);
  if (modbus_port == 0) {
    model.modbus.reset();
  } else {
    model.modbus->listen = {{"127.0.0.1", modbus_port}};
  }
  if (broker_port == 0) {
    model.mqtt.reset();
  } else {
    model.mqtt->brokers.front().port = broker_port;
    model.mqtt->min_interval = canopen::Duration::zero();
  }
  return model;
}

SiteInThread::SiteInThread(config::Model model)
    : model_(std::move(model)),
      gateway_(loop_.get_executor(), model_, [this](const config::Bus&) { return bus_.connect(); }) {
  const std::size_t network = drives_.add_network(bus_.connect());
  for (const config::Drive& drive : model_.drives) {
    drives_.add_drive(network, drive.profile, drive.node.node);
  }
  gateway_.start();
  drives_.start();
  thread_ = std::thread([this] {
    const auto work = boost::asio::make_work_guard(loop_);
    loop_.run();
  });
}

SiteInThread::~SiteInThread() {
  boost::asio::co_spawn(loop_, gateway_.stop(), boost::asio::use_future).wait();
  on_loop([this] {
    drives_.stop();
    loop_.stop();
  });
  thread_.join();
}

void SiteInThread::on_loop(const std::function<void()>& work) {
  std::promise<void> done;
  boost::asio::post(loop_, [&] {
    work();
    done.set_value();
  });
  done.get_future().wait();
}

bool SiteInThread::wait_online() {
  for (int tries = 0; tries < 200; ++tries) {
    std::size_t online = 0;
    on_loop([&] { online = gateway_.plant().online(); });
    if (online == model_.drives.size()) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

std::uint64_t SiteInThread::frames_received() {
  std::uint64_t received = 0;
  on_loop([&] { received = gateway_.plant().bus_statistics(0).frames_received; });
  return received;
}

}  // namespace bench
