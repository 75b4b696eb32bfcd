#include "bridges/mqtt/tls_handshake.h"

#include <fcntl.h>
#include <netdb.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>
#include <openssl/x509v3.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <utility>

namespace mqtt {
namespace {

using Clock = std::chrono::steady_clock;
using Context = std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)>;
using Handshake = std::unique_ptr<SSL, decltype(&SSL_free)>;

// With TLS 1.3 a broker refuses a certificate when the client takes the handshake for done (RFC 8446 §4.4.2.4).
constexpr std::chrono::milliseconds kAlertPatience{1000};

struct Socket {
  explicit Socket(int opened) : descriptor(opened) {}
  ~Socket() {
    if (descriptor >= 0) {
      close(descriptor);
    }
  }
  Socket(Socket&& other) noexcept : descriptor(std::exchange(other.descriptor, -1)) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  Socket& operator=(Socket&&) = delete;
  int descriptor;
};

// The newest error of this thread, in OpenSSL's words.
std::string openssl_text() {
  const unsigned long error = ERR_peek_last_error();
  const char* const text = error == 0 ? nullptr : ERR_reason_error_string(error);
  return text == nullptr ? "unknown error" : text;
}

// Nobody is asked at a terminal. Notes that one would have to be.
int no_password(char* /*buffer*/, int /*size*/, int /*writes*/, void* asked) {
  *static_cast<bool*>(asked) = true;
  return -1;
}

std::string load_own(SSL_CTX& context, const TlsFiles& files) {
  bool has_password = false;
  SSL_CTX_set_default_passwd_cb(&context, no_password);
  SSL_CTX_set_default_passwd_cb_userdata(&context, &has_password);
  if (SSL_CTX_use_certificate_chain_file(&context, files.cert.c_str()) != 1) {
    return "cert_file " + files.cert + " cannot be used: " + openssl_text() + "; it must be a PEM certificate";
  }
  const bool used = SSL_CTX_use_PrivateKey_file(&context, files.key.c_str(), SSL_FILETYPE_PEM) == 1;
  if (!used) {
    return "key_file " + files.key + " cannot be used: " +
           (has_password ? "it is protected by a password; store it without one, readable for the gateway alone"
                         : openssl_text() + "; it must be the PEM key of cert_file");
  }
  return {};
}

// What is wrong with the files; empty: nothing.
std::string load(SSL_CTX& context, const TlsFiles& files) {
  ERR_clear_error();
  const int trusted = files.ca.empty() ? SSL_CTX_set_default_verify_paths(&context)
                                       : SSL_CTX_load_verify_locations(&context, files.ca.c_str(), nullptr);
  if (trusted != 1) {
    return "ca_file " + files.ca + " cannot be used: " + openssl_text() + "; it must hold PEM certificates";
  }
  return files.cert.empty() ? std::string() : load_own(context, files);
}

Context make_context() {
  Context context(SSL_CTX_new(TLS_client_method()), &SSL_CTX_free);
  if (context) {
    SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
    SSL_CTX_set_cipher_list(context.get(), kTlsCiphers);
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
  }
  return context;
}

bool wait_for(int descriptor, short events, Clock::time_point end) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
  pollfd wait{descriptor, events, 0};
  return left > 0 && poll(&wait, 1, static_cast<int>(left)) > 0;
}

// A connection to the first address that accepts; negative: none does.
Socket connect_to(const std::vector<std::string>& addresses, std::uint16_t port, Clock::time_point end) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  for (const std::string& address : addresses) {
    addrinfo* found = nullptr;
    if (getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
      continue;
    }
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> list(found, &freeaddrinfo);
    Socket made(socket(list->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (made.descriptor < 0) {
      continue;
    }
    int failed = connect(made.descriptor, list->ai_addr, list->ai_addrlen) == 0 ? 0 : errno;
    socklen_t size = sizeof(failed);
    if (failed == EINPROGRESS && wait_for(made.descriptor, POLLOUT, end)) {
      getsockopt(made.descriptor, SOL_SOCKET, SO_ERROR, &failed, &size);
    }
    if (failed == 0) {
      return made;
    }
  }
  return Socket(-1);
}

// The name that the certificate must be for, which is told to the broker too (SNI, RFC 6066 §3: no address is).
bool name_host(SSL& session, const std::string& host) {
  if (X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(&session), host.c_str()) == 1) {
    return true;
  }
  ERR_clear_error();
  return SSL_set1_host(&session, host.c_str()) == 1 &&
         SSL_ctrl(&session, SSL_CTRL_SET_TLSEXT_HOSTNAME, TLSEXT_NAMETYPE_host_name,
                  const_cast<char*>(host.c_str())) == 1;  // NOLINT(cppcoreguidelines-pro-type-const-cast): its macro's
}

