// GLSL for translated shaders: its types, its functions by GLM, and what C++ lacks. translator.h says what uses it.
#pragma once
#include <bit>
#include <cmath>
#include <cstdio>
#include <glm/glm.hpp>
#include <type_traits>

#include "bindings.h"

namespace lab::native {

using namespace glm;  // for names of types alone: a shader's functions are those of `Builtins`

inline constexpr int invocations_at_once = 1;

// The line that uses what has this as its last parameter: std::source_location, which clang 14 lacks.
struct Place {
    const char* file;
    int line;
    static constexpr Place here(const char* file = __builtin_FILE(), int line = __builtin_LINE()) { return {file, line}; }

    template <typename... T>
    [[noreturn]] void fail(const char* format, T... what) const {
        Failed failed;
        const int length = std::snprintf(failed.text, sizeof failed.text, "%s:%d: ", file, line);
        if (length < static_cast<int>(sizeof failed.text))
            std::snprintf(failed.text + length, sizeof failed.text - static_cast<size_t>(length), format, what...);
        throw failed;
    }
};

// An index of an array. Where shaders are checked it knows the line that uses it.
#ifdef LAB_CHECKED
struct Index {
    int64_t value;
    Place place;
    template <typename T>
    constexpr Index(T index, Place place = Place::here()) : value(index), place(place) {}
    constexpr size_t in(size_t size) const {
        if (value >= 0 && value < static_cast<int64_t>(size)) return static_cast<size_t>(value);
        place.fail("index %lld of an array of %zu elements", static_cast<long long>(value), size);
    }
};
#else
struct Index {
    size_t value;
    template <typename T>
    constexpr Index(T index) : value(static_cast<size_t>(index)) {}
    constexpr size_t in(size_t) const { return value; }
};
#endif

// An index of a vector or a matrix of so many parts.
template <int size>
constexpr int within(Index i) {
    return static_cast<int>(i.in(size));
}

template <typename T, size_t size>
struct Array {
    T elements[size];
    constexpr T& operator[](Index i) { return elements[i.in(size)]; }
    constexpr const T& operator[](Index i) const { return elements[i.in(size)]; }
    static constexpr int length() { return static_cast<int>(size); }
    template <typename U>
    requires(std::is_convertible_v<T, U> && !std::is_same_v<T, U>) operator Array<U, size>() const {
        Array<U, size> converted;
        for (size_t i = 0; i < size; ++i) converted.elements[i] = elements[i];
        return converted;
    }
};

// The array at the end of a buffer.
template <typename T>
struct Span {
    T* elements;
    size_t size;
    constexpr T& operator[](Index i) const { return elements[i.in(size)]; }
    int length() const { return static_cast<int>(size); }
};

// The parts of a binding.
template <typename T>
T& get(const Bindings& bindings, uint binding, size_t offset) {
    return *reinterpret_cast<T*>(bindings.ranges[binding].data + offset);
}
template <typename T>
Span<T> get_array(const Bindings& bindings, uint binding, size_t offset) {
    return {&get<T>(bindings, binding, offset), (bindings.ranges[binding].bytes - offset) / sizeof(T)};
}
template <typename T>
T& get_constant(const Bindings& bindings, size_t offset) {
    return *reinterpret_cast<T*>(bindings.push_constants + offset);
}

template <typename T>
inline constexpr bool is_matrix = false;
template <length_t n, length_t m, typename T, qualifier q>
inline constexpr bool is_matrix<mat<n, m, T, q>> = true;

// Calls `f` for each component of vectors, or for scalars.
template <typename F, typename T, typename... More>
constexpr auto each(F f, const T& x, const More&... more) {
    if constexpr (std::is_arithmetic_v<T>) {
        return f(x, more...);
    } else {
        vec<T::length(), decltype(f(x[0], more[0]...))> result;
        for (length_t i = 0; i < T::length(); ++i) result[i] = f(x[i], more[i]...);
        return result;
    }
}

// Vectors and matrices of what is in parentheses, which the shader has brought to their number type.
template <typename T, typename... Parts>
constexpr T make(const Parts&... parts) {
    return T(parts...);
}
template <typename T, typename U>
constexpr T convert(const U& x) {
    return T(x);
}
// The same words as numbers of another type.
template <typename T, typename U>
constexpr T bits(const U& x) {
    return std::bit_cast<T>(x);
}
// Components of two vectors in a row.
template <int... i, typename A, typename B>
constexpr auto shuffle(const A& a, const B& b) {
    return vec<sizeof...(i), typename A::value_type>((i < A::length() ? a[i] : b[i - A::length()])...);
}
template <typename T, typename F>
T changed(T x, const F& change) {
    change(x);
    return x;
}

// Whole numbers may be divided by 0 where shaders are not checked: GLSL leaves the result open.
inline void check_divisor([[maybe_unused]] bool is_zero, [[maybe_unused]] Place place) {
#ifdef LAB_CHECKED
    if (is_zero) place.fail("a division by 0");
#endif
}

constexpr int64_t wide(int x) { return x; }
constexpr uint64_t wide(uint x) { return x; }

struct Builtins {
#define LAB_SAME(name)                          \
    template <typename... T>                    \
    static constexpr auto name(const T&... x) { \
        return glm::name(x...);                 \
    }
    // clang-format off
    LAB_SAME(radians) LAB_SAME(degrees) LAB_SAME(sin) LAB_SAME(cos) LAB_SAME(tan) LAB_SAME(asin) LAB_SAME(acos) LAB_SAME(atan)
    LAB_SAME(sinh) LAB_SAME(cosh) LAB_SAME(tanh) LAB_SAME(asinh) LAB_SAME(acosh) LAB_SAME(atanh) LAB_SAME(pow) LAB_SAME(exp)
    LAB_SAME(log) LAB_SAME(exp2) LAB_SAME(log2) LAB_SAME(sqrt) LAB_SAME(inversesqrt) LAB_SAME(floor) LAB_SAME(trunc)
    LAB_SAME(round) LAB_SAME(roundEven) LAB_SAME(ceil) LAB_SAME(fract) LAB_SAME(mod) LAB_SAME(step) LAB_SAME(smoothstep)
    LAB_SAME(isnan) LAB_SAME(isinf) LAB_SAME(cross) LAB_SAME(faceforward)
    LAB_SAME(reflect) LAB_SAME(refract) LAB_SAME(outerProduct) LAB_SAME(transpose) LAB_SAME(determinant) LAB_SAME(inverse)
    LAB_SAME(sign) LAB_SAME(min) LAB_SAME(max) LAB_SAME(clamp) LAB_SAME(mix) LAB_SAME(any) LAB_SAME(all) LAB_SAME(bitCount)
    LAB_SAME(findLSB) LAB_SAME(packHalf2x16) LAB_SAME(unpackHalf2x16) LAB_SAME(packUnorm4x8) LAB_SAME(unpackUnorm4x8)
    LAB_SAME(packUnorm2x16) LAB_SAME(unpackUnorm2x16) LAB_SAME(packSnorm4x8) LAB_SAME(unpackSnorm4x8) LAB_SAME(packSnorm2x16)
    LAB_SAME(unpackSnorm2x16) LAB_SAME(ldexp)
#undef LAB_SAME

#define LAB_OPERATOR(name, op)                               \
    template <typename A, typename B>                             \
    static constexpr auto name(const A& a, const B& b) {          \
        return each([](auto x, auto y) { return x op y; }, a, b); \
    }
    LAB_OPERATOR(lessThan, <) LAB_OPERATOR(lessThanEqual, <=) LAB_OPERATOR(greaterThan, >) LAB_OPERATOR(greaterThanEqual, >=)
    LAB_OPERATOR(equal, ==) LAB_OPERATOR(notEqual, !=)
#undef LAB_OPERATOR
        // clang-format on
        static constexpr bool both(bool a, bool b) {
        return a && b;
    }
    static constexpr bool either(bool a, bool b) { return a || b; }
    template <typename T>
    static constexpr auto not_(const T& x) {
        return each([](bool y) { return !y; }, x);
    }
    template <typename T>
    static constexpr T negate(const T& x) {
        return -x;
    }
    template <typename T>
    static constexpr T flip(const T& x) {
        return ~x;
    }
    // Sums of products are added in the order in which lavapipe adds them: those of matrices from the last one on.
    template <typename T>
    static constexpr auto dot(const T& a, const T& b) {
        if constexpr (std::is_arithmetic_v<T>) {
            return a * b;
        } else {
            auto sum = a[0] * b[0];
            for (length_t i = 1; i < T::length(); ++i) sum += a[i] * b[i];
            return sum;
        }
    }
    template <typename A, typename B>
    static constexpr auto add_from_last(const A& a, const B& b) {
        auto sum = a[A::length() - 1] * b[A::length() - 1];
        for (length_t i = A::length() - 1; i-- > 0;) sum = a[i] * b[i] + sum;
        return sum;
    }
    template <typename A, typename B>
    static constexpr auto multiply(const A& a, const B& b) {
        if constexpr (std::is_arithmetic_v<A> || std::is_arithmetic_v<B> || (!is_matrix<A> && !is_matrix<B>)) {
            return a * b;
        } else if constexpr (is_matrix<B>) {
            decltype(a * b) result;
            for (length_t i = 0; i < B::length(); ++i) result[i] = add_from_last(a, b[i]);
            return result;
        } else {
            return add_from_last(a, b);
        }
    }
    template <typename T>
    static auto length(const T& x) {
        if constexpr (std::is_arithmetic_v<T>)
            return std::abs(x);
        else
            return glm::sqrt(dot(x, x));
    }
    template <typename T>
    static auto distance(const T& a, const T& b) {
        return length(b - a);
    }
    template <typename C, typename T>
    static constexpr T select(const C& condition, const T& a, const T& b) {
        if constexpr (std::is_same_v<C, bool>)
            return condition ? a : b;
        else
            return each([](bool c, auto x, auto y) { return c ? x : y; }, condition, a, b);
    }
    template <typename T>
    static constexpr T quotient(const T& a, const T& b, Place place = Place::here()) {
        return each(
            [&](auto x, auto y) {
                check_divisor(y == 0, place);
                return static_cast<decltype(x)>(y == 0 ? 0 : int64_t{x} / int64_t{y});
            },
            a, b);
    }
    // GLSL leaves the sign open.
    template <typename T>
    static constexpr T remainder(const T& a, const T& b, Place place = Place::here()) {
        return each(
            [&](auto x, auto y) {
                check_divisor(y == 0, place);
                return static_cast<decltype(x)>(y == 0 ? 0 : int64_t{x} % int64_t{y});
            },
            a, b);
    }
    template <typename T>
    static T normalize(const T& x) {
        if constexpr (std::is_arithmetic_v<T>)  // GLM's takes no number
            return x / glm::abs(x);
        else
            return x * glm::inversesqrt(dot(x, x));
    }
    // GLM's know no negative numbers: of those GLSL finds the highest 0, and extends the sign.
    template <typename T>
    static auto findMSB(const T& x) {
        return each([](auto bits) { return 31 - std::countl_zero(static_cast<uint>(bits < 0 ? ~bits : bits)); }, x);
    }
    template <typename T>
    static auto bitfieldReverse(const T& x) {
        return each([](auto bits) { return decltype(bits)(glm::bitfieldReverse(uint(bits))); }, x);
    }
    template <typename T, typename Offset, typename Count>
    static auto bitfieldInsert(const T& x, const T& y, const Offset& offset, const Count& count) {
        return glm::bitfieldInsert(x, y, int(offset), int(count));
    }
    template <typename T, typename Offset, typename Count>
    static auto bitfieldExtract(const T& x, const Offset& offset, const Count& count) {
        const auto first = static_cast<int>(offset), size = static_cast<int>(count);
        return each([&](auto bits) { return size == 0 ? decltype(bits){} : bits << (32 - first - size) >> (32 - size); }, x);
    }
    template <typename T>
    static auto abs(const T& x) {  // GLM's asks for the sign
        return each([](auto number) { return std::abs(number); }, x);
    }
    template <typename A, typename B, typename C>
    static auto fma(const A& a, const B& b, const C& c) {  // GLM's rounds twice
        return each([](auto x, auto y, auto z) { return std::fma(x, y, z); }, a, b, c);
    }

