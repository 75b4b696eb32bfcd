#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "bridges/mqtt/exchange.h"
#include "config/model.h"

namespace mqtt {

/// In OpenSSL's words.
inline constexpr const char* kTlsCiphers = "DEFAULT:@SECLEVEL=2";

/// Files of TLS, in PEM, as paths; read anew at each connection.
struct TlsFiles {
  std::string ca{};    ///< Empty: the authorities that the system trusts.
  std::string cert{};  ///< Of the client, with its chain; empty: none is shown.
  std::string key{};   ///< Its private key.
};

/// OpenSSL frees nothing when the process ends: a handshake that somebody waits for no more may run still. Before
/// OpenSSL is used.
void keep_tls_until_the_end();

/// Why a connection with these files cannot be tried; empty: it can. Paho would ask the terminal for the password of a
/// key, and names no file.
[[nodiscard]] std::string tls_files_mistake(const TlsFiles& files);

/// Why TLS to this broker fails, and how to mend it, found by a handshake of our own, since Paho names no cause. Empty:
/// it does not fail, or not because of TLS. Tries the addresses, IPv4 before IPv6, until one accepts; blocks for
/// `patience`.
[[nodiscard]] std::string tls_mistake(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                                      const TlsFiles& files, std::chrono::milliseconds patience);

/// What the broker says to a question, at the same addresses.
[[nodiscard]] Answer ask_by_tls(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                                const TlsFiles& files, const Question& question, std::chrono::milliseconds patience);

}  // namespace mqtt