std::string text_of_certificate(long result, const config::Endpoint& broker, const TlsFiles& files) {
  const std::string certificate = "TLS: the broker's certificate ";
  switch (result) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
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
      return certificate + "is not signed by an authority that " +
             (files.ca.empty() ? "this system trusts; give the authority's certificate as ca_file"
                               : "ca_file names; take the certificate of the broker's authority");
    default:
      return certificate + "is refused: " + X509_verify_cert_error_string(result);
  }
}

// What the broker said of ours (RFC 8446 §6.2), or of the protocol.
std::string text_of_failure(int how, const TlsFiles& files) {
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
             std::string(" (") + openssl_text() + ")";
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
    return "TLS: the connection is closed in the handshake; name the broker's TLS port (as a rule 8883), or use "
           "mqtt://";
  }
  return "TLS: no handshake with the broker: " + openssl_text();
}

// What the handshake, and then what the broker says to it, comes to: SSL_ERROR_…; of the time-out SSL_ERROR_WANT_READ.
template <class Step>
int carry_out(SSL& session, int descriptor, Clock::time_point end, Step step) {
  for (;;) {
    ERR_clear_error();
    const int result = step();
    if (result > 0) {
      return SSL_ERROR_NONE;
    }
    const int error = SSL_get_error(&session, result);
    if (error != SSL_ERROR_WANT_READ && error != SSL_ERROR_WANT_WRITE) {
      return error;
    }
    if (!wait_for(descriptor, error == SSL_ERROR_WANT_READ ? POLLIN : POLLOUT, end)) {
      return SSL_ERROR_WANT_READ;
    }
  }
}

}  // namespace

std::string tls_files_mistake(const TlsFiles& files) {
  const Context context = make_context();
  return context ? load(*context, files) : "TLS cannot be used: " + openssl_text();
}

std::string tls_mistake(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                        const TlsFiles& files, std::chrono::milliseconds patience) {
  const Clock::time_point end = Clock::now() + patience;
  const Context context = make_context();
  if (!context || !load(*context, files).empty()) {
    return tls_files_mistake(files);
  }
  const Socket connected = connect_to(addresses, broker.port, end);
  const Handshake session(SSL_new(context.get()), &SSL_free);
  if (connected.descriptor < 0 || !session || !name_host(*session, broker.host) ||
      SSL_set_fd(session.get(), connected.descriptor) != 1) {
    return {};
  }
  int how = carry_out(*session, connected.descriptor, end, [&] { return SSL_connect(session.get()); });
  if (how == SSL_ERROR_NONE) {
    char byte = 0;
    how = carry_out(*session, connected.descriptor, std::min(end, Clock::now() + kAlertPatience),
                    [&] { return SSL_read(session.get(), &byte, 1); });
    // A broker that waits for the CONNECT has nothing against us; one that closes without a word says nothing of TLS.
    return how == SSL_ERROR_SSL ? text_of_failure(how, files) : std::string();
  }
  if (how == SSL_ERROR_WANT_READ) {
    return "TLS: the broker does not answer the handshake; name its TLS port (as a rule 8883), or use mqtt://";
  }
  const long certificate = SSL_get_verify_result(session.get());
  return certificate != X509_V_OK ? text_of_certificate(certificate, broker, files) : text_of_failure(how, files);
}

}  // namespace mqtt
