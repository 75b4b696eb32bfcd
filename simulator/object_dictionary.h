#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

namespace simulator {

/// An object's place in a drive's dictionary.
struct Address {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;

  friend auto operator<=>(const Address&, const Address&) = default;
};

/// SDO abort codes (CiA 301 table 22) the simulated drives use; `none` is success.
enum class Abort : std::uint32_t {
  none = 0,
  toggle = 0x05030000,
  unknown_command = 0x05040001,
  unsupported_access = 0x06010000,
  write_only = 0x06010001,
  read_only = 0x06010002,
  no_object = 0x06020000,
  not_mappable = 0x06040041,
  mapping_too_long = 0x06040042,
  wrong_length = 0x06070010,
  too_long = 0x06070012,
  too_short = 0x06070013,
  no_sub_index = 0x06090011,
  invalid_value = 0x06090030,
  general = 0x08000000,
  local_control = 0x08000021,
  device_state = 0x08000022,
  no_data = 0x08000024
};

enum class Access : std::uint8_t { read_only, write_only, read_write };

/// What PDOs may carry an object. Directions are the drive's.
enum class Mappable : std::uint8_t { no, transmit, receive, both };

/// One object: a number of 1, 2 or 4 bytes, or a string (size 0).
struct Object {
  std::uint8_t size = 2;
  Access access = Access::read_write;
  Mappable mappable = Mappable::no;
  std::uint32_t value = 0;  ///< Holds the number unless `read` or `write` are set.
  std::string text;
  std::function<std::uint32_t()> read;
  std::function<Abort(std::uint32_t)> write;
  std::function<bool()> present;  ///< When set and false, reading is refused: no data available.

  [[nodiscard]] bool is_string() const noexcept { return size == 0; }
};

/// `value` cut to `size` bytes.
[[nodiscard]] constexpr std::uint32_t cut(std::uint32_t value, unsigned size) noexcept {
  return size >= 4 ? value : value & ((1U << (8 * size)) - 1U);
}

/// The objects of one drive. Not what a master believes of it: each kind of drive fills its own from its manual.
class ObjectDictionary {
 public:
  /// Adds or replaces. References stay valid until clear() or another add() at the same address.
  Object& add(Address address, Object object);
  Object& add_constant(Address address, std::uint8_t size, std::uint32_t value);
  Object& add_text(Address address, std::string text);
  /// A read-only number worked out at each read.
  Object& add_reading(Address address, std::uint8_t size, std::function<std::uint32_t()> read,
                      Mappable mappable = Mappable::no);
  void clear();

  /// Makes objects that exist in too large a number to list, when they are asked for.
  void set_fallback(std::function<std::optional<Object>(Address)> fallback) { fallback_ = std::move(fallback); }

  [[nodiscard]] Object* find(Address address);
  /// Why find() gave nothing: the object or only the sub-index is absent.
  [[nodiscard]] Abort absence(Address address) const;

  [[nodiscard]] static std::uint32_t read(const Object& object);
  /// Stores or runs the object's action. Access rights are the caller's business.
  static Abort write(Object& object, std::uint32_t value);

 private:
  std::map<Address, Object> objects_;
  std::function<std::optional<Object>(Address)> fallback_;
};

}  // namespace simulator
