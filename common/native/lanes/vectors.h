// Vectors of as many numbers as there are lanes, and what CPUs with AVX2 or AVX-512 do with them that C++ has no operators for.
// Instructions are GCC's builtins: it reads <immintrin.h> for longer than some chapters.
#pragma once
#include <cstddef>
#include <cstring>
#include <utility>

#include "native/lanes/packet.h"

// In the code that calls them, vectors of such functions stay in registers.
#define LAB_INLINE [[gnu::always_inline]] inline

namespace lab::native::lanes {

typedef char Bytes __attribute__((vector_size(4 * lane_count)));
typedef int32_t Four __attribute__((vector_size(16)));

#ifdef __AVX512DQ__
#define LAB_LIBMVEC(name) _ZGVeN16##name
LAB_INLINE uint32_t signs(Integers x) { return static_cast<uint16_t>(__builtin_ia32_cvtd2mask512(x)); }
LAB_INLINE Floats round_down(Floats x) { return __builtin_ia32_rndscaleps_mask(x, 1, x, -1, 4); }
#ifdef __clang__
LAB_INLINE Floats square_root(Floats x) { return __builtin_ia32_sqrtps512(x, 4); }
#else
LAB_INLINE Floats square_root(Floats x) { return __builtin_ia32_sqrtps512_mask(x, x, -1, 4); }
#endif
#define LAB_MULTIPLY_BITS __builtin_ia32_vgf2p8affineqb_v64qi
LAB_INLINE Floats multiply_add(Floats a, Floats b, Floats c) { return __builtin_ia32_vfmaddps512_mask(a, b, c, -1, 4); }
LAB_INLINE Integers gather(Integers mask, const int32_t* base, Integers index) {
    return __builtin_ia32_gathersiv16si(Integers{}, base, index, __builtin_ia32_cvtd2mask512(mask), 4);
}
// row(0), row(4), ... one behind the other.
template <typename Row>
LAB_INLINE Integers every_fourth(const Row& row) {
    typedef int32_t Eight __attribute__((vector_size(32)));
    const Eight low = __builtin_shufflevector(row(0), row(4), 0, 1, 2, 3, 4, 5, 6, 7),
                high = __builtin_shufflevector(row(8), row(12), 0, 1, 2, 3, 4, 5, 6, 7);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
#else
#define LAB_LIBMVEC(name) _ZGVdN8##name
#define LAB_MULTIPLY_BITS __builtin_ia32_vgf2p8affineqb_v32qi
LAB_INLINE uint32_t signs(Integers x) { return static_cast<uint32_t>(__builtin_ia32_movmskps256(reinterpret_cast<Floats>(x))); }
LAB_INLINE Floats round_down(Floats x) { return __builtin_ia32_roundps256(x, 1); }
LAB_INLINE Floats square_root(Floats x) { return __builtin_ia32_sqrtps256(x); }
LAB_INLINE Floats multiply_add(Floats a, Floats b, Floats c) { return __builtin_ia32_vfmaddps256(a, b, c); }
LAB_INLINE Integers gather(Integers mask, const int32_t* base, Integers index) {
#ifdef __clang__
    return __builtin_ia32_gatherd_d256(Integers{}, base, index, mask, 4);
#else
    return __builtin_ia32_gathersiv8si(Integers{}, base, index, mask, 4);
#endif
}
template <typename Row>
LAB_INLINE Integers every_fourth(const Row& row) {
    return __builtin_shufflevector(row(0), row(4), 0, 1, 2, 3, 4, 5, 6, 7);
}
#endif

// Of the C library.
extern "C" Floats LAB_LIBMVEC(v_sinf)(Floats);
extern "C" Floats LAB_LIBMVEC(v_cosf)(Floats);
extern "C" Floats LAB_LIBMVEC(v_tanf)(Floats);
extern "C" Floats LAB_LIBMVEC(v_atanf)(Floats);
extern "C" Floats LAB_LIBMVEC(vv_atan2f)(Floats, Floats);
extern "C" Floats LAB_LIBMVEC(v_expf)(Floats);
extern "C" Floats LAB_LIBMVEC(v_logf)(Floats);
extern "C" Floats LAB_LIBMVEC(vv_powf)(Floats, Floats);

LAB_INLINE Integers reverse_bits(Integers x) {  // of each number: those of its bytes, then the bytes
#ifdef __GFNI__
    typedef int64_t Matrices __attribute__((vector_size(4 * lane_count)));
    const Matrices matrices = Matrices{} + static_cast<int64_t>(0x8040201008040201);
    const Bytes bytes = LAB_MULTIPLY_BITS(reinterpret_cast<Bytes>(x), reinterpret_cast<Bytes>(matrices), 0);
#else
    const auto swap = [](Integers bits, int32_t mask, int shift) { return (bits >> shift & mask) | (bits & mask) << shift; };
    const Bytes bytes = reinterpret_cast<Bytes>(swap(swap(swap(x, 0x55555555, 1), 0x33333333, 2), 0x0f0f0f0f, 4));
#endif
    return [&]<int... i>(std::integer_sequence<int, i...>) {
        return reinterpret_cast<Integers>(__builtin_shufflevector(bytes, bytes, (i ^ 3)...));
    }
    (std::make_integer_sequence<int, 4 * lane_count>());
}

// Takes elements of each four of `a` and of `b`, where 0 to 3 count those of `a` and 4 to 7 those of `b`.
template <int... which>
LAB_INLINE Integers shuffle_fours(Integers a, Integers b) {
    constexpr int chosen[]{which...};
    return [&]<size_t... i>(std::index_sequence<i...>) {
        return __builtin_shufflevector(a, b, (int(i) / 4 * 4 + chosen[i % 4] % 4 + chosen[i % 4] / 4 * lane_count)...);
    }
    (std::make_index_sequence<lane_count>());
}

}  // namespace lab::native::lanes
