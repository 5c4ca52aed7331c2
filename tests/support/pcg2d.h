// The generator of shaders/world/random.glsl, reimplemented for the CPU, and its inverse. Written from the description in
// Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3) 2020.
#pragma once
#include <array>
#include <cstdint>

namespace lab {

using RandomState = std::array<uint32_t, 2>;

RandomState next_state(RandomState state);
// The state s with next_state(s) == state. It exists for every state, so next_state() is a bijection.
RandomState previous_state(RandomState state);

// Start state of a sample, and its inverse.
RandomState start_state(uint32_t pixel, uint32_t sample, RandomState key);
RandomState pixel_and_sample(RandomState start_state, RandomState key);

// The two numbers in [0,1) that a state yields.
std::array<double, 2> numbers_of_state(RandomState state);
// A state whose next two numbers are u in [0,1), rounded down to multiples of 2^-24.
RandomState state_before(std::array<double, 2> u);
// A state whose next 64 bits are this number.
RandomState state_before(uint64_t bits);

}  // namespace lab
