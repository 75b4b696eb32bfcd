#pragma once

#include <cstddef>
#include <string>

namespace mqtt {

/// A few bytes that are said to a broker.
struct Question {
  std::string words{};
  std::size_t answer = 1;  ///< So many bytes are awaited.
  std::string goodbye{};   ///< Said when they are there.
};

/// What came of it.
struct Answer {
  std::string words{};
  bool closed = false;    ///< By the broker, before all of them were there.
  std::string mistake{};  ///< Where TLS is the reason.
};

}  // namespace mqtt
