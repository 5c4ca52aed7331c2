#include "support/pcg2d.h"

namespace lab {
namespace {

constexpr uint32_t multiplier = 1664525, increment = 1013904223;

// Newton's iteration doubles the number of correct bits; an odd number is its own inverse modulo 8.
constexpr uint32_t inverse_modulo_2_32(uint32_t odd) {
    uint32_t inverse = odd;
    for (int step = 0; step < 4; ++step) inverse *= 2 - odd * inverse;
    return inverse;
}
static_assert(multiplier * inverse_modulo_2_32(multiplier) == 1);

constexpr double resolution = 16777216;  // 2^24

}  // namespace

RandomState next_state(RandomState state) {
    auto [x, y] = state;
    x = multiplier * x + increment;
    y = multiplier * y + increment;
    for (int round = 0; round < 2; ++round) {
        x += multiplier * y;
        y += multiplier * x;
        x ^= x >> 16;
        y ^= y >> 16;
    }
    return {x, y};
}

RandomState previous_state(RandomState state) {
    auto [x, y] = state;
    for (int round = 0; round < 2; ++round) {
        x ^= x >> 16;
        y ^= y >> 16;
        y -= multiplier * x;
        x -= multiplier * y;
    }
    constexpr uint32_t inverse = inverse_modulo_2_32(multiplier);
    return {inverse * (x - increment), inverse * (y - increment)};
}

RandomState start_state(uint32_t pixel, uint32_t sample, RandomState key) {
    const RandomState state = next_state({pixel, sample});
    return next_state({state[0] ^ key[0], state[1] ^ key[1]});
}

RandomState pixel_and_sample(RandomState start_state, RandomState key) {
    const RandomState state = previous_state(start_state);
    return previous_state({state[0] ^ key[0], state[1] ^ key[1]});
}

std::array<double, 2> numbers_of_state(RandomState state) { return {(state[0] >> 8) / resolution, (state[1] >> 8) / resolution}; }

RandomState state_before(std::array<double, 2> u) {
    return previous_state({static_cast<uint32_t>(u[0] * resolution) << 8, static_cast<uint32_t>(u[1] * resolution) << 8});
}

RandomState state_before(uint64_t bits) {
    return previous_state({static_cast<uint32_t>(bits >> 32), static_cast<uint32_t>(bits)});
}

}  // namespace lab
