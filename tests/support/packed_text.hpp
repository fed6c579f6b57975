#pragma once

#include <boost/iostreams/filter/bzip2.hpp>
#include <boost/iostreams/filter/gzip.hpp>
#include <boost/iostreams/filtering_stream.hpp>

#include <sstream>
#include <string>
#include <string_view>

namespace scanloom::testing_support {

/// Returns the text compressed by one of Boost.Iostreams' compressors.
template <class Filter>
std::string packed(std::string_view text, Filter filter) {
    std::ostringstream out;
    {
        boost::iostreams::filtering_ostream stream;
        stream.push(filter);
        stream.push(out);
        stream << text;
    }
    return out.str();
}

inline std::string gzip(std::string_view text) { return packed(text, boost::iostreams::gzip_compressor()); }
inline std::string bzip2(std::string_view text) { return packed(text, boost::iostreams::bzip2_compressor()); }

} // namespace scanloom::testing_support
