#include "bridges/trace/communication_words.h"

#include <array>
#include <optional>
#include <string_view>

#include "canopen/communication_objects.h"
#include "canopen/hex.h"
#include "canopen/node/error_report.h"

namespace trace {
namespace {

using canopen::DataType;
using canopen::hex;
using canopen::ObjectAddress;

/// What the parameters of a PDO are about (CiA 301 §7.5.2.35 to §7.5.2.38).
enum class PdoObject : std::uint8_t { none, communication, mapping };

struct PdoPlace {
  PdoObject what = PdoObject::none;
  bool transmits = false;
  unsigned number = 0;
};

struct Named {
  std::uint16_t index;
  std::string_view name;
};

// CiA 301 §7.5.2.
constexpr std::array kObjects{Named{0x1000, "device type"},
                              Named{0x1001, "error register"},
                              Named{0x1002, "manufacturer status register"},
                              Named{0x1003, "error field"},
                              Named{0x1005, "COB-ID SYNC"},
                              Named{0x1006, "communication cycle period"},
                              Named{0x1007, "synchronous window length"},
                              Named{0x1008, "device name"},
                              Named{0x1009, "hardware version"},
                              Named{0x100A, "software version"},
                              Named{0x100C, "guard time"},
                              Named{0x100D, "life time factor"},
                              Named{0x1010, "store parameters"},
                              Named{0x1011, "restore default parameters"},
                              Named{0x1012, "COB-ID TIME"},
                              Named{0x1014, "COB-ID EMCY"},
                              Named{0x1015, "inhibit time EMCY"},
                              Named{0x1016, "consumer heartbeat time"},
                              Named{0x1017, "producer heartbeat time"},
                              Named{0x1018, "identity"},
                              Named{0x1019, "synchronous counter overflow value"},
                              Named{0x1020, "verify configuration"},
                              Named{0x1021, "store EDS"},
                              Named{0x1029, "error behaviour"}};
constexpr std::array<std::string_view, 5> kIdentity{"", "vendor id", "product code", "revision number",
                                                    "serial number"};
constexpr std::array<std::string_view, 7> kPdoParameters{"number of parameters", "COB-ID",   "transmission type",
                                                         "inhibit time",         "reserved", "event timer",
                                                         "SYNC start value"};

PdoPlace pdo_place(std::uint16_t index) noexcept {
  constexpr unsigned kPdos = 0x200;
  if (index < 0x1400 || index >= 0x1C00) {
    return {};
  }
  const unsigned place = index - 0x1400U;
  return {.what = place / kPdos % 2 == 0 ? PdoObject::communication : PdoObject::mapping,
          .transmits = place >= 2 * kPdos,
          .number = place % kPdos + 1};
}

std::string pdo_name(const PdoPlace& place, std::uint8_t sub) {
  std::string name = (place.transmits ? "TPDO" : "RPDO") + std::to_string(place.number);
  if (place.what == PdoObject::mapping) {
    return name + (sub == 0 ? " mapping, number of objects" : " mapping, object " + std::to_string(sub));
  }
  return sub < kPdoParameters.size() ? name.append(" ").append(kPdoParameters.at(sub))
                                     : name + " parameter " + std::to_string(sub);
}

// CiA 301 §7.5.2.5, §7.5.2.17, §7.5.2.35: bit 31 is different for SYNC, whose bit 30 says that the device sends it.
std::string cob_id_words(std::uint16_t index, std::uint64_t value) {
  constexpr std::uint64_t kOff = 0x80000000;
  constexpr std::uint64_t kProducer = 0x40000000;
  std::string text = "0x" + hex(value & 0x1FFFFFFFU, 3);
  if (index == 0x1005) {
    return (value & kProducer) != 0 ? text + ", sent by this device" : text;
  }
  return (value & kOff) != 0 ? text + ", switched off" : text;
}

// CiA 301 table 69 and 71.
std::string transmission_words(std::uint64_t type) {
  if (type == 0) {
    return "0, with the next SYNC after a change";
  }
  if (type <= 240) {
    return std::to_string(type) + ", with every " + (type == 1 ? std::string() : std::to_string(type) + ". ") + "SYNC";
  }
  if (type >= 254) {
    return std::to_string(type) + ", on change or by its timer";
  }
  return type >= 252 ? std::to_string(type) + ", on request" : std::to_string(type) + ", reserved";
}

std::string mapping_words(std::uint64_t value) {
  const ObjectAddress object{static_cast<std::uint16_t>(value >> 16U), static_cast<std::uint8_t>(value >> 8U)};
  return value == 0 ? "none" : to_string(object) + ", " + std::to_string(value & 0xFFU) + " bits";
}

std::string milliseconds(std::uint64_t value) {
  return value == 0 ? "0, off" : std::to_string(value) + " ms";
}

std::string register_words(std::uint64_t value) {
  return "0x" + hex(value, 2) + (value == 0 ? ", no error" : ", " + canopen::error_register_text(value));
}

std::string consumer_words(std::uint64_t value) {
  const std::uint64_t node = value >> 16U & 0xFFU;
  return node == 0 || (value & 0xFFFFU) == 0
             ? "off"
             : "node " + std::to_string(node) + " within " + std::to_string(value & 0xFFFFU) + " ms";
}

std::string device_type_words(std::uint64_t value) {
  return "0x" + hex(value, 8) +
         ((value & 0xFFFFU) == 0 ? ", no device profile" : ", device profile " + std::to_string(value & 0xFFFFU));
}

std::string pdo_value(const PdoPlace& place, ObjectAddress object, std::uint64_t value) {
  if (object.sub == 0) {
    return {};
  }
  if (place.what == PdoObject::mapping) {
    return mapping_words(value);
  }
  switch (object.sub) {
    case 1:
      return cob_id_words(object.index, value);
    case 2:
      return transmission_words(value & 0xFFU);
    case 5:
      return milliseconds(value);
    default:
      return {};
  }
}

}  // namespace

std::string communication_name(ObjectAddress object) {
  if (const PdoPlace place = pdo_place(object.index); place.what != PdoObject::none) {
    return pdo_name(place, object.sub);
  }
  for (const Named& known : kObjects) {
    if (known.index == object.index) {
      if (object.index == canopen::kSerialNumber.index && object.sub > 0 && object.sub < kIdentity.size()) {
        return std::string(kIdentity.at(object.sub));
      }
      return std::string(known.name);
    }
  }
  return {};
}

std::string communication_value(ObjectAddress object, std::span<const std::uint8_t> bytes) {
  if (bytes.empty() || bytes.size() > 4) {
    return {};
  }
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) {
    value = value << 8U | bytes[i - 1];
  }
  if (const PdoPlace place = pdo_place(object.index); place.what != PdoObject::none) {
    return pdo_value(place, object, value);
  }
  switch (object.index) {
    case 0x1000:
      return device_type_words(value);
    case 0x1001:
      return register_words(value);
    case 0x1003:
      return object.sub == 0 ? "" : value == 0 ? "none" : "0x" + hex(value, 8);
    case 0x1005:
    case 0x1012:
    case 0x1014:
      return cob_id_words(object.index, value);
    case 0x100C:
    case 0x1017:
      return milliseconds(value);
    case 0x1016:
      return object.sub == 0 ? "" : consumer_words(value);
    case 0x1018:
      return object.sub == 0 ? "" : "0x" + hex(value, 8);
    default:
      return {};
  }
}

}  // namespace trace
