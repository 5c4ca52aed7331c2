#include "scene/alias_table.h"

#include <algorithm>
#include <cmath>

namespace lab {
namespace {

constexpr double word_count = 4294967296.0;  // 2^32

// How many of the 2^32 words choose entry i of n: floor(word * n / 2^32) == i.
double words_of_entry(uint64_t i, uint64_t n) {
    const auto first_word = [n](uint64_t entry) { return ((entry << 32) + n - 1) / n; };
    return static_cast<double>(first_word(i + 1) - first_word(i));
}

}  // namespace

AliasTable build_alias_table(std::span<const double> weights) {
    const size_t count = weights.size();
    const auto heaviest = std::ranges::max_element(weights);
    const double largest = *heaviest;
    double sum = 0;
    for (const double weight : weights) sum += weight / largest;
    // The share of each item, in units of an entry's probability.
    std::vector<double> share(count);
    std::vector<uint32_t> small, large;
    for (uint32_t i = 0; i < count; ++i) {
        share[i] = weights[i] / largest / sum * static_cast<double>(count);
        (share[i] < 1 ? small : large).push_back(i);
    }

    AliasTable table;
    table.entries.resize(count);
    while (!small.empty()) {
        const uint32_t item = small.back();
        small.pop_back();
        // Rounding may leave no large item for the last small ones: the heaviest takes the rest.
        const uint32_t filler =
            large.empty() ? static_cast<uint32_t>(heaviest - weights.begin()) : large.back();
        const double quanta = weights[item] > 0 ? std::max(std::floor(share[item] * word_count), 1.0) : 0.0;
        table.entries[item] = {static_cast<uint32_t>(std::min(quanta, word_count - 1)), filler};
        if (large.empty()) continue;
        share[filler] -= 1 - share[item];
        if (share[filler] < 1) {
            large.pop_back();
            small.push_back(filler);
        }
    }
    for (const uint32_t item : large) table.entries[item] = {0, item};

    table.probabilities.resize(count);
    for (uint32_t i = 0; i < count; ++i) {
        const double entry_probability = words_of_entry(i, count) / word_count;
        const double kept = table.entries[i].threshold / word_count;
        table.probabilities[i] += entry_probability * kept;
        table.probabilities[table.entries[i].alias] += entry_probability * (1 - kept);
    }
    return table;
}

}  // namespace lab
