// Eight or sixteen invocations of a translated shader at once, a lane of the CPU's vectors for each. A number that differs
// between them is a `Lanes`, and GLSL's operators work on it:
//
//     vec3 x = origin + t * direction;            // GLSL
//     V<vec3> x = origin + t * direction;         // three vectors of eight floats, if origin, t or direction differs
//     vec3 x = origin + t * direction;            // if none does: computed once, for all
//
// Comparisons give a Mask, which statements.h uses for branches and loops. Needs AVX2.
#pragma once
#include <algorithm>
#include <cstring>

#include "native/glsl.h"
#include "native/lanes/vectors.h"

namespace lab::native {
// Outside of lanes, so that functions of structures are not looked up there.
template <typename T>
using Uniform = T;
}  // namespace lab::native

namespace lab::native::lanes {

using namespace native;

inline constexpr int invocations_at_once = lane_count;

// A float, int, uint or bool for each invocation; a bool is 0 or -1.
template <typename T>
struct Lanes {
    using Word = std::conditional_t<std::is_same_v<T, bool>, int32_t, T>;
    typedef Word Raw __attribute__((vector_size(4 * lane_count)));
    Raw raw;

    Lanes() = default;
    template <typename U>
    requires std::is_arithmetic_v<U> LAB_INLINE Lanes(U x)
        : raw(static_cast<Word>(std::is_same_v<T, bool> ? -static_cast<Word>(x != 0) : static_cast<Word>(x)) - Raw{}) {}
    template <typename U>
    LAB_INLINE Lanes(const Lanes<U>& x) {
        if constexpr (std::is_same_v<T, U>)
            raw = x.raw;
        else if constexpr (std::is_same_v<T, bool>)
            raw = x.raw != 0;
        else if constexpr (std::is_same_v<U, bool>)
            raw = __builtin_convertvector(x.raw & 1, Raw);
        else
            raw = __builtin_convertvector(x.raw, Raw);
    }
    LAB_INLINE static Lanes of(Raw raw) {
        Lanes lanes;
        lanes.raw = raw;
        return lanes;
    }
    LAB_INLINE T operator[](int lane) const { return static_cast<T>(raw[lane]); }
    LAB_INLINE void set(int lane, T x) { raw[lane] = std::is_same_v<T, bool> ? -static_cast<Word>(x) : x; }
};
using Mask = Lanes<bool>;

LAB_INLINE uint32_t bits_of(const Mask& mask) { return signs(mask.raw); }
LAB_INLINE bool any(const Mask& mask) { return bits_of(mask) != 0; }
template <typename F>
LAB_INLINE void for_each_lane(const Mask& mask, const F& f) {
    for (uint32_t bits = bits_of(mask); bits != 0; bits &= bits - 1) f(std::countr_zero(bits));
}

// Vectors and matrices of lanes: the x of all invocations side by side, then the y, so that adding two takes an instruction for
// each component.
template <int n, typename T>
struct Vec;
template <typename T>
inline constexpr int size_of = 1;
template <length_t n, typename T, qualifier q>
inline constexpr int size_of<vec<n, T, q>> = n;
template <int n, typename T>
inline constexpr int size_of<Vec<n, T>> = n;
template <typename T>
inline constexpr bool is_lanes = false;
template <typename T>
inline constexpr bool is_lanes<Lanes<T>> = true;
template <int n, typename T>
inline constexpr bool is_lanes<Vec<n, T>> = true;
template <typename T>
inline constexpr bool is_number = std::is_arithmetic_v<T> || size_of<T> != 1 || is_lanes<T>;
// Numbers of which some differ between lanes.
template <typename... T>
concept Varying = (is_number<T> && ...) && (is_lanes<T> || ...);

template <int n, typename T>
struct Vec {
    T components[n];
    static constexpr int length() { return n; }
    LAB_INLINE T& operator[](int i) { return components[i]; }
    LAB_INLINE const T& operator[](int i) const { return components[i]; }
    Vec() = default;
    template <typename U>
    requires(size_of<U> == n) LAB_INLINE Vec(const U& u) {
        for (int i = 0; i < n; ++i) components[i] = T(u[i]);
    }
};
template <int columns, int rows>
struct Mat {
    using Column = Vec<rows, Lanes<float>>;
    Column column[columns];
    Mat() = default;
    template <typename M>
    requires requires(const M& m) { m[0][0]; }
    LAB_INLINE Mat(const M& m) {
        for (int i = 0; i < columns; ++i) column[i] = Column(m[i]);
    }
    static constexpr int length() { return columns; }
    LAB_INLINE Column& operator[](int i) { return column[i]; }
    LAB_INLINE const Column& operator[](int i) const { return column[i]; }
};
template <typename T>
inline constexpr bool is_matrix = native::is_matrix<T>;
template <int n, int m>
inline constexpr bool is_matrix<Mat<n, m>> = true;

template <typename T>
inline constexpr bool is_varying = is_lanes<T>;
template <int n, int m>
inline constexpr bool is_varying<Mat<n, m>> = true;

// V<T> is the type of a T that differs between lanes: V<float> is Lanes<float>, V<vec3> is Vec<3, Lanes<float>>, and a structure
// has a variant of which all members differ.
template <typename T>
struct VaryingOf {};
template <typename T>
requires requires { typename T::VaryingStruct__; }
struct VaryingOf<T> {
    using type = typename T::VaryingStruct__;
};
template <typename T>
requires(std::is_arithmetic_v<T> && sizeof(T) <= 4) struct VaryingOf<T> {
    using type = Lanes<T>;
};
template <length_t n, typename T, qualifier q>
struct VaryingOf<vec<n, T, q>> {
    using type = Vec<n, Lanes<T>>;
};
template <length_t n, length_t m, qualifier q>
struct VaryingOf<mat<n, m, float, q>> {
    using type = Mat<n, m>;
};
template <typename T, size_t size>
struct VaryingOf<Array<T, size>> {
    using type = Array<typename VaryingOf<T>::type, size>;
    static_assert(sizeof(type) < 1 << 20, "an array of this size fits on the stack for one path only");
};
template <typename T>
requires is_varying<T>
struct VaryingOf<T> {
    using type = T;
};
template <>
struct VaryingOf<void> {
    using type = void;
};
template <typename T>
using V = typename VaryingOf<T>::type;
template <typename T>
LAB_INLINE auto varying(const T& x) {
    if constexpr (requires { typename VaryingOf<T>::type; })
        return V<T>(x);
    else
        return x;
}

// The number type that operands have in common: int * Lanes<float> multiplies floats.
template <typename T>
struct ElementOf {
    using type = T;
};
template <typename T>
struct ElementOf<Lanes<T>> {
    using type = T;
};
template <typename... T>
using Element = std::common_type_t<typename ElementOf<std::remove_cvref_t<T>>::type...>;

template <typename T>
LAB_INLINE decltype(auto) component(const T& x, int i) {
    if constexpr (size_of<T> == 1)
        return (x);
    else
        return (x[i]);
}
// Calls `f` for each component of vectors, or for scalars.
template <typename F, typename... T>
LAB_INLINE auto each(const F& f, const T&... x) {
    constexpr int n = std::max({size_of<T>...});
    if constexpr (n == 1) {
        return f(x...);
    } else {
        Vec<n, decltype(f(component(x, 0)...))> result;
        for (int i = 0; i < n; ++i) result[i] = f(component(x, i)...);
        return result;
    }
}
#define LAB_OPERATOR(op, ...)                                                    \
    template <typename A, typename B>                                            \
    requires Varying<A, B> LAB_INLINE auto operator op(const A& a, const B& b) { \
        return each(                                                             \
            []<typename X, typename Y>(const X& x, const Y& y) {                 \
                using T = Element<__VA_ARGS__>;                                  \
                return Lanes<T>::of(Lanes<T>(x).raw op Lanes<T>(y).raw);         \
            },                                                                   \
            a, b);                                                               \
    }
LAB_OPERATOR(+, X, Y)
LAB_OPERATOR(-, X, Y)
LAB_OPERATOR(*, X, Y)
LAB_OPERATOR(/, X, Y)  // of floats
LAB_OPERATOR(&, X, Y)
LAB_OPERATOR(|, X, Y)
LAB_OPERATOR(^, X, Y)
LAB_OPERATOR(<<, X)
LAB_OPERATOR(>>, X)
#undef LAB_OPERATOR
#define LAB_COMPARISON(name, op)                                                             \
    template <typename A, typename B>                                                        \
    LAB_INLINE auto name(const A& a, const B& b) {                                           \
        return each(                                                                         \
            []<typename X, typename Y>(const X& x, const Y& y) {                             \
                return Mask::of(Lanes<Element<X, Y>>(x).raw op Lanes<Element<X, Y>>(y).raw); \
            },                                                                               \
            a, b);                                                                           \
    }
LAB_COMPARISON(less, <)
LAB_COMPARISON(less_or_equal, <=)
LAB_COMPARISON(equal, ==)
#undef LAB_COMPARISON
template <typename T>
LAB_INLINE Mask all(const T& x) {
    Mask result = component(x, 0);
    for (int i = 1; i < size_of<T>; ++i) result = result & x[i];
    return result;
}
LAB_INLINE Mask operator!(const Mask& a) { return Mask::of(~a.raw); }
#define LAB_OPERATOR(op, ...)         \
    template <typename A, typename B> \
    requires Varying<A, B> LAB_INLINE Mask operator op(const A& a, const B& b) { return __VA_ARGS__; }
LAB_OPERATOR(<, less(a, b))
LAB_OPERATOR(>, less(b, a))
LAB_OPERATOR(<=, less_or_equal(a, b))
LAB_OPERATOR(>=, less_or_equal(b, a))
LAB_OPERATOR(==, all(equal(a, b)))
LAB_OPERATOR(!=, !all(equal(a, b)))
#undef LAB_OPERATOR
#define LAB_OPERATOR(op)                                                                      \
    template <typename A>                                                                     \
    requires Varying<A> LAB_INLINE auto operator op(const A& a) {                             \
        return each([]<typename T>(const Lanes<T>& x) { return Lanes<T>::of(op x.raw); }, a); \
    }
LAB_OPERATOR(+)
LAB_OPERATOR(-)
LAB_OPERATOR(~)
#undef LAB_OPERATOR

// Products of matrices with each other, with vectors and with numbers. Sums begin with the last product, as one by one.
template <typename A, typename B>
LAB_INLINE auto multiply(const A& a, const B& b) {
    if constexpr (is_matrix<A> && is_matrix<B>) {
        Mat<B::length(), std::remove_cvref_t<decltype(a[0])>::length()> result;
        for (int i = 0; i < B::length(); ++i) result[i] = multiply(a, b[i]);
        return result;
    } else if constexpr (is_matrix<A> && size_of<B> == 1) {
        Mat<A::length(), std::remove_cvref_t<decltype(a[0])>::length()> result;
        for (int i = 0; i < A::length(); ++i) result[i] = a[i] * b;
        return result;
    } else if constexpr (is_matrix<A>) {
        auto sum = a[A::length() - 1] * b[A::length() - 1];
        for (int i = A::length() - 1; i-- > 0;) sum = a[i] * b[i] + sum;
        return sum;
    } else {
        Vec<B::length(), Lanes<float>> result;
        for (int i = 0; i < B::length(); ++i) {
            result[i] = b[i][size_of<A> - 1] * a[size_of<A> - 1];
            for (int j = size_of<A> - 1; j-- > 0;) result[i] = b[i][j] * a[j] + result[i];
        }
        return result;
    }
}

}  // namespace lab::native::lanes
