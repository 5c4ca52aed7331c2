// GLSL's functions for lanes, and what all translated shaders have there.
#pragma once
#include "native/lanes/statements.h"

namespace lab::native::lanes {

// What a function gives that is called for each lane by itself.
template <typename T>
LAB_INLINE auto lane_of(const T& x, int lane) {
    if constexpr (is_varying<T> && is_matrix<T>) {
        mat<T::length(), T::Column::length(), float> result;
        for (int i = 0; i < T::length(); ++i) result[i] = lane_of(x[i], lane);
        return result;
    } else if constexpr (is_lanes<T> && size_of<T> == 1) {
        return x[lane];
    } else if constexpr (is_lanes<T>) {
        vec<size_of<T>, typename ElementOf<std::remove_cvref_t<decltype(x[0])>>::type> result;
        for (int i = 0; i < size_of<T>; ++i) result[i] = x[i][lane];
        return result;
    } else {
        return x;
    }
}
template <typename T, typename U>
LAB_INLINE void set_lane(T& target, int lane, const U& value) {
    if constexpr (std::is_arithmetic_v<U>)
        target.set(lane, value);
    else
        for (int i = 0; i < U::length(); ++i) set_lane(target[i], lane, value[i]);
}
template <typename F, typename... T>
LAB_INLINE auto by_lane(const F& f, const T&... x) {
    V<decltype(f(lane_of(x, 0)...))> result;
    for (int lane = 0; lane < lane_count; ++lane) set_lane(result, lane, f(lane_of(x, lane)...));
    return result;
}
// The upper half of a product.
template <typename T>
LAB_INLINE Lanes<T> product_above(const Lanes<T>& a, const Lanes<T>& b) {
    typedef decltype(wide(T())) Wide __attribute__((vector_size(4 * lane_count)));
    const Wide p = reinterpret_cast<Wide>(a.raw), q = reinterpret_cast<Wide>(b.raw);
    const Wide even = (p << 32 >> 32) * (q << 32 >> 32), odd = (p >> 32) * (q >> 32);
    constexpr auto high_half = static_cast<decltype(wide(T()))>(~uint64_t{0} << 32);
    typedef uint64_t Unsigned __attribute__((vector_size(4 * lane_count)));
    const Wide low = reinterpret_cast<Wide>(reinterpret_cast<Unsigned>(even) >> 32);
    return Lanes<T>::of(reinterpret_cast<typename Lanes<T>::Raw>(low | (odd & high_half)));
}

LAB_INLINE Floats arc_tangent(Floats x) { return LAB_LIBMVEC(v_atanf)(x); }
LAB_INLINE Floats arc_tangent(Floats y, Floats x) { return LAB_LIBMVEC(vv_atan2f)(y, x); }

struct Builtins : native::Builtins {
    using Plain = native::Builtins;
    using Float = const Lanes<float>&;
    template <typename F, typename... T>
    LAB_INLINE static Lanes<float> by_vector(const F& f, const T&... x) {
        return Lanes<float>::of(f(Lanes<float>(x).raw...));
    }

