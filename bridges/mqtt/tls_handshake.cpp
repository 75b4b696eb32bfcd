#include "bridges/mqtt/tls_handshake.h"

#include <fcntl.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>
#include <openssl/x509v3.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <system_error>

#include "bridges/mqtt/tcp_connection.h"
#include "bridges/mqtt/tls_words.h"

namespace mqtt {
namespace {

using Clock = std::chrono::steady_clock;
using Context = std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)>;
using Handshake = std::unique_ptr<SSL, decltype(&SSL_free)>;

// Why it cannot be opened, in the system's words, which OpenSSL does not have; empty: it can.
std::string mistake_of_opening(const char* key, const std::string& path) {
  const int opened = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (opened < 0) {
    return std::string(key) + " " + path + " cannot be read: " + std::generic_category().message(errno) +
           "; it must be there, readable for the gateway's user";
  }
  close(opened);
  return {};
}

// Nobody is asked at a terminal. Notes that one would have to be.
int no_password(char* /*buffer*/, int /*size*/, int /*writes*/, void* asked) {
  *static_cast<bool*>(asked) = true;
  return -1;
}

std::string load_own(SSL_CTX& context, const TlsFiles& files) {
  std::string mistake = mistake_of_opening("cert_file", files.cert);
  mistake = mistake.empty() ? mistake_of_opening("key_file", files.key) : mistake;
  if (!mistake.empty()) {
    return mistake;
  }
  bool has_password = false;
  ERR_clear_error();
  SSL_CTX_set_default_passwd_cb(&context, no_password);
  SSL_CTX_set_default_passwd_cb_userdata(&context, &has_password);
  if (SSL_CTX_use_certificate_chain_file(&context, files.cert.c_str()) != 1) {
    return "cert_file " + files.cert + " cannot be used: " + openssl_text() + "; it must be a PEM certificate";
  }
  ERR_clear_error();
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
  if (std::string mistake = files.ca.empty() ? std::string() : mistake_of_opening("ca_file", files.ca);
      !mistake.empty()) {
    return mistake;
  }
  ERR_clear_error();
  const int trusted = files.ca.empty() ? SSL_CTX_set_default_verify_paths(&context)
                                       : SSL_CTX_load_verify_locations(&context, files.ca.c_str(), nullptr);
  if (trusted != 1) {
    return "ca_file " + files.ca + " cannot be used: " + openssl_text() + "; it must hold PEM certificates";
  }
  return files.cert.empty() ? std::string() : load_own(context, files);
}

// How far from the broker's own certificate the one lies that was refused.
int note_depth(int good, X509_STORE_CTX* chain) {
  if (good == 0) {
    auto* const session = static_cast<SSL*>(X509_STORE_CTX_get_ex_data(chain, SSL_get_ex_data_X509_STORE_CTX_idx()));
    *static_cast<int*>(SSL_get_ex_data(session, 0)) = X509_STORE_CTX_get_error_depth(chain);
  }
  return good;
}

Context make_context() {
  Context context(SSL_CTX_new(TLS_client_method()), &SSL_CTX_free);
  if (context) {
    SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
    SSL_CTX_set_cipher_list(context.get(), kTlsCiphers);
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, &note_depth);
  }
  return context;
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

// What the handshake, and then what the broker says to it, comes to: SSL_ERROR_…; of the time-out SSL_ERROR_WANT_READ.
template <class Step>
int carry_out(SSL& session, const TcpConnection& connection, Clock::time_point end, Step step) {
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
    if (!wait_for(connection, error == SSL_ERROR_WANT_READ ? POLLIN : POLLOUT, end)) {
      return SSL_ERROR_WANT_READ;
    }
  }
}

// Shakes hands, and then talks: what comes of that as carry_out() tells. Returns why it failed, where TLS is the
// reason.
template <class Talk>
std::string try_tls(const config::Endpoint& broker, const std::vector<std::string>& addresses, const TlsFiles& files,
                    std::chrono::milliseconds patience, Talk talk) {
  const Context context = make_context();
  if (!context || !load(*context, files).empty()) {
    return tls_files_mistake(files);
  }
  const Clock::time_point end = Clock::now() + patience;  // the system's authorities take a while to read
  const TcpConnection connected = connect_to(addresses, broker.port, end);
  const Handshake session(SSL_new(context.get()), &SSL_free);
  if (connected.descriptor < 0 || !session || !name_host(*session, broker.host) ||
      SSL_set_fd(session.get(), connected.descriptor) != 1) {
    return {};
  }
  int depth = 0;
  if (SSL_set_ex_data(session.get(), 0, &depth) != 1) {
    return {};
  }
  int how = carry_out(*session, connected, end, [&] { return SSL_connect(session.get()); });
  if (how == SSL_ERROR_NONE) {
    // With TLS 1.3 a broker refuses a certificate when the client takes the handshake for done (RFC 8446 §4.4.2.4).
    how = talk(*session, connected, end);
    // A broker that waits for the CONNECT has nothing against us; one that closes without a word says nothing of TLS.
    return how == SSL_ERROR_SSL ? tls_text_of_failure(how, files) : std::string();
  }
  if (how == SSL_ERROR_WANT_READ) {
    return "TLS: the broker does not answer the handshake; it may hang or be starting, or this is not its TLS port (as "
           "a "
           "rule 8883)";
  }
  const long certificate = SSL_get_verify_result(session.get());
  return certificate != X509_V_OK ? tls_text_of_certificate(certificate, depth, broker, files)
                                  : tls_text_of_failure(how, files);
}

}  // namespace

void keep_tls_until_the_end() {
  (void)OPENSSL_init_crypto(OPENSSL_INIT_NO_ATEXIT, nullptr);
}

std::string tls_files_mistake(const TlsFiles& files) {
  const Context context = make_context();
  return context ? load(*context, files) : "TLS cannot be used: " + openssl_text();
}

std::string tls_mistake(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                        const TlsFiles& files, std::chrono::milliseconds patience) {
  // One that is slow has all the time that is left.
  return try_tls(broker, addresses, files, patience, [](SSL& session, const TcpConnection& to, Clock::time_point end) {
    char byte = 0;
    return carry_out(session, to, end, [&] { return SSL_read(&session, &byte, 1); });
  });
}

Answer ask_by_tls(const config::Endpoint& broker, const std::vector<std::string>& addresses, const TlsFiles& files,
                  const Question& question, std::chrono::milliseconds patience) {
  Answer answer;
  const auto say = [](SSL& session, const TcpConnection& to, Clock::time_point end, const std::string& words) {
    return carry_out(session, to, end,
                     [&] { return SSL_write(&session, words.data(), static_cast<int>(words.size())); });
  };
  answer.mistake =
      try_tls(broker, addresses, files, patience, [&](SSL& session, const TcpConnection& to, Clock::time_point end) {
        SSL_set_options(&session, SSL_OP_IGNORE_UNEXPECTED_EOF);  // to close without a word is an answer here
        int how = say(session, to, end, question.words);
        while (how == SSL_ERROR_NONE && answer.words.size() < question.answer) {
          char byte = 0;
          how = carry_out(session, to, end, [&] { return SSL_read(&session, &byte, 1); });
          answer.words.append(how == SSL_ERROR_NONE ? 1U : 0U, byte);
        }
        answer.closed = how != SSL_ERROR_NONE && how != SSL_ERROR_WANT_READ;
        if (how == SSL_ERROR_NONE && !question.goodbye.empty()) {
          (void)say(session, to, end, question.goodbye);
        }
        return how;
      });
  answer.closed = answer.closed && answer.mistake.empty();
  return answer;
}

}  // namespace mqtt
