#include "bridges/modbus/answers.h"

#include <modbus/modbus.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <new>
#include <system_error>

namespace modbus {

void Answers::Free::operator()(_modbus* context) const noexcept {
  modbus_free(context);
}

Answers::Answers() : context_(modbus_new_tcp(nullptr, 0)) {
  if (!context_) {
    throw std::bad_alloc();
  }
  // It sleeps this long before it answers what it takes for garbage. That is refused before, but if one ever came
  // through, the whole gateway would stand still for the default of half a second.
  modbus_set_response_timeout(context_.get(), 0, 1);
  // Each send comes out as one message, so nothing of an answer could ever get into the next one.
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, sockets_.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "[modbus]: cannot make a pair of sockets");
  }
  modbus_set_socket(context_.get(), sockets_[0]);
}

Answers::~Answers() {
  ::close(sockets_[0]);
  ::close(sockets_[1]);
}

std::span<const std::uint8_t> Answers::refuse(std::span<const std::uint8_t> frame, Exception exception,
                                              AnswerRoom out) {
  modbus_reply_exception(context_.get(), frame.data(), static_cast<unsigned>(exception));
  return take(out);
}

std::span<const std::uint8_t> Answers::answer(std::span<const std::uint8_t> frame, const Request& request,
                                              Snapshot& values, AnswerRoom out) {
  if (request.reads() && request.writes()) {
    answer_read_write(frame, values);
  } else if (request.reads()) {
    answer_read(frame, request, values);
  } else {
    answer_write(frame, request);
  }
  return take(out);
}

std::span<const std::uint8_t> Answers::take(AnswerRoom out) {
  const ssize_t count = ::recv(sockets_[1], out.data(), out.size(), 0);
  return out.first(count > 0 ? static_cast<std::size_t>(count) : 0);
}

void Answers::answer_read(std::span<const std::uint8_t> frame, const Request& request, Snapshot& values) {
  // The mapping covers exactly what was asked for.
  modbus_mapping_t mapping{};
  mapping.start_bits = mapping.start_input_bits = request.read.address;
  mapping.start_registers = mapping.start_input_registers = request.read.address;
  if (request.of_bits()) {
    mapping.nb_bits = mapping.nb_input_bits = request.read.quantity;
    mapping.tab_bits = mapping.tab_input_bits = values.bits.data();
  } else {
    mapping.nb_registers = mapping.nb_input_registers = request.read.quantity;
    mapping.tab_registers = mapping.tab_input_registers = values.registers.data();
  }
  modbus_reply(context_.get(), frame.data(), static_cast<int>(frame.size()), &mapping);
}

void Answers::answer_write(std::span<const std::uint8_t> frame, const Request& request) {
  // libmodbus writes into whatever it is given; the tables change only by what the drive confirmed.
  std::array<std::uint8_t, kMaxReadBits> scratch_bits{};
  std::array<std::uint16_t, kMaxReadRegisters> scratch_registers{};
  modbus_mapping_t mapping{};
  mapping.start_bits = mapping.start_registers = request.write.address;
  if (request.of_bits()) {
    mapping.nb_bits = request.write.quantity;
    mapping.tab_bits = scratch_bits.data();
  } else {
    mapping.nb_registers = request.write.quantity;
    mapping.tab_registers = scratch_registers.data();
  }
  modbus_reply(context_.get(), frame.data(), static_cast<int>(frame.size()), &mapping);
}

void Answers::answer_read_write(std::span<const std::uint8_t> frame, const Snapshot& values) {
  // The answer to function 23 names no addresses. So the same request is answered from a scratch table in which what
  // is read stands first and what is written behind it, wherever the true addresses are and even where they overlap.
  std::array<std::uint16_t, std::size_t{2} * kMaxReadRegisters> scratch{};
  std::ranges::copy(values.registers, scratch.begin());
  std::array<std::uint8_t, kMaxFrame> moved{};
  std::ranges::copy(frame, moved.begin());
  constexpr std::size_t kReadAddress = kHeaderSize + 1;
  constexpr std::size_t kWriteAddress = kHeaderSize + 5;
  moved[kReadAddress] = 0;
  moved[kReadAddress + 1] = 0;
  moved[kWriteAddress] = 0;
  moved[kWriteAddress + 1] = kMaxReadRegisters;

  modbus_mapping_t mapping{};
  mapping.nb_registers = static_cast<int>(scratch.size());
  mapping.tab_registers = scratch.data();
  modbus_reply(context_.get(), moved.data(), static_cast<int>(frame.size()), &mapping);
}

}  // namespace modbus
