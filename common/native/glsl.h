// GLSL for translated shaders: its types, its functions by GLM, and what C++ lacks. translator.h says what uses it.
#pragma once
#include <bit>
#include <cmath>
#include <cstdio>
#include <glm/glm.hpp>
#include <source_location>
#include <type_traits>

#include "bindings.h"

namespace lab::native {

using namespace glm;  // for names of types alone: a shader's functions are those of `Builtins`

// An index of an array. Where shaders are checked it knows the line that uses it.
#ifdef LAB_CHECKED
struct Index {
    int64_t value;
    std::source_location place;
    template <typename T>
    constexpr Index(T index, std::source_location place = std::source_location::current()) : value(index), place(place) {}
    constexpr size_t in(size_t size) const {
        if (value >= 0 && value < static_cast<int64_t>(size)) return static_cast<size_t>(value);
        Failed failed;
        std::snprintf(failed.text, sizeof failed.text, "%s:%u: index %lld of an array of %zu elements", place.file_name(),
                      static_cast<unsigned>(place.line()), static_cast<long long>(value), size);
        throw failed;
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

template <typename T, size_t size>
struct Array {
    T elements[size];
    constexpr T& operator[](Index i) { return elements[i.in(size)]; }
    constexpr const T& operator[](Index i) const { return elements[i.in(size)]; }
    static constexpr int length() { return static_cast<int>(size); }
    bool operator==(const Array&) const = default;
};
template <typename T, typename... Elements>
constexpr auto make_array(Elements... elements) {
    return Array<T, sizeof...(Elements)>{{T(elements)...}};
}

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

// Number types: of a scalar itself, of a vector that of its components.
template <typename T>
struct ComponentOf {
    using type = T;
};
template <length_t n, typename T, qualifier q>
struct ComponentOf<vec<n, T, q>> {
    using type = T;
};
template <length_t n, length_t m, typename T, qualifier q>
struct ComponentOf<mat<n, m, T, q>> {
    using type = T;
};
template <typename T>
using Component = typename ComponentOf<std::remove_cvref_t<T>>::type;
template <typename... T>
using Common = std::common_type_t<Component<T>...>;
template <typename... T>
using CommonFloat = std::common_type_t<float, Component<T>...>;

// GLSL's implicit conversions.
template <typename C, typename T>
constexpr auto as(const T& x) {
    if constexpr (std::is_arithmetic_v<T>)
        return static_cast<C>(x);
    else
        return x;
}
template <typename C, length_t n, typename T, qualifier q>
constexpr auto as(const vec<n, T, q>& x) {
    return vec<n, C, q>(x);
}

// A scalar made of a scalar or of a vector's first component.
template <typename S, typename T>
constexpr S scalar(const T& x) {
    if constexpr (std::is_arithmetic_v<T>)
        return static_cast<S>(x);
    else
        return static_cast<S>(x[0]);
}

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

// Operators on numbers of different types. A shift keeps the type of what is shifted.
template <typename A, typename B>
concept Mixed = !std::is_same_v<Component<A>, Component<B>> &&
                (!std::is_arithmetic_v<A> || !std::is_arithmetic_v<B>)&&std::is_arithmetic_v<Component<A>> &&
                std::is_arithmetic_v<Component<B>>;
#define LAB_OPERATOR(op, ...)         \
    template <typename A, typename B> \
    requires Mixed<A, B>              \
    constexpr auto operator op(const A& a, const B& b) { return as<__VA_ARGS__>(a) op as<__VA_ARGS__>(b); }
LAB_OPERATOR(+, Common<A, B>)
LAB_OPERATOR(-, Common<A, B>)
LAB_OPERATOR(*, Common<A, B>)
LAB_OPERATOR(/, Common<A, B>)
LAB_OPERATOR(%, Common<A, B>)
LAB_OPERATOR(&, Common<A, B>)
LAB_OPERATOR(|, Common<A, B>)
LAB_OPERATOR(^, Common<A, B>)
LAB_OPERATOR(<<, Component<A>)
LAB_OPERATOR(>>, Component<A>)
#undef LAB_OPERATOR

template <int... i, typename V>
constexpr auto swizzle(const V& v) {
    if constexpr (std::is_arithmetic_v<V>)
        return vec<sizeof...(i), V>((i, v)...);
    else
        return vec<sizeof...(i), Component<V>>(v[i]...);
}
// A swizzle that is assigned to.
template <typename V, int... i>
struct Swizzled {
    using Value = vec<sizeof...(i), Component<V>>;
    V& target;
    operator Value() const { return Value(target[i]...); }
    Component<V>& operator[](length_t component) const {
        constexpr length_t indices[]{i...};
        return target[indices[component]];
    }
    Value operator=(Value value) {  // not by reference: it may be the target itself
        length_t next = 0;
        ((target[i] = value[next++]), ...);
        return value;
    }
#define LAB_ASSIGNMENT(op)                       \
    template <typename T>                        \
    Value operator op##=(const T& x) {           \
        return *this = Value(Value(*this) op x); \
    }
    LAB_ASSIGNMENT(+)
    LAB_ASSIGNMENT(-)
    LAB_ASSIGNMENT(*)
    LAB_ASSIGNMENT(/)
    LAB_ASSIGNMENT(%)
    LAB_ASSIGNMENT(&)
    LAB_ASSIGNMENT(|)
    LAB_ASSIGNMENT(^)
    LAB_ASSIGNMENT(<<)
    LAB_ASSIGNMENT(>>)
#undef LAB_ASSIGNMENT
    Value operator++() { return *this += Component<V>(1); }
    Value operator--() { return *this -= Component<V>(1); }
};
template <int... i, typename V>
Swizzled<V, i...> swizzled(V& v) {
    return {v};
}

// An argument of an `out` or `inout` parameter that is copied in and out, since another name may lead to the same variable.
template <typename Target, typename Value>
struct Copied {
    Target target;
    Value value;
    operator Value&() { return value; }
    ~Copied() { target = value; }
};
template <typename T>
Copied<T&, T> copied(T& target) {
    return {target, target};
}
template <typename V, int... i>
auto copied(Swizzled<V, i...> target) {
    return Copied<Swizzled<V, i...>, typename Swizzled<V, i...>::Value>{target, target};
}

struct Builtins {
#define LAB_FLOATS(name)                               \
    template <typename... T>                           \
    static constexpr auto name(const T&... x) {        \
        return glm::name(as<CommonFloat<T...>>(x)...); \
    }
#define LAB_NUMBERS(name)                         \
    template <typename... T>                      \
    static constexpr auto name(const T&... x) {   \
        return glm::name(as<Common<T...>>(x)...); \
    }
#define LAB_SAME(name)                          \
    template <typename... T>                    \
    static constexpr auto name(const T&... x) { \
        return glm::name(x...);                 \
    }
    // clang-format off
    LAB_FLOATS(radians) LAB_FLOATS(degrees) LAB_FLOATS(sin) LAB_FLOATS(cos) LAB_FLOATS(tan) LAB_FLOATS(asin) LAB_FLOATS(acos)
    LAB_FLOATS(atan) LAB_FLOATS(sinh) LAB_FLOATS(cosh) LAB_FLOATS(tanh) LAB_FLOATS(asinh) LAB_FLOATS(acosh) LAB_FLOATS(atanh)
    LAB_FLOATS(pow) LAB_FLOATS(exp) LAB_FLOATS(log) LAB_FLOATS(exp2) LAB_FLOATS(log2) LAB_FLOATS(sqrt) LAB_FLOATS(inversesqrt)
    LAB_FLOATS(floor) LAB_FLOATS(trunc) LAB_FLOATS(round) LAB_FLOATS(roundEven) LAB_FLOATS(ceil) LAB_FLOATS(fract) LAB_FLOATS(mod)
    LAB_FLOATS(step) LAB_FLOATS(smoothstep) LAB_FLOATS(isnan) LAB_FLOATS(isinf) LAB_FLOATS(length) LAB_FLOATS(distance)
    LAB_FLOATS(dot) LAB_FLOATS(cross) LAB_FLOATS(normalize) LAB_FLOATS(faceforward) LAB_FLOATS(reflect) LAB_FLOATS(refract)
    LAB_SAME(matrixCompMult) LAB_SAME(outerProduct) LAB_SAME(transpose) LAB_SAME(determinant) LAB_SAME(inverse)
    LAB_NUMBERS(sign) LAB_NUMBERS(min) LAB_NUMBERS(max) LAB_NUMBERS(clamp) LAB_NUMBERS(lessThan) LAB_NUMBERS(lessThanEqual)
    LAB_NUMBERS(greaterThan) LAB_NUMBERS(greaterThanEqual) LAB_NUMBERS(equal) LAB_NUMBERS(notEqual) LAB_SAME(any) LAB_SAME(all)
    LAB_SAME(not_) LAB_SAME(bitCount) LAB_SAME(findLSB) LAB_SAME(bitfieldInsert)
    LAB_SAME(packHalf2x16) LAB_SAME(unpackHalf2x16) LAB_SAME(packUnorm4x8) LAB_SAME(unpackUnorm4x8)
    LAB_SAME(packUnorm2x16) LAB_SAME(unpackUnorm2x16) LAB_SAME(packSnorm4x8) LAB_SAME(unpackSnorm4x8) LAB_SAME(ldexp)
#undef LAB_FLOATS
#undef LAB_NUMBERS
#undef LAB_SAME

