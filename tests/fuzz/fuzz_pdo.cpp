// Any mapping, any frame: decoding never reads or writes beyond, refuses every other length, and what it gives encodes
// to the same bits again.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <vector>

#include "canopen/node/pdo.h"

namespace {

using canopen::DataType;
using canopen::Raw;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

/// Three bytes describe a field: type and dummy, width, index. A zero width ends the mapping.
std::vector<canopen::MappedObject> read_mapping(std::span<const std::uint8_t>& input) {
  std::vector<canopen::MappedObject> mapping;
  unsigned used = 0;
  while (input.size() >= 3 && input[1] != 0) {
    canopen::MappedObject field;
    field.type = static_cast<DataType>(input[0] % 11);
    field.bits = input[1];
    field.object.index = input[2];
    input = input.subspan(3);
    if (field.bits > 64 - used) {
      try {
        mapping.push_back(field);
        const canopen::PdoPlan refused(mapping);
        require(false);
      } catch (const std::invalid_argument&) {
        mapping.pop_back();
      }
      break;
    }
    used += field.bits;
    mapping.push_back(field);
  }
  return mapping;
}

/// Bits that a decoded value holds: those mapped, and no more than its type has.
Raw kept_bits(const canopen::MappedObject& field) {
  const unsigned of_type = canopen::bit_length(field.type);
  const unsigned bits = field.bits < of_type ? field.bits : of_type;
  return bits == 64 ? ~Raw{0} : (Raw{1} << bits) - 1;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> input(data, size);
  const auto mapping = read_mapping(input);
  const canopen::PdoPlan plan(mapping);
  require(plan.byte_count() <= canopen::kMaxPdoBytes && plan.field_count() == mapping.size());

  // On the heap and just large enough, so that a sanitizer sees every step beyond.
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  std::vector<Raw> values(plan.field_count());
  require(plan.decode(bytes, values) == (bytes.size() >= plan.byte_count()));
  if (bytes.size() < plan.byte_count()) {
    return 0;
  }
  const auto encoded = plan.encode(values);
  std::vector<Raw> again(plan.field_count());
  require(plan.decode(std::span(encoded).first(plan.byte_count()), again));
  require(again == values);
  for (std::size_t i = 0; i < mapping.size(); ++i) {
    if (canopen::is_dummy(mapping[i].object)) {
      require(values[i] == 0);
    } else if (!canopen::is_signed(mapping[i].type)) {
      require((values[i] & ~kept_bits(mapping[i])) == 0);
    }
    // Whatever the frame held, it is a value of its type.
    require(canopen::normalise(mapping[i].type, values[i]) == values[i]);
    static_cast<void>(canopen::to_number(mapping[i].type, values[i]));
  }
  return 0;
}
