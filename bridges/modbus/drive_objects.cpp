#include "bridges/modbus/drive_objects.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "bridges/process/answer.h"
#include "canopen/object.h"

namespace modbus {
namespace {

struct Source {
  IdentityId id{};
  canopen::ObjectAddress object{};
};

// CiA 301 §7.5.2: identity object, manufacturer hardware and software version.
constexpr std::array kSources{Source{IdentityId::serial_number, {0x1018, 4}},
                              Source{IdentityId::hardware_version, {0x1009, 0}},
                              Source{IdentityId::software_version, {0x100A, 0}}};

std::variant<std::string, Exception> number_text(std::span<const std::uint8_t> bytes) {
  const auto number = canopen::decode_raw(canopen::DataType::u32, bytes);
  return number ? std::variant<std::string, Exception>(std::to_string(*number)) : Exception::no_response;
}

// A VISIBLE_STRING: up to its end, where there is one, and without what pads it.
std::string visible_text(std::span<const std::uint8_t> bytes) {
  std::string text(bytes.begin(), std::ranges::find(bytes, std::uint8_t{0}));
  std::ranges::replace_if(text, [](char c) { return c < ' ' || c > '~'; }, '?');
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

EncapsulatedAnswer refusal(const canopen::Error& error) {
  if (error.kind == canopen::ErrorKind::refused && error.abort != 0) {
    return aborted(error.abort);
  }
  return Exception{process::answer_of(error.kind).modbus_exception};
}

}  // namespace

boost::asio::awaitable<std::vector<IdentityObject>> told_identity(process::Drive& drive,
                                                                  std::span<const std::uint8_t> pdu) {
  std::vector<IdentityObject> objects;
  bool answers = true;
  for (const Source& source : kSources) {
    IdentityObject& object = objects.emplace_back(IdentityObject{source.id, Exception::no_response});
    if (!answers || !asks_for(pdu, source.id)) {
      continue;
    }
    const auto read = co_await drive.sdo_read(source.object);
    if (read.has_value()) {
      object.text = source.id == IdentityId::serial_number ? number_text(read.value()) : visible_text(read.value());
    } else if (read.error().kind == canopen::ErrorKind::refused) {
      object.text = Exception::illegal_address;
    } else {
      answers = false;  // The others would take as long.
    }
  }
  co_return objects;
}

boost::asio::awaitable<EncapsulatedAnswer> carry_out(process::Drive& drive, std::span<const std::uint8_t> pdu,
                                                     Reference reference, process::Origin origin) {
  if (reference.write) {
    std::vector<std::uint8_t> data(reference.data.begin(), reference.data.end());
    const process::Outcome outcome = co_await drive.sdo_write(std::move(origin), reference.object, std::move(data));
    co_return outcome.has_error() ? refusal(outcome.error()) : EncapsulatedAnswer(written(pdu));
  }
  const canopen::Result<std::vector<std::uint8_t>> read = co_await drive.sdo_read(reference.object);
  co_return read.has_error() ? refusal(read.error()) : EncapsulatedAnswer(bytes_read(pdu, reference, read.value()));
}

}  // namespace modbus
