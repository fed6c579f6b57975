#pragma once

#include <filesystem>
#include <string>

namespace scanloom::testing_support {

struct CertificateFiles {
    std::filesystem::path certificate;
    std::filesystem::path key;
};

/// Writes a certificate in PEM that signs itself, for a host ("localhost") or an address ("127.0.0.1"), and its key.
CertificateFiles write_certificate(const std::filesystem::path& directory, const std::string& host);

} // namespace scanloom::testing_support
