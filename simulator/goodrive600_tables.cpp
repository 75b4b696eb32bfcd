#include "simulator/goodrive600_tables.h"

#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "simulator/pdo_settings.h"

namespace simulator {
namespace {

/// CiA 301's unsigned16 as a filler: bytes 6 and 7 of TPDO1 carry nothing.
constexpr std::uint32_t kFiller = map_value(0x0006, 0, 16);

/// 1..240 at every n-th SYNC; 254 by the timer, without one on change; 255 by the timer, without one after the RPDO of
/// the same number. TPDO1 answers RPDO1 and nothing else.
std::optional<Triggers> goodrive_triggers(std::uint8_t number, std::uint8_t type, std::uint16_t event) {
  if (number == 1 && (type != 255 || event != 0)) {
    return std::nullopt;
  }
  Triggers result;
  if (type >= 1 && type <= 240) {
    result.every_sync = type;
  } else if (type >= 254) {
    result.timer = event != 0;
    result.change = type == 254 && event == 0;
    result.rpdo = type == 255 && event == 0;
  } else {
    return std::nullopt;
  }
  return result;
}

std::vector<std::uint32_t> fields(std::uint16_t index, std::uint8_t first, unsigned count) {
  std::vector<std::uint32_t> map;
  for (unsigned i = 0; i < count; ++i) {
    map.push_back(map_value(index, static_cast<std::uint8_t>(first + i), 16));
  }
  return map;
}

std::vector<std::uint32_t> headed(std::uint16_t head, std::vector<std::uint32_t> map) {
  map.insert(map.begin(), map_value(head, 0, 16));
  return map;
}

}  // namespace

Traits goodrive600_traits() {
  Traits traits;
  traits.identity = {0, 0, 0, 0};
  traits.node_guarding = true;
  traits.segmented_sdo = false;
  PdoRules& pdo = traits.pdo;
  std::vector<std::uint32_t> answer = fields(kGoodriveReturns, 0, 3);
  answer.push_back(kFiller);
  pdo.transmit = {{true, 255, 0, 0, std::move(answer)},
                  {true, 254, 1000, 0, headed(kGoodriveStatus, fields(kGoodriveReturns, 3, 3))},
                  {true, 254, 1000, 0, fields(kGoodriveReturns, 6, 4)},
                  {true, 254, 1000, 0, fields(kGoodriveReturns, 10, 4)}};
  pdo.receive = {{true, 255, 0, 0, fields(kGoodriveSettings, 0, 3)},
                 {true, 255, 0, 0, headed(kGoodriveControl, fields(kGoodriveSettings, 3, 3))},
                 {true, 255, 0, 0, fields(kGoodriveSettings, 6, 4)},
                 {true, 255, 0, 0, fields(kGoodriveSettings, 10, 4)}};
  pdo.mapping_writable = false;
  pdo.inhibit_unit = std::chrono::milliseconds(1);
  pdo.inhibit_floor = std::chrono::milliseconds(50);
  pdo.length_errors = false;
  pdo.exact_length[0] = 6;
  pdo.triggers = goodrive_triggers;
  return traits;
}

}  // namespace simulator
