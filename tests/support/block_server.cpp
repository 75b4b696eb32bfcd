#include "tests/support/block_server.h"

#include <algorithm>

namespace support {

using block::abort_transfer;
using block::field;
using block::multiplexer;
using canopen::ObjectAddress;

namespace {

/// Counts down to the frame a fault is for.
bool due(std::size_t& frames) {
  if (frames == 0) {
    return true;
  }
  --frames;
  return false;
}

}  // namespace

std::vector<canopen::Frame> BlockServer::answer(const canopen::Frame& request) {
  if (request.id != 0x600U + node_ || request.extended || request.remote || request.error || request.size != 8) {
    return {};
  }
  downloaded_.reset();
  std::vector<canopen::Frame> frames = sent(reaction(request.data));
  if (downloaded_) {
    objects[downloaded_->first] = std::move(downloaded_->second);
  }
  return frames;
}

BlockServer::Contents BlockServer::reaction(const Content& request) {
  if (request[0] == block::kAbortCommand) {
    aborts_heard_.push_back({multiplexer(request), block::get_u32(request, 4)});
    transfer_ = std::monostate();
    return {};
  }
  // In a sub-block the first byte is a sequence number and no command, whatever else it could be (§7.2.4.3.10).
  if (auto* receiver = std::get_if<block::BlockReceiver>(&transfer_); receiver != nullptr && receiver->in_sub_block()) {
    return block_segment(*receiver, request);
  }
  switch (block::specifier(request)) {
    case 0:
      return download_segment(request);
    case 1:
      return initiate_download(request);
    case 2:
      return initiate_upload(request);
    case 3:
      return upload_segment(request);
    case 5:
      return block_upload(request);
    case 6:
      return field(request, 0, 1) == 0 ? initiate_block_download(request) : end_block_download(request);
    default:
      return abort(block::kCommandSpecifier);
  }
}

std::optional<std::uint32_t> BlockServer::refusal(ObjectAddress object) const {
  if (const auto found = refused.find(object); found != refused.end()) {
    return found->second;
  }
  if (objects.contains(object)) {
    return std::nullopt;
  }
  const auto same_index = [&](const auto& entry) { return entry.first.index == object.index; };
  return std::ranges::any_of(objects, same_index) ? block::kNoSubIndex : block::kNoObject;
}

std::optional<std::uint32_t> BlockServer::length_refusal(ObjectAddress object, std::size_t size) const {
  const std::size_t length = objects.at(object).size();
  if (!fixed_lengths.contains(object) || size == length) {
    return std::nullopt;
  }
  return size > length ? block::kLengthTooHigh : block::kLengthTooLow;
}

BlockServer::Contents BlockServer::finish_download(ObjectAddress object, std::optional<std::uint32_t> size, Bytes data,
                                                   const Content& confirmation) {
  if (size && *size != data.size()) {
    return abort(object, block::kLength);
  }
  if (const auto code = length_refusal(object, data.size())) {
    return abort(object, *code);
  }
  downloaded_.emplace(object, std::move(data));
  transfer_ = std::monostate();
  return {confirmation};
}

std::uint32_t BlockServer::indicated_size(const Bytes& data) const {
  return faults.indicated_size.value_or(static_cast<std::uint32_t>(data.size()));
}

ObjectAddress BlockServer::object_of_transfer() const {
  const auto object_of = [](const auto& transfer) -> ObjectAddress {
    if constexpr (requires { transfer.object(); }) {
      return transfer.object();
    } else if constexpr (requires { transfer.object; }) {
      return transfer.object;
    } else {
      return {};
    }
  };
  return std::visit(object_of, transfer_);
}

BlockServer::Contents BlockServer::abort(std::uint32_t code) {
  return abort(object_of_transfer(), code);
}

BlockServer::Contents BlockServer::abort(ObjectAddress object, std::uint32_t code) {
  transfer_ = std::monostate();
  return {abort_transfer({object, code})};
}

std::vector<canopen::Frame> BlockServer::sent(const Contents& contents) {
  std::vector<canopen::Frame> frames;
  const auto send = [&](const Content& content) { frames.push_back(canopen::make_frame(0x580U + node_, content)); };
  for (const Content& content : contents) {
    if (faults.frames_until_silence && due(*faults.frames_until_silence)) {
      continue;
    }
    if (faults.foreign_abort && due(faults.foreign_abort->after_frames)) {
      send(abort_transfer(faults.foreign_abort->abort));
      faults.foreign_abort.reset();
    }
    if (faults.abort && due(faults.abort->after_frames)) {
      const ObjectAddress object = downloaded_ ? downloaded_->first : object_of_transfer();
      send(abort_transfer({object, faults.abort->code}));
      faults.abort.reset();
      downloaded_.reset();
      transfer_ = std::monostate();
      break;
    }
    send(content);
  }
  return frames;
}

}  // namespace support
