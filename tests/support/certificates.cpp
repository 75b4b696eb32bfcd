#include "tests/support/certificates.h"

#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <atomic>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace support {
namespace {

using Key = std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)>;
using Made = std::unique_ptr<X509, void (*)(X509*)>;

void require(bool done, const char* what) {
  if (!done) {
    throw std::runtime_error(std::string("OpenSSL does not ") + what);
  }
}

Key make_key() {
  Key key(EVP_EC_gen("P-256"), &EVP_PKEY_free);
  require(key != nullptr, "make a key");
  return key;
}

void extend(X509& certificate, X509* issuer, int kind, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, &certificate, nullptr, nullptr, 0);
  const std::unique_ptr<X509_EXTENSION, void (*)(X509_EXTENSION*)> extension(
      X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()), &X509_EXTENSION_free);
  require(extension && X509_add_ext(&certificate, extension.get(), -1) == 1, "take an extension");
}

Made make_certificate(EVP_PKEY& key, const std::string& name, std::chrono::seconds from, std::chrono::seconds until) {
  static std::atomic<long> serial{1};
  Made made(X509_new(), &X509_free);
  require(made && X509_set_version(made.get(), 2) == 1 &&
              ASN1_INTEGER_set(X509_get_serialNumber(made.get()), serial++) == 1 &&
              X509_gmtime_adj(X509_getm_notBefore(made.get()), from.count()) != nullptr &&
              X509_gmtime_adj(X509_getm_notAfter(made.get()), until.count()) != nullptr &&
              X509_set_pubkey(made.get(), &key) == 1,
          "make a certificate");
  std::string text = name;
  require(X509_NAME_add_entry_by_txt(X509_get_subject_name(made.get()), "CN", MBSTRING_ASC,
                                     reinterpret_cast<const unsigned char*>(text.c_str()), -1, -1, 0) == 1,
          "take a name");
  return made;
}

std::FILE* opened(const std::filesystem::path& path) {
  std::FILE* const file = std::fopen(path.c_str(), "w");
  if (file == nullptr) {
    throw std::runtime_error("cannot write " + path.string());
  }
  return file;
}

void write(X509& certificate, const std::filesystem::path& path) {
  std::FILE* const file = opened(path);
  const bool written = PEM_write_X509(file, &certificate) == 1;
  require(std::fclose(file) == 0 && written, "write a certificate");
}

}  // namespace

Authority::Authority(std::filesystem::path directory, const std::string& name)
    : Authority(std::move(directory), name, std::chrono::hours(-24), std::chrono::hours(24)) {}

Authority::Authority(std::filesystem::path directory, const std::string& name, std::chrono::seconds from,
                     std::chrono::seconds until)
    : directory_(std::move(directory)),
      file_(directory_ / (name + ".crt")),
      key_(make_key()),
      certificate_(make_certificate(*key_, name, from, until)) {
  X509_set_issuer_name(certificate_.get(), X509_get_subject_name(certificate_.get()));
  extend(*certificate_, certificate_.get(), NID_basic_constraints, "critical,CA:TRUE");
  extend(*certificate_, certificate_.get(), NID_key_usage, "critical,keyCertSign");
  require(X509_sign(certificate_.get(), key_.get(), EVP_sha256()) > 0, "sign");
  write(*certificate_, file_);
}

Authority::~Authority() = default;

Certificate Authority::issue(const std::string& file, const std::string& name, const std::string& password,
                             Validity validity) const {
  const Certificate files{directory_ / (file + ".crt"), directory_ / (file + ".key")};
  const Key key = make_key();
  const Made made = make_certificate(*key, file, validity.from, validity.until);
  X509_set_issuer_name(made.get(), X509_get_subject_name(certificate_.get()));
  extend(*made, certificate_.get(), NID_subject_alt_name, name);
  require(X509_sign(made.get(), key_.get(), EVP_sha256()) > 0, "sign");
  write(*made, files.cert);
  std::FILE* const to = opened(files.key);
  std::string secret = password;
  const bool written = PEM_write_PrivateKey(to, key.get(), secret.empty() ? nullptr : EVP_aes_256_cbc(),
                                            reinterpret_cast<unsigned char*>(secret.data()),
                                            static_cast<int>(secret.size()), nullptr, nullptr) == 1;
  require(std::fclose(to) == 0 && written, "write a key");
  return files;
}

}  // namespace support
