#include "bridges/process/error_check.h"

#include "canopen/clock.h"
#include "canopen/communication_objects.h"
#include "canopen/error.h"
#include "canopen/node/remote_node.h"

namespace process {
namespace {

using canopen::DataType;
using canopen::Raw;
using canopen::Result;

}  // namespace

boost::asio::awaitable<ErrorCheck> check_error_register(canopen::RemoteNode& node) {
  ErrorCheck check;
  check.readings.asked = canopen::Clock::now();
  const Result<Raw> answer = co_await node.read(canopen::kErrorRegister, DataType::u8);
  if (answer.has_value()) {
    check.readings.error_register = static_cast<std::uint8_t>(answer.value());
  } else {
    check.readings.register_absent = is_absent(answer.error());
    check.again = answer.error().kind != canopen::ErrorKind::refused;
  }
  co_return check;
}

boost::asio::awaitable<ErrorCheck> check_errors(const config::Drive& model, canopen::RemoteNode& node) {
  if (!model.faults.has_error_register) {
    co_return ErrorCheck{};
  }
  ErrorCheck check = co_await check_error_register(node);
  if (check.readings.error_register.value_or(0) == 0) {
    co_return check;
  }
  if (model.faults.fault_code) {
    const config::Signal& signal = model.signals[*model.faults.fault_code];
    const Result<Raw> code = co_await node.read(signal.object, signal.type);
    if (code.has_value()) {
      check.readings.fault_code = code.value();
    }
  }
  if (model.faults.has_error_field && check.readings.fault_code.value_or(0) == 0) {
    const Result<Raw> newest = co_await node.read(canopen::kNewestError, DataType::u32);
    if (newest.has_value()) {
      // The high half is additional information of the maker (CiA 301 §7.5.2.4).
      check.readings.history = static_cast<std::uint16_t>(newest.value() & 0xFFFF);
    }
  }
  co_return check;
}

}  // namespace process
