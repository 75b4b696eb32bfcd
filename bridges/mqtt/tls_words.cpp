#include "bridges/mqtt/tls_words.h"

#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>

namespace mqtt {

std::string openssl_text(unsigned long error) {
  const char* const text = error == 0 ? nullptr : ERR_reason_error_string(error);
  return text == nullptr ? "unknown error" : text;
}

std::string tls_text_of_certificate(long result, int depth, const config::Endpoint& broker, const TlsFiles& files) {
  const std::string certificate =
      depth == 0 ? "TLS: the broker's certificate " : "TLS: the certificate of the broker's authority ";
  switch (result) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      if (depth != 0) {
        return certificate + "has expired; renew it, and take the new one " +
               (files.ca.empty() ? "at the broker and into this system" : "as ca_file") +
               " (or this machine's clock is wrong)";
      }
      return certificate + "has expired; renew it at the broker (or this machine's clock is wrong)";
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return certificate + "is not valid yet; set this machine's clock (or the certificate was made with a wrong one)";
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
      return certificate + "is not for " + broker.host +
             "; name the broker in `brokers` as its certificate does, or give it one for this name";
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_CERT_SIGNATURE_FAILURE:
      return std::string("TLS: the broker's certificate is not signed by an authority that ") +
             (files.ca.empty() ? "this system trusts; give the authority's certificate as ca_file"
                               : "ca_file names; take the certificate of the broker's authority");
    default:
      return certificate + "is refused: " + X509_verify_cert_error_string(result) +
             "; have it made anew, for a server and with a key of today's length";
  }
}

std::string tls_text_of_failure(int how, const TlsFiles& files) {
  const unsigned long error = ERR_peek_last_error();
  switch (ERR_GET_LIB(error) == ERR_LIB_SSL ? ERR_GET_REASON(error) : 0) {
    case SSL_R_TLSV13_ALERT_CERTIFICATE_REQUIRED:
    case SSL_R_SSLV3_ALERT_HANDSHAKE_FAILURE:
    case SSL_R_SSLV3_ALERT_BAD_CERTIFICATE:
    case SSL_R_SSLV3_ALERT_CERTIFICATE_EXPIRED:
    case SSL_R_SSLV3_ALERT_CERTIFICATE_REVOKED:
    case SSL_R_SSLV3_ALERT_CERTIFICATE_UNKNOWN:
    case SSL_R_SSLV3_ALERT_UNSUPPORTED_CERTIFICATE:
    case SSL_R_TLSV1_ALERT_UNKNOWN_CA:
    case SSL_R_TLSV1_ALERT_ACCESS_DENIED:
      return (files.cert.empty() ? "TLS: the broker wants a client certificate; give cert_file and key_file"
                                 : "TLS: the broker refuses the client certificate " + files.cert +
                                       "; have it signed by the authority that the broker trusts, or renew it") +
             std::string(" (") + openssl_text(error) + ")";
    case SSL_R_WRONG_VERSION_NUMBER:
    case SSL_R_HTTP_REQUEST:
    case SSL_R_PACKET_LENGTH_TOO_LONG:
      return "TLS: the port does not speak TLS; name the broker's TLS port (as a rule 8883), or use mqtt://";
    case SSL_R_TLSV1_ALERT_PROTOCOL_VERSION:
    case SSL_R_UNSUPPORTED_PROTOCOL:
    case SSL_R_NO_PROTOCOLS_AVAILABLE:
      return "TLS: the broker speaks none of TLS 1.2 and 1.3; let it use one of them";
    case SSL_R_UNEXPECTED_EOF_WHILE_READING:
      how = SSL_ERROR_SYSCALL;
      break;
    default:
      break;
  }
  if (how == SSL_ERROR_SYSCALL) {
    return "TLS: the connection is closed in the handshake; the broker may be starting, or this is not its TLS port "
           "(as a "
           "rule 8883)";
  }
  return "TLS: no handshake with the broker: " + openssl_text(error) +
         "; look at the broker's log, and at the versions and ciphers of TLS that it allows";
}

}  // namespace mqtt
