#include "tests/bench/modbus_ceiling.h"

#include <sys/select.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace bench {

BareModbusServer::BareModbusServer(std::uint16_t port)
    : context_(modbus_new_tcp("127.0.0.1", port)),
      mapping_(modbus_mapping_new(0, 0, 100, 100)),
      listener_(modbus_tcp_listen(context_, 256)) {
  if (listener_ < 0) {
    throw std::runtime_error("the bare Modbus server cannot listen");
  }
  thread_ = std::thread([this] { serve(); });
}

BareModbusServer::~BareModbusServer() {
  stop_ = true;
  thread_.join();
  close(listener_);
  modbus_mapping_free(mapping_);
  modbus_free(context_);
}

void BareModbusServer::serve() {
  std::vector<int> clients;
  std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> request{};
  while (!stop_) {
    fd_set readable;
    FD_ZERO(&readable);
    FD_SET(listener_, &readable);
    int highest = listener_;
    for (const int client : clients) {
      FD_SET(client, &readable);
      highest = std::max(highest, client);
    }
    timeval wait{0, 100'000};
    if (select(highest + 1, &readable, nullptr, nullptr, &wait) <= 0) {
      continue;
    }
    if (FD_ISSET(listener_, &readable)) {
      clients.push_back(modbus_tcp_accept(context_, &listener_));
    }
    std::erase_if(clients, [&](int client) {
      if (!FD_ISSET(client, &readable)) {
        return false;
      }
      modbus_set_socket(context_, client);
      const int length = modbus_receive(context_, request.data());
      if (length < 0) {
        close(client);
        return true;
      }
      modbus_reply(context_, request.data(), length, mapping_);
      return false;
    });
  }
  for (const int client : clients) {
    close(client);
  }
}

}  // namespace bench
