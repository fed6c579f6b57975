#pragma once

#include <filesystem>
#include <string>

namespace scanloom::testing_support {

struct CertificateFiles {
    std::filesystem::path certificate;
    std::filesystem::path key;
};

/// Writes a self-signed certificate in PEM for a host ("localhost") or an address ("127.0.0.1"), and its private key,
/// which only the owner may read.
/// @param valid_for_s  seconds from now, negative for an expired certificate; validity starts one day before its end
CertificateFiles write_certificate(const std::filesystem::path& directory, const std::string& host,
                                   long valid_for_s = 23L * 3600);

} // namespace scanloom::testing_support
