#include "tests/support/test_certificate.hpp"

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <cctype>
#include <cstdio>
#include <memory>

namespace scanloom::testing_support {
namespace {

using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

constexpr auto kOwnerOnly = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;

Certificate make_certificate(EVP_PKEY* key, const std::string& host, long valid_for_s) {
    Certificate made(X509_new(), X509_free);
    X509_set_version(made.get(), 2); // the encoding of version 3
    ASN1_INTEGER_set(X509_get_serialNumber(made.get()), 1);
    X509_gmtime_adj(X509_getm_notBefore(made.get()), valid_for_s - 24L * 3600);
    X509_gmtime_adj(X509_getm_notAfter(made.get()), valid_for_s);
    X509_set_pubkey(made.get(), key);
    X509_NAME* name = X509_get_subject_name(made.get());
    X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, reinterpret_cast<const unsigned char*>("scanloom test"), -1,
                               -1, 0);
    X509_set_issuer_name(made.get(), name);
    const bool is_address = std::isdigit(static_cast<unsigned char>(host.front())) != 0;
    const std::string names = (is_address ? "IP:" : "DNS:") + host;
    X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, names.c_str());
    X509_add_ext(made.get(), extension, -1);
    X509_EXTENSION_free(extension);
    X509_sign(made.get(), key, EVP_sha256());
    return made;
}

} // namespace

CertificateFiles write_certificate(const std::filesystem::path& directory, const std::string& host, long valid_for_s) {
    const CertificateFiles files{directory / (host + ".crt"), directory / (host + ".key")};
    const Key key(EVP_EC_gen("P-256"), EVP_PKEY_free);
    const Certificate certificate = make_certificate(key.get(), host, valid_for_s);
    const File certificate_file(std::fopen(files.certificate.c_str(), "w"), std::fclose);
    PEM_write_X509(certificate_file.get(), certificate.get());
    const File key_file(std::fopen(files.key.c_str(), "w"), std::fclose);
    std::filesystem::permissions(files.key, kOwnerOnly);
    PEM_write_PrivateKey(key_file.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr);
    return files;
}

} // namespace scanloom::testing_support
