#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopen/error.h"
#include "canopen/object.h"
#include "canopen/sdo/frames.h"
#include "canopen/sdo/sdo_settings.h"

namespace canopen {

/// One SDO upload or download as a state machine without time or bus: answers in, requests out.
/// An answer that belongs to something else changes nothing.
class SdoTransfer {
 public:
  /// What an answer meant.
  enum class Step : std::uint8_t {
    ignored,    ///< Not for this transfer.
    more,       ///< Accepted; request() is the next request.
    completed,  ///< Data confirmed or complete.
    failed      ///< error() says why; where abort() has a frame, it is to be sent.
  };

  /// `expected` is the length of the object's type in bytes, for devices that do not tell it; 0: not known.
  [[nodiscard]] static SdoTransfer upload(const SdoSettings& settings, ObjectAddress object, std::size_t expected);
  /// Of at least one byte.
  [[nodiscard]] static SdoTransfer download(const SdoSettings& settings, ObjectAddress object,
                                            std::span<const std::uint8_t> data);

  /// The request to be sent now.
  [[nodiscard]] const SdoFrame& request() const noexcept { return request_; }
  /// `late_possible`: an earlier request went unanswered, so an answer that does not fit, or an abort that names no
  /// object, may be the late one to that, and is ignored.
  Step on_answer(std::span<const std::uint8_t> answer, bool late_possible);

  [[nodiscard]] ObjectAddress object() const noexcept { return object_; }
  [[nodiscard]] bool is_upload() const noexcept { return direction_ == Direction::upload; }
  /// The device accepted the transfer and waits for segments: given up, it must be aborted.
  [[nodiscard]] bool in_segments() const noexcept { return phase_ == Phase::segments; }
  [[nodiscard]] const Error& error() const noexcept { return error_; }
  [[nodiscard]] const std::optional<SdoFrame>& abort() const noexcept { return abort_; }
  /// Data of a completed upload.
  [[nodiscard]] const std::vector<std::uint8_t>& data() const noexcept { return data_; }
  /// Something odd about a completed transfer that a person should know; empty if nothing was.
  [[nodiscard]] const std::string& remark() const noexcept { return remark_; }

  /// Longest upload taken; a longer one is aborted.
  static constexpr std::size_t kMaxBytes = 4096;

 private:
  enum class Direction : std::uint8_t { upload, download };
  enum class Phase : std::uint8_t { initiate, segments, over };

  SdoTransfer(const SdoSettings& settings, ObjectAddress object, Direction direction, SdoFrame request)
      : settings_(settings), object_(object), direction_(direction), request_(request) {}

  Step on_abort(std::span<const std::uint8_t> answer, bool late_possible);
  Step on_initiate(std::span<const std::uint8_t> answer, bool late_possible);
  Step on_upload_accepted(std::span<const std::uint8_t> answer);
  Step on_download_accepted(std::span<const std::uint8_t> answer);
  Step on_segment(std::span<const std::uint8_t> answer);
  Step on_upload_segment(std::span<const std::uint8_t> answer);
  Step next_download_segment();
  Step complete();
  Step fail(std::string why, std::uint32_t abort_code = 0);

  SdoSettings settings_;
  ObjectAddress object_;
  Direction direction_;
  Phase phase_ = Phase::initiate;
  std::size_t expected_ = 0;
  SdoFrame request_;
  std::vector<std::uint8_t> data_;
  std::size_t sent_ = 0;  ///< Bytes of a segmented download.
  bool toggle_ = false;
  Error error_;
  std::optional<SdoFrame> abort_;
  std::string remark_;
};

}  // namespace canopen