    // Functions of each component, of whole vectors, and those that are called for each lane by itself.
#define LAB_FUNCTION(name, ...)                  \
    template <typename... T>                     \
    LAB_INLINE static auto name(const T&... x) { \
        if constexpr ((is_varying<T> || ...))    \
            return __VA_ARGS__;                  \
        else                                     \
            return Plain::name(x...);            \
    }
#define LAB_EACH(name, ...) LAB_FUNCTION(name, each(__VA_ARGS__, x...))
#define LAB_WHOLE(name, ...) LAB_FUNCTION(name, (__VA_ARGS__)(x...))
#define LAB_ALONE(name) LAB_FUNCTION(name, by_lane([](const auto&... y) { return Plain::name(y...); }, x...))
#define LAB_VECTOR(name, function) \
    LAB_EACH(name, [](const auto&... y) { return by_vector([](auto... z) { return function; }, y...); })
    // clang-format off
    LAB_ALONE(radians) LAB_ALONE(degrees) LAB_ALONE(asin) LAB_ALONE(acos) LAB_ALONE(sinh)
    LAB_ALONE(cosh) LAB_ALONE(tanh) LAB_ALONE(asinh) LAB_ALONE(acosh) LAB_ALONE(atanh) LAB_ALONE(exp2) LAB_ALONE(log2)
    LAB_ALONE(trunc) LAB_ALONE(round) LAB_ALONE(roundEven) LAB_ALONE(ceil) LAB_ALONE(smoothstep) LAB_ALONE(isnan)
    LAB_ALONE(isinf) LAB_ALONE(sign) LAB_ALONE(bitCount) LAB_ALONE(findLSB) LAB_ALONE(findMSB) LAB_ALONE(bitfieldExtract)
    LAB_ALONE(bitfieldInsert) LAB_ALONE(ldexp) LAB_ALONE(fma) LAB_ALONE(step) LAB_ALONE(mod) LAB_ALONE(outerProduct)
    LAB_ALONE(determinant) LAB_ALONE(inverse) LAB_ALONE(quotient) LAB_ALONE(remainder) LAB_ALONE(packHalf2x16)
    LAB_ALONE(unpackHalf2x16) LAB_ALONE(packUnorm4x8) LAB_ALONE(unpackUnorm4x8) LAB_ALONE(packUnorm2x16)
    LAB_ALONE(unpackUnorm2x16) LAB_ALONE(packSnorm4x8) LAB_ALONE(unpackSnorm4x8) LAB_ALONE(packSnorm2x16)
    LAB_ALONE(unpackSnorm2x16) LAB_ALONE(carry) LAB_ALONE(borrow) LAB_ALONE(rest) LAB_ALONE(fraction) LAB_ALONE(exponent)
    LAB_VECTOR(sin, LAB_LIBMVEC(v_sinf)(z...)) LAB_VECTOR(cos, LAB_LIBMVEC(v_cosf)(z...)) LAB_VECTOR(exp, LAB_LIBMVEC(v_expf)(z...))
    LAB_VECTOR(tan, LAB_LIBMVEC(v_tanf)(z...)) LAB_VECTOR(atan, arc_tangent(z...))
    LAB_VECTOR(log, LAB_LIBMVEC(v_logf)(z...)) LAB_VECTOR(pow, LAB_LIBMVEC(vv_powf)(z...)) LAB_VECTOR(sqrt, square_root(z...))
    LAB_EACH(floor, [](Float a) { return by_vector([](Floats z) { return round_down(z); }, a); })
    LAB_EACH(inversesqrt, [](Float a) { return 1.0f / sqrt(a); })
    LAB_EACH(fract, [](Float a) { return a - floor(a); })
    LAB_EACH(min, [](const auto& a, const auto& b) { return lanes::select(less(b, a), b, a); })
    LAB_EACH(max, [](const auto& a, const auto& b) { return lanes::select(less(a, b), b, a); })
    LAB_EACH(clamp, [](const auto& a, const auto& low, const auto& high) { return min(max(a, low), high); })
    LAB_EACH(lessThan, [](const auto& a, const auto& b) { return less(a, b); })
    LAB_EACH(lessThanEqual, [](const auto& a, const auto& b) { return less_or_equal(a, b); })
    LAB_EACH(greaterThan, [](const auto& a, const auto& b) { return less(b, a); })
    LAB_EACH(greaterThanEqual, [](const auto& a, const auto& b) { return less_or_equal(b, a); })
    LAB_EACH(equal, [](const auto& a, const auto& b) { return lanes::equal(a, b); })
    LAB_EACH(notEqual, [](const auto& a, const auto& b) { return !lanes::equal(a, b); })
    LAB_EACH(not_, [](const Mask& a) { return !a; })
    LAB_EACH(both, [](const Mask& a, const Mask& b) { return a & b; })
    LAB_EACH(either, [](const Mask& a, const Mask& b) { return a | b; })
    LAB_EACH(negate, [](const auto& a) { return -a; })
    LAB_EACH(flip, [](const auto& a) { return ~a; })
    LAB_EACH(abs, []<typename U>(const Lanes<U>& a) {
        if constexpr (std::is_same_v<U, float>)
            return bits<float>(bits<int>(a) & 0x7fffffff);
        else
            return lanes::select(less(a, 0), -a, a);
    })
    LAB_EACH(mix, [](const auto& a, const auto& b, const auto& weight) { return a * (1.0f - weight) + b * weight; })
    LAB_EACH(bitfieldReverse, []<typename U>(const Lanes<U>& a) {
        return Lanes<U>::of(reinterpret_cast<typename Lanes<U>::Raw>(reverse_bits(reinterpret_cast<Integers>(a.raw))));
    })
    LAB_EACH(upper_half, []<typename A, typename B>(const A& a, const B& b) {
        using Number = Lanes<Element<A, B>>;
        return product_above(Number(a), Number(b));
    })
    LAB_WHOLE(multiply, [](const auto& a, const auto& b) { return lanes::multiply(a, b); })
    LAB_WHOLE(all, [](const auto& a) { return lanes::all(a); })
    LAB_WHOLE(any, [](const auto& a) { return !lanes::all(each([](const Mask& b) { return !b; }, a)); })
    LAB_WHOLE(dot, [](const auto& a, const auto& b) {
        const auto product = a * b;
        constexpr int n = size_of<std::remove_const_t<decltype(product)>>;
        Lanes<float> sum = component(product, 0);
        for (int i = 1; i < n; ++i) sum = sum + component(product, i);
        return sum;
    })
    LAB_WHOLE(length, [](const auto& a) {
        if constexpr (size_of<std::remove_cvref_t<decltype(a)>> == 1)
            return abs(a);
        else
            return sqrt(dot(a, a));
    })
    LAB_WHOLE(distance, [](const auto& a, const auto& b) { return length(b - a); })
    LAB_WHOLE(normalize, [](const auto& a) { return a * inversesqrt(dot(a, a)); })
    LAB_WHOLE(reflect, [](const auto& i, const auto& n) { return i - n * dot(n, i) * 2.0f; })
    LAB_WHOLE(cross, [](const auto& a, const auto& b) {
        return make<vec3>(a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]);
    })
    LAB_WHOLE(faceforward, [](const auto& n, const auto& i, const auto& side) { return lanes::select(dot(side, i) < 0.0f, n, -n); })
    LAB_WHOLE(refract, [](const auto& i, const auto& n, const auto& eta) {
        const Lanes<float> cosine = dot(n, i), k = 1.0f - eta * eta * (1.0f - cosine * cosine);
        return lanes::select(k < 0.0f, i * 0.0f, i * eta - n * (eta * cosine + sqrt(k)));
    })
    LAB_WHOLE(transpose, []<typename M>(const M& a) {
        Mat<M::Column::length(), M::length()> result;
        for (int i = 0; i < M::length(); ++i)
            for (int j = 0; j < M::Column::length(); ++j) result[j][i] = a[i][j];
        return result;
    })
#undef LAB_EACH
#undef LAB_WHOLE
#undef LAB_ALONE
#undef LAB_VECTOR
#undef LAB_FUNCTION
        // clang-format on

