#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopen/error.h"
#include "canopen/object.h"
#include "canopen/sdo/block_download.h"
#include "canopen/sdo/block_upload.h"
#include "canopen/sdo/frames.h"
#include "canopen/sdo/sdo_settings.h"
#include "canopen/sdo/step.h"

namespace canopen {

/// One SDO upload or download as a state machine without time or bus: answers in, requests out.
/// An answer that belongs to something else changes nothing.
///
/// With SdoSettings::block what is longer than kBlockWorthFrom, or of no known length, goes by block transfer. A server
/// that refuses that, and not the object, is asked the usual way within the same transfer.
class SdoTransfer {
 public:
  /// Of `more` request() is the next request; of `failed` error() says why, and abort() may have a frame to be sent.
  using Step = SdoStep;

  /// `expected` is the length of the object's type in bytes, for devices that do not tell it; 0: not known.
  [[nodiscard]] static SdoTransfer upload(const SdoSettings& settings, ObjectAddress object, std::size_t expected);
  /// Of at least one byte.
  [[nodiscard]] static SdoTransfer download(const SdoSettings& settings, ObjectAddress object,
                                            std::span<const std::uint8_t> data);

  /// The request to be sent now.
  [[nodiscard]] const SdoFrame& request() const noexcept { return request_; }
  /// `late_possible`: an earlier request went unanswered. So until the server has accepted this one, an answer that
  /// does not fit, or an abort that names no object, may be the late one to that, and is ignored.
  Step on_answer(std::span<const std::uint8_t> answer, bool late_possible);
  /// request() has left. `ignored`: now an answer is due.
  Step on_departure();

  /// The server did not accept it yet, and is asked for block transfer.
  [[nodiscard]] bool asks_for_block() const noexcept { return phase_ == Phase::initiate && block_; }
  /// The server accepted it as a block transfer, however it ended.
  [[nodiscard]] bool block_accepted() const noexcept { return block_upload_ || block_download_; }
  /// It was to go by block transfer, and the server does not know that.
  [[nodiscard]] bool block_refused() const noexcept { return block_refused_; }
  /// Before the first request: not by block transfer.
  void use_segments();
  /// In the middle of a block transfer: the server may send at any time.
  [[nodiscard]] bool in_block() const noexcept { return phase_ == Phase::block; }
  /// request() makes the server, or us, send many frames at once; of how many frames the load is then.
  [[nodiscard]] bool begins_sub_block() const noexcept { return load() > 2; }
  /// How many frames come of request(), up to the next one of ours.
  [[nodiscard]] unsigned load() const noexcept;
  /// All is done but for the departure of request().
  [[nodiscard]] bool only_to_confirm() const noexcept { return block_upload_ && block_upload_->complete(); }

  [[nodiscard]] ObjectAddress object() const noexcept { return object_; }
  [[nodiscard]] bool is_upload() const noexcept { return direction_ == Direction::upload; }
  /// A write of one request and one answer.
  [[nodiscard]] bool is_expedited_download() const noexcept { return !is_upload() && data_.size() <= 4; }
  /// The device accepted the transfer and waits for segments, or sends them: given up, it must be aborted.
  [[nodiscard]] bool in_segments() const noexcept { return phase_ == Phase::segments || in_block(); }
  [[nodiscard]] const Error& error() const noexcept { return error_; }
  [[nodiscard]] const std::optional<SdoFrame>& abort() const noexcept { return abort_; }
  /// Data of a completed upload.
  [[nodiscard]] const std::vector<std::uint8_t>& data() const noexcept { return data_; }
  /// Something odd about a completed transfer that a person should know; empty if nothing was.
  [[nodiscard]] const std::string& remark() const noexcept { return remark_; }

  /// Longest upload taken; a longer one is aborted.
  static constexpr std::size_t kMaxBytes = 65'535;

 private:
  enum class Direction : std::uint8_t { upload, download };
  enum class Phase : std::uint8_t { initiate, segments, block, over };

  SdoTransfer(const SdoSettings& settings, ObjectAddress object, Direction direction, SdoFrame request)
      : settings_(settings), object_(object), direction_(direction), request_(request) {}

  Step on_abort(std::span<const std::uint8_t> answer, bool late_possible);
  Step on_initiate(std::span<const std::uint8_t> answer, bool late_possible);
  Step on_upload_accepted(std::span<const std::uint8_t> answer);
  Step on_download_accepted(std::span<const std::uint8_t> answer);
  Step on_block_accepted(std::span<const std::uint8_t> answer);
  Step on_block(std::span<const std::uint8_t> answer);
  Step take(SdoReaction reaction);
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
  /// Of the node, in segments: a bus may deliver a frame twice, at once (ISO 11898-1: where its last bit is disturbed).
  std::optional<SdoFrame> newest_;
  bool block_ = false;  ///< By block transfer, or wanted so.
  bool block_refused_ = false;
  std::optional<SdoBlockUpload> block_upload_;
  std::optional<SdoBlockDownload> block_download_;
  Error error_;
  std::optional<SdoFrame> abort_;
  std::string remark_;
};

}  // namespace canopen
