// Chooses one of many items in constant time, each with a probability of its own.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace lab {

// Walker's alias table, built by Vose's method (IEEE Transactions on Software Engineering 17(9), 1991) in
// double. To choose an item take two random 32-bit words: entry i is the high word of word_1 * n; the item is
// i itself if word_2 < threshold of i, else alias of i.
struct AliasTable {
    struct Entry {
        uint32_t threshold = 0;
        uint32_t alias = 0;
    };
    std::vector<Entry> entries;
    // Of each item, exactly as the table's integers make them. The weights are met up to 2^-32: estimators
    // that divide by these probabilities stay unbiased.
    std::vector<double> probabilities;
};

// Probabilities are proportional to the weights, which must be finite and not negative, at least one
// positive. An item of weight 0 is never chosen, one of positive weight always has a positive probability.
AliasTable build_alias_table(std::span<const double> weights);

}  // namespace lab
