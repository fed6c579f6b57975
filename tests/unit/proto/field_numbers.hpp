#pragma once

#include <google/protobuf/descriptor.h>

#include <string>
#include <string_view>
#include <vector>

/// Ensures that old bytes stay readable: field_numbers.txt lists every field and enumerator that ever existed.
namespace scanloom::proto {

/// Returns the fields and enumerators of these files, one "name = number : type" each, sorted.
[[nodiscard]] std::vector<std::string> lines_of(const std::vector<const google::protobuf::FileDescriptor*>& files);

/// Returns one sentence per violation of the list; empty if there are none. A field keeps its name, number and type
/// permanently, or it is removed and its number is reserved.
[[nodiscard]] std::vector<std::string>
complaints_about(const std::vector<const google::protobuf::FileDescriptor*>& files, std::string_view list);

} // namespace scanloom::proto