    // The second results of functions that have two.
    static auto carry(const auto& a, const auto& b) {
        return each([](uint x, uint y) { return x + y < x ? 1u : 0u; }, a, b);
    }
    static auto borrow(const auto& a, const auto& b) {
        return each([](uint x, uint y) { return x < y ? 1u : 0u; }, a, b);
    }
    static auto upper_half(const auto& a, const auto& b) {  // of a product
        return each([](auto x, auto y) { return static_cast<decltype(x)>(wide(x) * wide(y) >> 32); }, a, b);
    }
    static auto rest(const auto& x) { return x - glm::trunc(x); }
    static auto fraction(const auto& x) {
        decltype(each([](float) { return 0; }, x)) exponent;
        return glm::frexp(x, exponent);
    }
    static auto exponent(const auto& x) {
        decltype(each([](float) { return 0; }, x)) exponent;
        (void)glm::frexp(x, exponent);
        return exponent;
    }

#define LAB_ATOMIC(name, change)                                                                                \
    template <typename T>                                                                                       \
    static T name(T& target, std::type_identity_t<T> operand) {                                                 \
        T before, after;                                                                                        \
        __atomic_load(&target, &before, __ATOMIC_RELAXED);                                                      \
        do after = change;                                                                                      \
        while (!__atomic_compare_exchange(&target, &before, &after, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)); \
        return before;                                                                                          \
    }
    LAB_ATOMIC(atomicAdd, before + operand)
    LAB_ATOMIC(atomicMin, before < operand ? before : operand)
    LAB_ATOMIC(atomicMax, before < operand ? operand : before)
    LAB_ATOMIC(atomicAnd, before& operand)
    LAB_ATOMIC(atomicOr, before | operand)
    LAB_ATOMIC(atomicXor, before ^ operand)
    LAB_ATOMIC(atomicExchange, operand)
#undef LAB_ATOMIC
    template <typename T>
    static T atomicCompSwap(T& target, std::type_identity_t<T> wanted, std::type_identity_t<T> expected) {
        __atomic_compare_exchange(&target, &expected, &wanted, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
        return expected;
    }

    static ivec2 textureSize(const Texture& texture) { return {texture.width, texture.height}; }
    static vec4 texelFetch(const Texture& texture, ivec2 position, [[maybe_unused]] Place place = Place::here()) {
#ifdef LAB_CHECKED
        if (position.x < 0 || position.x >= texture.width || position.y < 0 || position.y >= texture.height)
            place.fail("texel %d,%d of an image of %d x %d", position.x, position.y, texture.width, texture.height);
#endif
        const size_t i =
            4 * (static_cast<size_t>(position.y) * static_cast<size_t>(texture.width) + static_cast<size_t>(position.x));
        if (texture.is_float) {
            const float* texel = static_cast<const float*>(texture.texels) + i;
            return {texel[0], texel[1], texel[2], texel[3]};
        }
        const uint8_t* texel = static_cast<const uint8_t*>(texture.texels) + i;
        return vec4(texel[0], texel[1], texel[2], texel[3]) / 255.0f;
    }
};

// What all translated shaders have. The shader's own code is the rest of a struct: its globals are members, anew for each
// invocation.
struct ShaderBase : Builtins {
    const Bindings& bindings;
    uvec3 gl_NumWorkGroups, gl_WorkGroupID, gl_LocalInvocationID, gl_GlobalInvocationID;
    uint gl_LocalInvocationIndex;

