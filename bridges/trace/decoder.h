#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "bridges/trace/entry.h"
#include "bridges/trace/sdo_dialogue.h"
#include "config/model.h"

namespace trace {

/// Takes the frames of one bus apart, in their order: an SDO segment means something only behind those before it. Costs
/// an array access or two for each frame, and allocates nothing.
class Decoder {
 public:
  /// `bus`: position in the model's buses; nothing: a bus that it does not have, whose nodes are strangers.
  Decoder(const config::Model& model, std::optional<std::size_t> bus);
  /// The configuration is another one; what is under way on the bus goes on.
  void place(const config::Model& model, std::optional<std::size_t> bus);

  [[nodiscard]] Entry decode(const canopen::Frame& frame, canopen::WallTime at, canopen::FrameOrigin origin) noexcept;
  /// Frames were lost: what was under way may be over.
  [[nodiscard]] Entry lose(std::uint32_t frames, canopen::WallTime at) noexcept;

 private:
  struct Place {
    std::optional<std::uint16_t> drive{};
    std::uint8_t node = 0;
    std::uint16_t number = 0;  ///< 0: no PDO is configured here.
    std::uint16_t mapping = 0;
    PdoWay way = PdoWay::transmit;
  };
  static constexpr std::size_t kNodes = 128;

  void place_pdos(std::uint16_t drive, const canopen::NodeSettings& node, PdoWay way);
  void take_apart(Entry& entry) noexcept;
  void take_service(Entry& entry) noexcept;
  void take_pdo(Entry& entry, const Place& place) const noexcept;
  void take_error_control(Entry& entry) noexcept;
  void belongs_to(Entry& entry, std::uint32_t node) const noexcept;

  std::optional<std::uint16_t> bus_;
  std::vector<Place> places_;  ///< By COB-ID.
  std::array<std::optional<std::uint16_t>, kNodes> drives_{};
  std::array<SdoDialogue, kNodes> dialogues_{};
  std::array<bool, kNodes> asked_{};  ///< By a guarding request.
};

}  // namespace trace
