#include "canopen/node/error_report.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "canopen/communication_objects.h"
#include "canopen/hex.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

constexpr std::array<std::string_view, 8> kRegisterBits{"generic error", "current",        "voltage",  "temperature",
                                                        "communication", "device profile", "reserved", "manufacturer"};
constexpr Raw kMostErrors = 4;

/// `0x1003:01 is 0x00008130, 0x1003:02 is 0x00002310`; empty where it lists none, or tells nothing.
boost::asio::awaitable<std::string> read_error_field(SdoClient& sdo, const Life& life) {
  std::string text;
  const Result<Raw> count = co_await sdo.read({kNewestError.index, 0}, DataType::u8);
  const Raw last = count.has_value() ? std::min(count.value(), kMostErrors) : 1;
  for (Raw sub = 1; sub <= last && !life.over(); ++sub) {
    const ObjectAddress object{kNewestError.index, static_cast<std::uint8_t>(sub)};
    const Result<Raw> error = co_await sdo.read(object, DataType::u32);
    if (error.has_error()) {
      break;
    }
    text += (text.empty() ? "" : ", ") + to_string(object) + " is 0x" + hex(error.value(), 8);
  }
  co_return text;
}

}  // namespace

std::string error_register_text(Raw error_register) {
  std::string text;
  for (std::size_t bit = 0; bit < kRegisterBits.size(); ++bit) {
    if ((error_register >> bit & 1U) != 0) {
      text.append(text.empty() ? "" : ", ").append(kRegisterBits.at(bit));
    }
  }
  return text;
}

boost::asio::awaitable<std::string> read_error_report(SdoClient& sdo, const Life& life) {
  const Result<Raw> found = co_await sdo.read(kErrorRegister, DataType::u8);
  if (life.over()) {
    co_return std::string();
  }
  std::string text = "its error register 0x1001 ";
  if (found.has_error()) {
    text += "cannot be read: " + to_string(found.error());
  } else {
    text += "is 0x" + hex(found.value(), 2) + " (" +
            (found.value() == 0 ? std::string("no error") : error_register_text(found.value())) + ")";
  }
  const std::string errors = co_await read_error_field(sdo, life);
  if (life.over()) {
    co_return std::string();
  }
  co_return text + (errors.empty() ? "; 0x1003 names no error" : "; its newest errors: " + errors);
}

}  // namespace canopen