        template <typename C, typename A, typename B>
        LAB_INLINE static auto select(const C& condition, const A& a, const B& b) {
        if constexpr (!is_varying<C> && std::is_same_v<A, B> && (size_of<C> == 1 || !is_varying<A>))
            return Plain::select(condition, a, b);
        else if constexpr (is_varying<C> && size_of<C> == 1)
            return lanes::select(condition, a, b);
        else if constexpr (is_varying<C> || size_of<C> > 1)
            return each([](const Mask& c, const auto& y, const auto& z) { return lanes::select(c, y, z); }, condition, a, b);
        else
            return condition ? varying(a) : varying(b);
    }
    LAB_INLINE static ivec2 textureSize(const Texture& texture) { return Plain::textureSize(texture); }

    // These ask which lanes are active.
#define LAB_ATOMIC(name)                                                                          \
    template <typename T, typename... U>                                                          \
    LAB_INLINE static V<T> name(const Mask& active, const Ref<T>& target, const U&... operands) { \
        V<T> before;                                                                              \
        for_each_lane(active, [&](int lane) {                                                     \
            T& word = reinterpret_cast<T*>(target.base)[target.word(lane)];                       \
            before.set(lane, Plain::name(word, lane_of(operands, lane)...));                      \
        });                                                                                       \
        return before;                                                                            \
    }
    LAB_ATOMIC(atomicAdd)
    LAB_ATOMIC(atomicMin)
    LAB_ATOMIC(atomicMax)
    LAB_ATOMIC(atomicAnd)
    LAB_ATOMIC(atomicOr)
    LAB_ATOMIC(atomicXor)
    LAB_ATOMIC(atomicExchange)
    LAB_ATOMIC(atomicCompSwap)
#undef LAB_ATOMIC
    template <typename T, typename P>
    LAB_INLINE static auto texelFetch(const Mask& active, const T& texture, const P& position) {
        if constexpr (!is_ref<T> && !is_varying<P>) {
            return Plain::texelFetch(texture, position);
        } else {
            V<vec4> result;
            for_each_lane(active, [&](int lane) {
                const Texture* chosen;
                if constexpr (is_ref<T>)
                    chosen = &texture.base[texture.word(lane) / word_count<Texture>];
                else
                    chosen = &texture;
                set_lane(result, lane, Plain::texelFetch(*chosen, lane_of(position, lane)));
            });
            return result;
        }
    }
};

