#pragma once

#include <cstdint>
#include <string_view>

namespace grainlaw::io {

/// FNV-1a, 64 bit: any single changed byte changes it.
constexpr std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  }
  return hash;
}

}  // namespace grainlaw::io
