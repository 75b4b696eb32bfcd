#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopen/frame.h"
#include "canopen/node/node_settings.h"
#include "canopen/node/pdo.h"

namespace canopen {

/// What one RPDO of a drive was commanded to hold: a value and a known flag per field. It decides whether a frame may
/// be built at all, so that no field ever carries a value nobody gave since the image was last void.
class Rpdo {
 public:
  explicit Rpdo(const PdoSettings& settings);

  [[nodiscard]] std::uint16_t number() const noexcept { return number_; }
  [[nodiscard]] std::uint32_t cob_id() const noexcept { return cob_id_; }

  /// `object` is a commanded field of this RPDO.
  [[nodiscard]] bool maps(ObjectAddress object) const noexcept;
  /// Every field is in `fields`, known, or declared unused, and none is unnamed. False too where `fields` holds an
  /// object that this RPDO does not map as commanded.
  [[nodiscard]] bool complete(std::span<const ObjectValue> fields) const noexcept;

  /// A frame on its way, and what confirm() has to know of the moment when it was built.
  struct Draft {
    Frame frame;
    std::uint32_t command_epoch = 0;
    std::uint32_t repeat_epoch = 0;
  };
  /// The frame with `fields` over what is known; nothing where it is not complete. Changes nothing: confirm() does.
  [[nodiscard]] std::optional<Draft> build(std::span<const ObjectValue> fields) const noexcept;

  /// The frame of build(fields) has left: its fields are known, and it is the last confirmed one. Where the image
  /// became void or a field was forgotten while the frame was on its way, that holds: its fields count as not
  /// commanded.
  void confirm(const Draft& draft, std::span<const ObjectValue> fields) noexcept;
  /// Nobody knows whether the frame of build(fields) has left: its fields count as not commanded, and nothing is
  /// repeated until another frame was confirmed.
  void outcome_unknown(std::span<const ObjectValue> fields) noexcept;

  /// A confirmed SDO write: its field is known. In the frame that is repeated the field takes the new value, or the
  /// repetition would undo the write.
  void note(const ObjectValue& value) noexcept;
  /// The field counts as not commanded (momentary value sent, outcome of an SDO write unknown). Nothing is repeated
  /// until another frame was confirmed: repeating a fault reset would reset the next fault too.
  void forget(ObjectAddress object) noexcept;
  /// Nothing counts as commanded, and nothing may be repeated.
  void make_void() noexcept;
  /// Nothing counts as commanded, but the last confirmed frame goes on being repeated: a drive that supervises its
  /// RPDOs and came to a stop would otherwise trip.
  void make_void_but_repeat() noexcept;

  /// The last confirmed frame, for repetition; nothing where none may be repeated.
  [[nodiscard]] std::optional<Frame> last_confirmed() const noexcept { return last_confirmed_; }

 private:
  struct Field {
    ObjectAddress object;
    FieldUse use = FieldUse::commanded;
    bool known = false;
    Raw value = 0;
  };

  [[nodiscard]] static const ObjectValue* given(const Field& field, std::span<const ObjectValue> fields) noexcept;
  void set(const ObjectValue& value, bool known) noexcept;
  void replace_in_last_confirmed(const ObjectValue& value) noexcept;

  std::uint16_t number_;
  std::uint32_t cob_id_;
  PdoPlan plan_;
  std::vector<Field> fields_;
  std::optional<Frame> last_confirmed_;
  std::uint32_t command_epoch_ = 0;  ///< Grows when something known is not any more.
  std::uint32_t repeat_epoch_ = 0;   ///< Grows when the frames of before are not to be repeated any more.
};

}  // namespace canopen
