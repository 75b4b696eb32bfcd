#pragma once

#include <openssl/err.h>

#include <string>

#include "bridges/mqtt/tls_handshake.h"
#include "config/model.h"

namespace mqtt {

/// An error in OpenSSL's words; by default the first of this thread: it tells the cause, those behind it who met it.
[[nodiscard]] std::string openssl_text(unsigned long error = ERR_peek_error());

/// What is wrong with a certificate that the broker showed, and what mends it. `result`: X509_V_ERR_…; `depth`: 0 is
/// the broker's own certificate, those behind it are of authorities.
[[nodiscard]] std::string tls_text_of_certificate(long result, int depth, const config::Endpoint& broker,
                                                  const TlsFiles& files);

/// What the broker said of our certificate (RFC 8446 §6.2), or what is wrong with the protocol, by the newest error of
/// this thread. `how`: SSL_ERROR_….
[[nodiscard]] std::string tls_text_of_failure(int how, const TlsFiles& files);

}  // namespace mqtt
