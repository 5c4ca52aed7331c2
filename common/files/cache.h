// Files that save time on the next start: compiled shaders and pipelines. Losing them costs nothing else, so
// every failure to read or write one is silent, and a damaged one counts as absent.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lab {

// Contents of the cache entry `name`, if there is an undamaged one.
std::optional<std::vector<uint8_t>> read_cache(const std::string& name);

// Replaces the entry in one step, so that other processes see the old or the new one.
void write_cache(const std::string& name, const std::vector<uint8_t>& contents);

}  // namespace lab
