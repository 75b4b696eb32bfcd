#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "canopen/object.h"
#include "tests/support/block_codec.h"

namespace support::block {

/// A segment of a block transfer. Sub-blocks count from 1 in each transfer, and one that repeats segments counts too.
struct Place {
  unsigned sub_block = 1;
  std::uint8_t seqno = 1;  ///< 1..127.
  friend bool operator==(const Place&, const Place&) = default;
};

/// Whether a block upload is answered by the upload protocol (CiA 301 §7.2.4.3.13). The standard says that a server
/// may, where the client gives a threshold that the data do not exceed.
enum class ProtocolSwitch : std::uint8_t { never, where_allowed, always };

/// An abort in the place of the server's next frame but `after_frames`.
struct AbortFault {
  std::size_t after_frames = 0;
  std::uint32_t code = kGeneral;
};

/// An abort that names an object nobody asked for, before the server's next frame but `after_frames`.
struct ForeignAbort {
  std::size_t after_frames = 0;
  Abort abort;
};

/// What a test asks the server to do otherwise than the standard, or as the standard leaves open. Faults that happen
/// once are gone from their field when they have happened.
struct Faults {
  // Once.
  std::optional<Place> lose;        ///< This segment is lost on the wire, in an upload as in a download.
  std::optional<Place> send_twice;  ///< This segment of an upload is sent twice, one after the other.
  std::optional<Place> abort_on;    ///< This segment of a download is answered by an abort, code kGeneral.
  /// The ackseq of the next acknowledgement in a download. Segments that came after it are discarded; where it is
  /// higher than the number of the last one that came, it is said all the same.
  std::optional<std::uint8_t> acknowledge;
  std::optional<AbortFault> abort;
  std::optional<ForeignAbort> foreign_abort;

  // Until the test takes them back.
  /// So many frames are sent, then none. Requests go on to have their effect.
  std::optional<std::size_t> frames_until_silence;
  /// The blksize of the first, second, … sub-block of a download; the last one stays. Not empty; a right one is 1..127.
  std::vector<std::uint8_t> block_sizes{kMaxBlockSize};
  /// A gap in a sub-block of a download is acknowledged at once, and what comes until the next segment 1 is ignored.
  /// The standard does not say when; else it is at the end of the sub-block.
  bool acknowledge_at_gap = false;
  bool crc_supported = true;
  bool wrong_crc = false;               ///< An upload ends with a wrong CRC; that of a download is held to be wrong.
  std::optional<std::uint8_t> wrong_n;  ///< 0..7: the n at the end of a block upload.
  bool size_indicated = true;           ///< In uploads, segmented and block.
  std::optional<std::uint32_t> indicated_size;  ///< The size said there, instead of the true one.
  bool refuse_block = false;                    ///< Both block initiates are unknown command specifiers.
  ProtocolSwitch protocol_switch = ProtocolSwitch::never;
};

}  // namespace support::block