    static float normalize(std::convertible_to<float> auto x) { return float(x) / glm::abs(float(x)); }  // GLM's takes no number
    template <typename A, typename B, typename Weight>
    static constexpr auto mix(const A& a, const B& b, const Weight& weight) {
        if constexpr (std::is_same_v<Component<Weight>, bool>)
            return glm::mix(as<Common<A, B>>(a), as<Common<A, B>>(b), weight);
        else
            return glm::mix(as<CommonFloat<A, B>>(a), as<CommonFloat<A, B>>(b), as<CommonFloat<A, B>>(weight));
    }
    // clang-format on
    // GLM's know no negative numbers: of those GLSL finds the highest 0, and extends the sign.
    template <typename T>
    static auto findMSB(const T& x) {
        return each([](auto bits) { return 31 - std::countl_zero(static_cast<uint>(bits < 0 ? ~bits : bits)); }, x);
    }
    template <typename T>
    static auto bitfieldReverse(const T& x) {
        return each([](auto bits) { return decltype(bits)(glm::bitfieldReverse(uint(bits))); }, x);
    }
    template <typename T>
    static auto bitfieldExtract(const T& x, int offset, int count) {
        return each([&](auto bits) { return count == 0 ? decltype(bits){} : bits << (32 - offset - count) >> (32 - count); }, x);
    }
    template <typename T>
    static auto abs(const T& x) {  // GLM's asks for the sign
        return each([](auto number) { return std::abs(number); }, x);
    }
    template <typename A, typename B, typename C>
    static auto fma(const A& a, const B& b, const C& c) {  // GLM's rounds twice
        return each([](auto x, auto y, auto z) { return std::fma(x, y, z); }, a, b, c);
    }
#define LAB_BITS(name, From, To)                                        \
    template <typename T>                                               \
    static constexpr auto name(const T& bits) {                         \
        return each([](From x) { return std::bit_cast<To>(x); }, bits); \
    }
    LAB_BITS(floatBitsToInt, float, int)
    LAB_BITS(floatBitsToUint, float, uint)
    LAB_BITS(intBitsToFloat, int, float)
    LAB_BITS(uintBitsToFloat, uint, float)
#undef LAB_BITS

