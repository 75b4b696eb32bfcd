#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopen/frame.h"
#include "canopen/node/node_settings.h"
#include "canopen/node/pdo.h"

namespace canopen {

/// What one RPDO of a drive was commanded to hold, and the one frame of it that is on its way. It decides whether a
/// frame may be built at all, so that no field ever carries a value nobody gave since the image was last void.
class Rpdo {
 public:
  explicit Rpdo(const PdoSettings& settings);

  [[nodiscard]] std::uint16_t number() const noexcept { return number_; }

  /// `object` is a commanded field of this RPDO.
  [[nodiscard]] bool maps(ObjectAddress object) const noexcept;
  /// Every field is in `fields`, known, or declared unused, and none is unnamed. False too where `fields` holds an
  /// object that this RPDO does not map as commanded.
  [[nodiscard]] bool complete(std::span<const ObjectValue> fields) const noexcept;

  /// The frame with `fields` over what is known, which is the one on its way from now on; nothing where it is not
  /// complete. Nothing counts as commanded by it before left().
  [[nodiscard]] std::optional<Frame> begin(std::span<const ObjectValue> fields) noexcept;
  /// The frame on its way carries values that were commanded earlier.
  [[nodiscard]] bool relies_on_known() const noexcept;
  /// The frame on its way has left: the fields given with it are known, and it is the one to be repeated. Where the
  /// image became void, or a field was noted or forgotten, since begin(), its fields count as not commanded.
  void left() noexcept;
  /// Nobody knows whether it has left: its fields count as not commanded, and nothing is repeated.
  void outcome_unknown() noexcept;

  /// A confirmed SDO write: its field is known. In the frame that is repeated the field takes the new value, or the
  /// repetition would undo the write.
  void note(const ObjectValue& value) noexcept;
  /// The field counts as not commanded (momentary value sent, outcome of an SDO write unknown). Nothing is repeated
  /// until another frame has left: repeating a fault reset would reset the next fault too.
  void forget(ObjectAddress object) noexcept;
  /// Nothing counts as commanded. `keep_repeating`: the frame that is repeated stays, for a drive that supervises its
  /// RPDOs and came to a stop would otherwise trip.
  void make_void(bool keep_repeating) noexcept;

  /// The frame to be repeated: the last one that has left, with what was noted since. Nothing where none may be.
  [[nodiscard]] std::optional<Frame> repeated() const noexcept;

 private:
  struct Field {
    ObjectAddress object;
    FieldUse use = FieldUse::commanded;
    std::optional<Raw> known{};
    Raw repeated = 0;
    Raw on_its_way = 0;
    bool given = false;  ///< With the frame on its way.
  };

  [[nodiscard]] static const ObjectValue* find(const Field& field, std::span<const ObjectValue> fields) noexcept;
  [[nodiscard]] Frame frame_of(Raw Field::* value) const noexcept;

  std::uint16_t number_;
  std::uint32_t cob_id_;
  PdoPlan plan_;
  std::vector<Field> fields_;
  bool repeats_ = false;
  // What becomes of the frame on its way once it has left.
  bool will_count_ = false;   ///< Its fields will be known.
  bool will_repeat_ = false;  ///< It will be repeated.
};

}  // namespace canopen
