// The block download and the block upload (CiA 301 §7.2.4.3.8 to 15).
#include <algorithm>

#include "tests/support/block_server.h"

namespace support {

using block::command;
using block::field;
using block::multiplexer;
using block::zero_from;
using canopen::ObjectAddress;

namespace {

/// Whether a fault is for this place. It happens once.
bool taken(std::optional<block::Place>& fault, block::Place place) {
  if (fault != place) {
    return false;
  }
  fault.reset();
  return true;
}

bool valid_block_size(std::uint8_t size) {
  return size >= 1 && size <= block::kMaxBlockSize;
}

}  // namespace

BlockServer::Contents BlockServer::initiate_block_download(const Content& request) {
  const ObjectAddress object = multiplexer(request);
  transfer_ = std::monostate();
  const bool size_indicated = field(request, 1, 1) != 0;
  if (faults.refuse_block || field(request, 3, 2) != 0 || (!size_indicated && !zero_from(request, 4))) {
    return abort(object, block::kCommandSpecifier);
  }
  if (const auto code = refusal(object)) {
    return abort(object, *code);
  }
  std::optional<std::uint32_t> size;
  if (size_indicated) {
    size = block::get_u32(request, 4);
    if (const auto code = length_refusal(object, *size)) {
      return abort(object, *code);
    }
  }
  const bool crc = field(request, 2, 1) != 0 && faults.crc_supported;
  transfer_ = block::BlockReceiver(object, size, crc, block_size(1));
  Content content = command(faults.crc_supported ? 0xA4 : 0xA0, object);
  content[4] = block_size(1);
  return {content};
}

std::uint8_t BlockServer::block_size(unsigned sub_block) const {
  return faults.block_sizes.at(std::min<std::size_t>(sub_block, faults.block_sizes.size()) - 1);
}

BlockServer::Contents BlockServer::block_segment(block::BlockReceiver& receiver, const Content& segment) {
  const block::Place place = receiver.place(segment);
  if (taken(faults.lose, place)) {
    return {};
  }
  if (taken(faults.abort_on, place)) {
    return abort(block::kGeneral);
  }
  switch (receiver.take(segment)) {
    case block::BlockReceiver::Progress::more:
      return {};
    case block::BlockReceiver::Progress::gap:
      if (!faults.acknowledge_at_gap) {
        return {};
      }
      receiver.skip_to_first();
      return acknowledge(receiver);
    case block::BlockReceiver::Progress::sub_block_over:
      return acknowledge(receiver);
    case block::BlockReceiver::Progress::bad_sequence_number:
      break;
  }
  return abort(block::kSequenceNumber);
}

BlockServer::Contents BlockServer::acknowledge(block::BlockReceiver& receiver) {
  Content content = command(0xA2);
  content[1] = receiver.ackseq();
  if (faults.acknowledge) {
    content[1] = *faults.acknowledge;
    receiver.discard_after(*faults.acknowledge);
    faults.acknowledge.reset();
  }
  content[2] = block_size(receiver.sub_block() + 1);
  receiver.next(content[2]);
  return {content};
}

BlockServer::Contents BlockServer::end_block_download(const Content& request) {
  const auto* receiver = std::get_if<block::BlockReceiver>(&transfer_);
  if (receiver == nullptr || field(request, 1, 1) != 0 || !zero_from(request, 3) ||
      (!receiver->crc() && block::get_u16(request, 1) != 0)) {
    return abort(block::kCommandSpecifier);
  }
  Bytes data = receiver->data(field(request, 2, 3));
  if (receiver->crc() && (faults.wrong_crc || block::get_u16(request, 1) != block::crc16(data))) {
    return abort(block::kCrc);
  }
  return finish_download(receiver->object(), receiver->size(), std::move(data), command(0xA1));
}

BlockServer::Contents BlockServer::block_upload(const Content& request) {
  const std::uint8_t subcommand = field(request, 0, 2);
  if (subcommand == 0) {
    return initiate_block_upload(request);
  }
  auto* sender = std::get_if<block::BlockSender>(&transfer_);
  if (sender == nullptr || field(request, 2, 3) != 0) {
    return abort(block::kCommandSpecifier);
  }
  using Phase = block::BlockSender::Phase;
  if (subcommand == 3 && sender->phase() == Phase::start && zero_from(request, 1)) {
    return sub_block(*sender);
  }
  if (subcommand == 2 && sender->phase() == Phase::acknowledge && zero_from(request, 3)) {
    return block_acknowledged(*sender, request);
  }
  if (subcommand == 1 && sender->phase() == Phase::end && zero_from(request, 1)) {
    transfer_ = std::monostate();
    return {};
  }
  return abort(block::kCommandSpecifier);
}

BlockServer::Contents BlockServer::initiate_block_upload(const Content& request) {
  const ObjectAddress object = multiplexer(request);
  transfer_ = std::monostate();
  if (faults.refuse_block || field(request, 3, 2) != 0 || !zero_from(request, 6)) {
    return abort(object, block::kCommandSpecifier);
  }
  if (const auto code = refusal(object)) {
    return abort(object, *code);
  }
  if (!valid_block_size(request[4])) {
    return abort(object, block::kBlockSize);
  }
  const Bytes& data = objects.at(object);
  const std::uint8_t threshold = request[5];
  const bool allowed = threshold > 0 && data.size() <= threshold;
  if (faults.protocol_switch == block::ProtocolSwitch::always ||
      (faults.protocol_switch == block::ProtocolSwitch::where_allowed && allowed)) {
    return upload(object);
  }
  Content content = command(0xC0U | (faults.crc_supported ? 4U : 0U) | (faults.size_indicated ? 2U : 0U), object);
  if (faults.size_indicated) {
    block::put_u32(content, 4, indicated_size(data));
  }
  const bool crc = field(request, 2, 1) != 0 && faults.crc_supported;
  transfer_ = block::BlockSender(object, data, crc, request[4]);
  return {content};
}

BlockServer::Contents BlockServer::block_acknowledged(block::BlockSender& sender, const Content& request) {
  if (!valid_block_size(request[2])) {
    return abort(block::kBlockSize);
  }
  if (!sender.acknowledge(request[1], request[2])) {
    return abort(block::kSequenceNumber);
  }
  if (!sender.all_acknowledged()) {
    return sub_block(sender);
  }
  Content content = sender.end();
  if (faults.wrong_n) {
    content[0] = static_cast<std::uint8_t>(0xC1U | (*faults.wrong_n & 7U) << 2U);
  }
  if (faults.wrong_crc) {
    block::put_u16(content, 1, block::get_u16(content, 1) ^ 0xFFFFU);
  }
  return {content};
}

BlockServer::Contents BlockServer::sub_block(block::BlockSender& sender) {
  Contents contents;
  for (const Content& segment : sender.next_sub_block()) {
    const block::Place place = sender.place(segment);
    if (taken(faults.lose, place)) {
      continue;
    }
    contents.push_back(segment);
    if (taken(faults.send_twice, place)) {
      contents.push_back(segment);
    }
  }
  return contents;
}

}  // namespace support
