#pragma once

#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/frame.h"
#include "tests/support/block_server.h"

/// Frames as hexadecimal text, as they stand in the protocol figures of CiA 301 §7.2.4.3.
namespace block_server_bench {

inline std::vector<std::uint8_t> bytes_of(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  for (; text.size() >= 2; text.remove_prefix(text.size() > 2 ? 3 : 2)) {
    std::uint8_t byte = 0;
    EXPECT_EQ(std::from_chars(text.data(), text.data() + 2, byte, 16).ptr, text.data() + 2) << text;
    bytes.push_back(byte);
  }
  return bytes;
}

inline std::string text_of(const canopen::Frame& frame) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (const std::uint8_t byte : frame.bytes()) {
    text += text.empty() ? "" : " ";
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xFU];
  }
  return text;
}

/// What node 5 answers to this request.
inline std::vector<std::string> say(support::BlockServer& server, std::string_view request) {
  std::vector<std::string> answers;
  for (const canopen::Frame& frame : server.answer(canopen::make_frame(0x605, bytes_of(request)))) {
    EXPECT_EQ(frame.id, 0x585U);
    EXPECT_FALSE(frame.extended || frame.remote || frame.error);
    answers.push_back(text_of(frame));
  }
  return answers;
}

using Answers = std::vector<std::string>;
inline const Answers kNoAnswer;

/// The objects of the cases.
inline constexpr canopen::ObjectAddress kObject{0x2000, 1};

inline std::vector<std::uint8_t> counting(std::uint8_t size) {
  std::vector<std::uint8_t> bytes;
  for (std::uint8_t i = 0; i < size; ++i) {
    bytes.push_back(i);
  }
  return bytes;
}

inline std::vector<std::uint8_t> letters(std::string_view text) {
  return {text.begin(), text.end()};
}

}  // namespace block_server_bench
