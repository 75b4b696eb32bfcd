#include "bridges/modbus/identification.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string_view>

#include "bridges/modbus/mbap.h"
#include "bridges/modbus/request.h"

namespace modbus {
namespace {

constexpr std::string_view kMaker = "canopen-gateway";

// Of the request.
constexpr std::size_t kRequestSize = 4;
constexpr std::size_t kReadCode = 2;
constexpr std::size_t kObjectId = 3;
enum class ReadCode : std::uint8_t { basic = 1, regular = 2, extended = 3, individual = 4 };

// Of the answer.
constexpr std::uint8_t kConformity = 0x83;  ///< Extended, as a stream and one by one.
constexpr std::uint8_t kMore = 0xFF;
constexpr std::size_t kMoreAt = 4;
constexpr std::size_t kNextAt = 5;
constexpr std::size_t kCountAt = 6;
constexpr std::size_t kIdentityHead = 7;
constexpr std::size_t kObjectHead = 2;
constexpr std::size_t kMaxText = kMaxPdu - kIdentityHead - kObjectHead;

// Each category holds those below it.
std::uint8_t last_id_of(ReadCode code) {
  switch (code) {
    case ReadCode::basic:
      return 0x02;
    case ReadCode::regular:
      return 0x7F;
    case ReadCode::extended:
    case ReadCode::individual:
      break;
  }
  return 0xFF;
}

std::uint8_t number_of(const IdentityObject& object) {
  return static_cast<std::uint8_t>(object.id);
}

std::size_t length_of(const std::string& text) {
  return std::min(text.size(), kMaxText);
}

std::vector<std::uint8_t> identity_head(ReadCode code) {
  return {static_cast<std::uint8_t>(Function::encapsulated_interface),
          static_cast<std::uint8_t>(Encapsulated::device_identification),
          static_cast<std::uint8_t>(code),
          kConformity,
          0,
          0,
          0};
}

void append(std::vector<std::uint8_t>& answer, const IdentityObject& object, const std::string& text) {
  const std::size_t length = length_of(text);
  answer.push_back(number_of(object));
  answer.push_back(static_cast<std::uint8_t>(length));
  answer.insert(answer.end(), text.begin(), text.begin() + static_cast<std::ptrdiff_t>(length));
  ++answer[kCountAt];
}

EncapsulatedAnswer individual(std::uint8_t id, std::span<const IdentityObject> objects) {
  const auto found = std::ranges::find(objects, id, number_of);
  if (found == objects.end()) {
    return Exception::illegal_address;
  }
  const auto* const text = std::get_if<std::string>(&found->text);
  if (text == nullptr) {
    return std::get<Exception>(found->text);
  }
  std::vector<std::uint8_t> answer = identity_head(ReadCode::individual);
  append(answer, *found, *text);
  return answer;
}

EncapsulatedAnswer stream(ReadCode code, std::uint8_t from, std::span<const IdentityObject> known) {
  std::vector<IdentityObject> objects;
  std::ranges::copy_if(known, std::back_inserter(objects), [code](const IdentityObject& object) {
    return number_of(object) <= last_id_of(code) && std::holds_alternative<std::string>(object.text);
  });
  // From one that cannot be told now the stream goes on behind it, and begins anew where nothing follows: an answer
  // without an object is none.
  auto next = objects.begin();
  if (std::ranges::count(known, from, number_of) != 0) {
    next = std::ranges::find_if(objects, [from](const IdentityObject& object) { return number_of(object) >= from; });
  }
  if (next == objects.end()) {
    next = objects.begin();  // What the standard asks for an id that is not known, too.
  }
  std::vector<std::uint8_t> answer = identity_head(code);
  for (; next != objects.end(); ++next) {
    const std::string& text = std::get<std::string>(next->text);
    if (answer.size() + kObjectHead + length_of(text) > kMaxPdu) {
      answer[kMoreAt] = kMore;
      answer[kNextAt] = number_of(*next);
      break;
    }
    append(answer, *next, text);
  }
  return answer;
}

}  // namespace

std::vector<IdentityObject> identity_of_gateway(const config::Model& model) {
  return {{IdentityId::vendor_name, std::string(kMaker)},
          {IdentityId::product_code, std::string(kMaker)},
          {IdentityId::revision, GATEWAY_VERSION},
          {IdentityId::product_name, "CANopen master with Modbus TCP and MQTT"},
          {IdentityId::model_name, std::string(kMaker)},
          {IdentityId::user_application_name, model.gateway.name},
          {IdentityId::name, model.gateway.name},
          {IdentityId::software_version, GATEWAY_VERSION}};
}

std::vector<IdentityObject> identity_of_drive(const config::Model& model, const config::Drive& drive, std::size_t bus) {
  return {{IdentityId::vendor_name, std::string(kMaker)},
          {IdentityId::product_code, drive.profile},
          {IdentityId::revision, GATEWAY_VERSION},
          {IdentityId::product_name,
           "CANopen node " + std::to_string(drive.node.node) + " of bus " + model.buses[bus].name},
          {IdentityId::model_name, drive.profile},
          {IdentityId::user_application_name, model.gateway.name + "/" + drive.name},
          {IdentityId::name, drive.name},
          {IdentityId::profile, drive.profile}};
}

bool asks_for(std::span<const std::uint8_t> pdu, IdentityId id) noexcept {
  if (pdu.size() != kRequestSize) {
    return false;
  }
  const auto wanted = static_cast<std::uint8_t>(id);
  const std::uint8_t from = pdu[kObjectId];
  if (ReadCode{pdu[kReadCode]} == ReadCode::individual) {
    return from == wanted;
  }
  // A stream that goes on behind it does not need it; one from an id that nobody has begins at the first.
  const bool behind = from > wanted && from <= static_cast<std::uint8_t>(IdentityId::software_version);
  return ReadCode{pdu[kReadCode]} == ReadCode::extended && !behind;
}

EncapsulatedAnswer identify(std::span<const std::uint8_t> pdu, std::span<const IdentityObject> objects) {
  if (pdu.size() != kRequestSize) {
    return Exception::illegal_value;
  }
  const ReadCode code{pdu[kReadCode]};
  switch (code) {
    case ReadCode::basic:
    case ReadCode::regular:
    case ReadCode::extended:
      return stream(code, pdu[kObjectId], objects);
    case ReadCode::individual:
      return individual(pdu[kObjectId], objects);
  }
  return Exception::illegal_value;
}

}  // namespace modbus
