#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "canopen/error.h"
#include "canopen/node/node_settings.h"
#include "canopen/object.h"

namespace canopen {

class SdoClient;

/// Why a node could not be booted or taken over.
struct BootFailure {
  char letter = 'J';         ///< CiA 302-2 error letter.
  std::string text;          ///< Object, expected, found.
  bool interrupted = false;  ///< Boot-up, loss, bus down or shutdown came in between: no verdict, no letter.
};

/// What is to be made of differences.
enum class SetupPurpose : std::uint8_t {
  configure,  ///< A node that is not operational: write what differs.
  inspect     ///< An operational node: only read; a difference is letter L.
};

/// An object that should have a value.
struct SetupItem {
  ObjectAddress object;
  DataType type = DataType::u32;
  Raw wanted = 0;
  std::string name;  ///< For people, as in "heartbeat time".
  SetupPolicy policy = SetupPolicy::write;
};

struct SetupOutcome {
  std::optional<BootFailure> failure;
  bool confirmed = false;  ///< The node showed this value; false where it has no such object or was not asked.
  bool written = false;
  bool absent = false;  ///< The node has no such object.
};

/// CiA 301 abort codes that mean: the node has no such object or sub-index.
[[nodiscard]] bool is_absent(const Error& error) noexcept;
/// `0x1017:00 heartbeat time: expected 500, found 0`.
[[nodiscard]] std::string difference_text(const SetupItem& item, Raw found);

/// The SDO transfers of one boot or takeover. Once the client was interrupted every further transfer fails, so that no
/// half-done procedure goes on with a node that rebooted in between.
class SetupSession {
 public:
  /// `sdo` outlives the session.
  SetupSession(SdoClient& sdo, SetupPurpose purpose);

  [[nodiscard]] bool inspecting() const noexcept { return purpose_ == SetupPurpose::inspect; }
  [[nodiscard]] bool interrupted() const noexcept;

  boost::asio::awaitable<Result<Raw>> read(ObjectAddress object, DataType type);
  boost::asio::awaitable<Result<void>> write(ObjectAddress object, DataType type, Raw raw);
  /// Reads, compares, writes if it differs and may be written, and reads back. An object that the node lacks is no
  /// failure, nor is one that can only be written: while inspecting nobody can tell, so it counts as it should be.
  boost::asio::awaitable<SetupOutcome> ensure(SetupItem item);

  /// The failure for an unsuccessful read or write. Letter B where the node has not answered a single request yet.
  [[nodiscard]] BootFailure failure(const Error& error, std::string_view name) const;
  /// The failure for a wrong value that is not to be corrected.
  [[nodiscard]] BootFailure difference(std::string text) const;

 private:
  boost::asio::awaitable<SetupOutcome> correct(SetupItem item, bool readable);

  SdoClient& sdo_;
  SetupPurpose purpose_;
  std::uint64_t begun_;
  bool answered_ = false;
};

}  // namespace canopen
