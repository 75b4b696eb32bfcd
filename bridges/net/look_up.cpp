#include "bridges/net/look_up.h"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <boost/asio/error.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

namespace net {

using boost::asio::ip::tcp;
using boost::system::error_code;

namespace {

error_code error_of(int result) {
  switch (result) {
    case 0:
      return {};
    case EAI_SYSTEM:
      return {errno, boost::system::system_category()};
    case EAI_AGAIN:
      return boost::asio::error::host_not_found_try_again;
    case EAI_FAIL:
      return boost::asio::error::no_recovery;
    case EAI_MEMORY:
      return boost::asio::error::no_memory;
    default:
      return boost::asio::error::host_not_found;
  }
}

std::pair<error_code, LookUp::Endpoints> ask(const std::string& name, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  addrinfo* found = nullptr;
  const error_code failed = error_of(::getaddrinfo(name.c_str(), std::to_string(port).c_str(), &hints, &found));
  if (failed) {
    return {failed, {}};
  }
  LookUp::Endpoints endpoints;
  for (const addrinfo* each = found; each != nullptr; each = each->ai_next) {
    tcp::endpoint endpoint;
    if (each->ai_addrlen <= endpoint.capacity()) {
      std::memcpy(endpoint.data(), each->ai_addr, each->ai_addrlen);
      endpoints.push_back(endpoint);
    }
  }
  ::freeaddrinfo(found);
  return std::make_pair(error_code(), std::move(endpoints));
}

}  // namespace

struct LookUp::Shared {
  std::mutex mutex;
  boost::asio::any_io_executor executor;  ///< Empty: nobody wants to know any more.
  Answered answered;
};

LookUp::LookUp(const boost::asio::any_io_executor& executor, std::string name, std::uint16_t port, Answered answered)
    : shared_(std::make_shared<Shared>()) {
  shared_->executor = executor;
  shared_->answered = std::move(answered);
  std::thread([shared = shared_, name = std::move(name), port] {
    auto answer = ask(name, port);
    const std::lock_guard lock(shared->mutex);
    if (!shared->executor) {
      return;
    }
    // Whoever asked is there as long as this is locked, and so is the loop.
    boost::asio::post(shared->executor, [weak = std::weak_ptr(shared), answer = std::move(answer)]() mutable {
      if (const auto asked = weak.lock(); asked && asked->answered) {
        asked->answered(answer.first, std::move(answer.second));
      }
    });
  }).detach();
}

LookUp::~LookUp() {
  const std::lock_guard lock(shared_->mutex);
  shared_->executor = {};
  shared_->answered = nullptr;
}

}  // namespace net