struct ShaderBase : Builtins {
    const Bindings& bindings;
    uvec3 gl_NumWorkGroups, gl_WorkGroupID;
    V<uvec3> gl_LocalInvocationID, gl_GlobalInvocationID;
    V<uint> gl_LocalInvocationIndex;

    // By Embree, see shaders/engine/trace_ray/embree.glsl.
    LAB_INLINE Mask native_closest_hit(const Mask& active, const V<vec3>& origin, const V<vec3>& direction, const V<float>& t_max,
                                       V<uint>& instance, V<uint>& triangle, V<vec2>& barycentrics, V<float>& distance) const {
        RayPacket packet = packet_of(active, origin, direction, t_max);
        bindings.rays->find_closest_hits(packet);
        instance.raw = packet.instance;
        triangle.raw = packet.triangle;
        for (int i = 0; i < 2; ++i) barycentrics[i].raw = packet.barycentrics[i];
        distance.raw = packet.t_max;
        return Mask::of(packet.is_active);
    }
    LAB_INLINE Mask native_any_hit(const Mask& active, const V<vec3>& origin, const V<vec3>& direction,
                                   const V<float>& t_max) const {
        RayPacket packet = packet_of(active, origin, direction, t_max);
        bindings.rays->find_any_hits(packet);
        return Mask::of(packet.is_active);
    }

  private:
    LAB_INLINE static RayPacket packet_of(const Mask& active, const V<vec3>& origin, const V<vec3>& direction,
                                          const V<float>& t_max) {
        RayPacket packet;
        for (int i = 0; i < 3; ++i) {
            packet.origin[i] = origin[i].raw;
            packet.direction[i] = direction[i].raw;
        }
        packet.t_min = packet.time = Floats{};
        packet.t_max = t_max.raw;
        packet.mask = ~Words{};
        packet.flags = Words{};
        packet.is_active = active.raw;
        return packet;
    }
};

// The program's way in.
template <typename Shader>
Outcome run_group(const Bindings& bindings, uint32_t group, char* error, size_t error_size) {
    return native::run_group(error, error_size, [&] {
        for (uint first = 0; first < Shader::local_size__; first += lane_count) {
            Lanes<uint> index;
            for (uint lane = 0; lane < lane_count; ++lane) index.set(static_cast<int>(lane), first + lane);
            const V<uvec3> local = make<uvec3>(index, 0u, 0u), global = make<uvec3>(index + group * Shader::local_size__, 0u, 0u);
            Shader shader{{{}, bindings, uvec3(bindings.group_count, 1, 1), uvec3(group, 0, 0), local, global, index}};
            shader.main__(index < Shader::local_size__);
        }
    });
}

}  // namespace lab::native::lanes