    // Of the types of results, so that `out` arguments may be Copied.
    template <typename T>
    using Out = std::type_identity_t<T>&;
    template <typename T>
    static T modf(const T& x, Out<T> whole) {
        whole = glm::trunc(x);
        return x - whole;
    }
    template <typename T>
    static T frexp(const T& x, Out<decltype(each([](float) { return 0; }, T()))> exponent) {
        return glm::frexp(x, exponent);
    }
    template <typename A, typename T = decltype(each([](uint) { return 0u; }, A()))>
    static void umulExtended(const A& a, const std::type_identity_t<T>& b, Out<T> high, Out<T> low) {
        high = each([](uint x, uint y) { return static_cast<uint>(uint64_t{x} * y >> 32); }, as<uint>(a), b);
        low = as<uint>(a) * b;
    }
    template <typename T>
    static void imulExtended(const T& a, const T& b, Out<T> high, Out<T> low) {
        high = each([](int x, int y) { return static_cast<int>(int64_t{x} * y >> 32); }, a, b);
        low = each([](int x, int y) { return static_cast<int>(static_cast<uint>(x) * static_cast<uint>(y)); }, a, b);
    }
    template <typename T>
    static T uaddCarry(const T& a, const std::type_identity_t<T>& b, Out<T> carry) {
        carry = each([](uint x, uint y) { return x + y < x ? 1u : 0u; }, a, b);
        return a + b;
    }
    template <typename T>
    static T usubBorrow(const T& a, const std::type_identity_t<T>& b, Out<T> borrow) {
        borrow = each([](uint x, uint y) { return x < y ? 1u : 0u; }, a, b);
        return a - b;
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
    static constexpr T nonuniformEXT(T index) {
        return index;
    }
    static ivec2 textureSize(const Texture& texture, int) { return {texture.width, texture.height}; }
    static vec4 texelFetch(const Texture& texture, ivec2 position, int) {
        const Index index(position.x < 0 || position.x >= texture.width ? -1 : position.y * int64_t{texture.width} + position.x);
        const size_t i = 4 * index.in(static_cast<size_t>(texture.width) * texture.height);
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
    uvec3 gl_WorkGroupID, gl_LocalInvocationID, gl_GlobalInvocationID;
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
        for (uint i = 0; i < Shader::local_size; ++i) {
            Shader shader{{{}, bindings, uvec3(group, 0, 0), uvec3(i, 0, 0), uvec3(group * Shader::local_size + i, 0, 0), i}};
            shader.main_();
        }
    });
}

}  // namespace lab::native
