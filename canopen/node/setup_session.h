#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "canopen/error.h"
#include "canopen/node/boot_result.h"
#include "canopen/node/life_context.h"
#include "canopen/node/node_settings.h"
#include "canopen/object.h"

namespace canopen {

/// Why a node could not be configured or taken over.
struct BootFailure {
  BootResult letter = BootResult::not_configured;
  std::string text{};        ///< Object, expected, found.
  bool interrupted = false;  ///< The life ended, or our frames could not leave: no verdict, no letter.
  std::string cause{};       ///< Of the text what does not change from one try to the next; empty: all of it.
};

/// What is to be made of differences.
enum class SetupPurpose : std::uint8_t {
  configure,  ///< A node that is not operational: write what differs.
  inspect     ///< An operational node: only read; a difference is BootResult::left_alone.
};

/// An object that should have a value.
struct SetupItem {
  ObjectAddress object;
  DataType type = DataType::u32;
  Raw wanted = 0;
  std::string name;  ///< For people, as in "heartbeat time".
  SetupPolicy policy = SetupPolicy::write;
  /// Another value from `least` to `most` will do, with a remark: while inspecting, and after `wanted` was written, for
  /// some drives round or clamp. `most` 0: none.
  Raw least = 0;
  Raw most = 0;
  Raw mask = ~Raw{0};  ///< Of what is read no other bits count.
};

[[nodiscard]] constexpr bool will_do(const SetupItem& item, Raw found) noexcept {
  return item.most != 0 && found >= item.least && found <= item.most;
}

struct SetupOutcome {
  std::optional<BootFailure> failure;
  bool confirmed = false;  ///< The node showed this value; false where it has no such object or was not asked.
  bool absent = false;     ///< The node has no such object.
  bool will_do = false;    ///< It has another value, which will do.
  std::string remark;      ///< For the log; empty: none.
};

/// `0x1017:00 heartbeat time: expected 500, found 0`.
[[nodiscard]] std::string difference_text(const SetupItem& item, Raw found);

/// The SDO transfers of one configuration or inspection. Once the life is over every further transfer fails, so that no
/// half-done procedure goes on with a node that rebooted in between.
///
/// Some nodes hold the times of heartbeat, guarding and PDOs in another width than CiA 301 says. They are written in
/// the width in which they were read. Where the node refuses that length, or the value does not fit, in their own.
class SetupSession {
 public:
  SetupSession(LifeContext context, SetupPurpose purpose) : context_(context), purpose_(purpose) {}

  [[nodiscard]] const LifeContext& context() const noexcept { return context_; }
  /// How many objects were written, or may have been.
  [[nodiscard]] unsigned written() const noexcept { return written_; }
  void note_half_done(bool note) noexcept { half_done_noted_ = note; }
  [[nodiscard]] bool inspecting() const noexcept { return purpose_ == SetupPurpose::inspect; }

  boost::asio::awaitable<Result<Raw>> read(ObjectAddress object, DataType type);
  /// What is written is noted as half done, unless that is switched off.
  boost::asio::awaitable<Result<void>> write(ObjectAddress object, DataType type, Raw raw);
  /// What `item` wants. Where the node holds it in fewer bits than that needs and takes no other length: the most that
  /// it holds, if that will do.
  boost::asio::awaitable<Result<void>> write(const SetupItem& item);
  /// Reads, compares, writes if it differs and may be written, and reads back. An object that the node lacks is no
  /// failure, nor is one that can only be written: while inspecting nobody can tell, so it counts as it should be.
  boost::asio::awaitable<SetupOutcome> ensure(SetupItem item);

  /// The failure for an unsuccessful read or write. `no_answer` where the node has not answered a single request yet.
  [[nodiscard]] BootFailure failure(const Error& error, std::string_view name) const;
  /// The failure for a wrong value that is not to be corrected.
  [[nodiscard]] BootFailure difference(std::string text) const;

 private:
  boost::asio::awaitable<SetupOutcome> correct(SetupItem item, bool readable);
  [[nodiscard]] DataType width_of(ObjectAddress object, DataType type) const;

  LifeContext context_;
  SetupPurpose purpose_;
  unsigned written_ = 0;
  bool half_done_noted_ = true;
  bool answered_ = false;
  std::map<ObjectAddress, DataType> widths_;  ///< Of times that the node showed in another width than theirs.
};

}  // namespace canopen
