#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <source_location>
#include <span>

#include "bridges/modbus/mbap.h"

// What an answer to a Modbus request looks like, whatever the request: MODBUS Application Protocol V1.1b3, sections 6
// and 7, CiA 309-2. Written without the server's own parser of requests.

namespace fuzz {

using Bytes = std::span<const std::uint8_t>;

inline void require(bool holds, std::source_location where = std::source_location::current()) {
  if (!holds) {
    std::fprintf(stderr, "%s:%u: does not hold\n", where.file_name(), where.line());
    std::abort();
  }
}

/// A request that could command a drive.
inline bool may_write(Bytes pdu) {
  constexpr std::array<std::uint8_t, 6> kWrites{5, 6, 15, 16, 22, 23};
  return std::ranges::find(kWrites, pdu[0]) != kWrites.end() || (pdu[0] == 43 && pdu.size() > 2 && pdu[2] != 0);
}

inline bool begins_alike(Bytes answer, Bytes request, std::size_t count) {
  return answer.size() >= count && request.size() >= count &&
         std::ranges::equal(answer.first(count), request.first(count));
}

/// 0x05 and 0x06 are never answered: clients repeat on them.
inline bool is_exception(Bytes request, Bytes answer) {
  constexpr std::array<std::uint8_t, 6> kCodes{0x01, 0x02, 0x03, 0x04, 0x0A, 0x0B};
  return answer.size() == 2 && answer[0] == (request[0] | 0x80) && std::ranges::find(kCodes, answer[1]) != kCodes.end();
}

inline bool is_bits(Bytes request, Bytes answer) {
  const std::size_t quantity = request.size() == 5 ? modbus::word_at(request, 3) : 0;
  const std::size_t bytes = (quantity + 7) / 8;
  // What is left of the last byte is 0.
  return quantity >= 1 && quantity <= 2000 && answer.size() == 2 + bytes && answer[1] == bytes &&
         (quantity % 8 == 0 || answer.back() >> (quantity % 8) == 0);
}

inline bool is_words(std::size_t quantity, Bytes answer) {
  return quantity >= 1 && quantity <= 125 && answer.size() == 2 + 2 * quantity && answer[1] == 2 * quantity;
}

inline bool is_echo(Bytes request, Bytes answer, std::size_t size) {
  return answer.size() == size && begins_alike(answer, request, size);
}

inline bool is_identification(Bytes request, Bytes answer) {
  if (request.size() != 4 || answer.size() < 7 || !begins_alike(answer, request, 3) || answer[3] != 0x83 ||
      (answer[4] != 0 && answer[4] != 0xFF) || (answer[4] == 0 && answer[5] != 0) || answer[6] == 0) {
    return false;
  }
  std::size_t at = 7;
  for (std::size_t i = 0; i < answer[6]; ++i) {
    if (at + 2 > answer.size() || at + 2 + answer[at + 1] > answer.size()) {
      return false;
    }
    at += std::size_t{2} + answer[at + 1];
  }
  return at == answer.size();
}

inline bool is_reference(Bytes request, Bytes answer) {
  constexpr std::array<std::uint8_t, 6> kAborted{0xAB, 0xFF, 0x00, 0x06, 0x0D, 0xEC};
  if (request.size() < 12) {
    return false;
  }
  if (answer.size() == 10 && std::ranges::equal(answer.first(6), kAborted)) {
    return true;
  }
  const bool writes = request[2] == 1;
  return begins_alike(answer, request, 10) && answer.size() >= 12 &&
         modbus::word_at(answer, 10) == answer.size() - 12 && (!writes || answer.size() == 12);
}

inline bool is_normal(Bytes request, Bytes answer) {
  if (answer[0] != request[0]) {
    return false;
  }
  switch (request[0]) {
    case 1:
    case 2:
      return is_bits(request, answer);
    case 3:
    case 4:
      return request.size() == 5 && is_words(modbus::word_at(request, 3), answer);
    case 5:
    case 6:
      return request.size() == 5 && is_echo(request, answer, 5);
    case 15:
    case 16:
      return request.size() >= 7 && is_echo(request, answer, 5);
    case 22:
      return request.size() == 7 && is_echo(request, answer, 7);
    case 23:
      return request.size() >= 12 && is_words(modbus::word_at(request, 3), answer);
    case 43:
      return request.size() >= 2 &&
             (request[1] == 14 ? is_identification(request, answer) : is_reference(request, answer));
    default:
      return false;
  }
}

/// Both are PDUs.
inline void check_answer(Bytes request, Bytes answer) {
  require(answer.size() >= 2 && answer.size() <= modbus::kMaxPdu);
  const bool abort = request[0] == 43 && answer[0] == 0xAB && answer.size() == 10;
  require(is_exception(request, answer) || (abort ? is_reference(request, answer) : is_normal(request, answer)));
}

}  // namespace fuzz