    // By Embree, see shaders/engine/trace_ray/embree.glsl.
    bool native_closest_hit(const vec3& origin, const vec3& direction, float t_max, uint& instance, uint& triangle,
                            vec2& barycentrics, float& distance) const {
        RayHit hit;
        if (!bindings.rays->trace(&origin.x, &direction.x, t_max, &hit)) return false;
        instance = hit.instance;
        triangle = hit.triangle;
        barycentrics = {hit.barycentrics[0], hit.barycentrics[1]};
        distance = hit.distance;
        return true;
    }
    bool native_any_hit(const vec3& origin, const vec3& direction, float t_max) const {
        return bindings.rays->trace(&origin.x, &direction.x, t_max, nullptr);
    }
};

// The entry point that the program calls.
template <typename Run>
Outcome run_group(char* error, size_t error_size, const Run& run) try {
    run();
    return Outcome::finished;
} catch (const Stopped&) {
    return Outcome::stopped;
} catch (const Failed& failed) {
    std::snprintf(error, error_size, "%s", failed.text);
    return Outcome::failed;
}
template <typename Shader>
Outcome run_group(const Bindings& bindings, uint32_t group, char* error, size_t error_size) {
    return run_group(error, error_size, [&] {
        for (uint i = 0; i < Shader::local_size__; ++i) {
            const uint index = group * Shader::local_size__ + i;
            Shader shader{
                {{}, bindings, uvec3(bindings.group_count, 1, 1), uvec3(group, 0, 0), uvec3(i, 0, 0), uvec3(index, 0, 0), i}};
            shader.main__();
        }
    });
}

}  // namespace lab::native
