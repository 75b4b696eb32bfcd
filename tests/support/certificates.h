#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

struct evp_pkey_st;
struct x509_st;

namespace support {

/// A certificate and its private key, as PEM files.
struct Certificate {
  std::filesystem::path cert;
  std::filesystem::path key;
};

/// An authority of the test's own, made by OpenSSL when it is needed: nothing that expires lies in the repository.
class Authority {
 public:
  /// Its certificate is `directory/NAME.crt`.
  Authority(std::filesystem::path directory, const std::string& name);
  /// Valid at another time than a day from now in both directions, from now.
  Authority(std::filesystem::path directory, const std::string& name, std::chrono::seconds from,
            std::chrono::seconds until);
  ~Authority();
  Authority(const Authority&) = delete;
  Authority& operator=(const Authority&) = delete;

  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  /// When a certificate is valid, from now.
  struct Validity {
    std::chrono::seconds from = std::chrono::hours(-1);
    std::chrono::seconds until = std::chrono::hours(1);
  };
  /// `directory/FILE.crt` and `.key`, for this subject alternative name (`DNS:localhost`); a password of the key where
  /// one is given. Takes the place of one that is there.
  [[nodiscard]] Certificate issue(const std::string& file, const std::string& name, const std::string& password,
                                  Validity validity) const;
  [[nodiscard]] Certificate issue(const std::string& file, const std::string& name,
                                  const std::string& password = {}) const {
    return issue(file, name, password, Validity{});
  }
  [[nodiscard]] Certificate issue(const std::string& file, const std::string& name, Validity validity) const {
    return issue(file, name, {}, validity);
  }

 private:
  std::filesystem::path directory_;
  std::filesystem::path file_;
  std::unique_ptr<evp_pkey_st, void (*)(evp_pkey_st*)> key_;
  std::unique_ptr<x509_st, void (*)(x509_st*)> certificate_;
};

}  // namespace support
