// GLSL's functions for lanes, and what all translated shaders have there.
#pragma once
#include "native/lane_statements.h"

namespace lab::native::lanes {

// Of what is not below, only calls with uniform arguments are known.
struct Builtins : native::Builtins {
    using Plain = native::Builtins;
    using Float = const Lanes<float>&;
    template <typename To, typename T>
    LAB_INLINE static Lanes<To> bits_as(const Lanes<T>& x) {
        return Lanes<To>::of(reinterpret_cast<typename Lanes<To>::Raw>(x.raw));
    }
    template <typename F, typename... T>
    LAB_INLINE static Lanes<float> by_vector(const F& f, const T&... x) {
        return Lanes<float>::of(f(Lanes<float>(x).raw...));
    }

    // Functions of each component. What is not below is called for each lane by itself.
#define LAB_EACH(name, each_of, ...)             \
    template <typename... T>                     \
    LAB_INLINE static auto name(const T&... x) { \
        if constexpr (Varying<T...>)             \
            return each_of(__VA_ARGS__, x...);   \
        else                                     \
            return Plain::name(x...);            \
    }
#define LAB_ALONE(name) LAB_EACH(name, each_alone, [](auto... y) { return Plain::name(y...); })
#define LAB_VECTOR(name, function) \
    LAB_EACH(name, each, [](const auto&... y) { return by_vector([](auto... z) { return function; }, y...); })
    // clang-format off
    LAB_ALONE(radians) LAB_ALONE(degrees) LAB_ALONE(tan) LAB_ALONE(asin) LAB_ALONE(acos) LAB_ALONE(atan) LAB_ALONE(sinh)
    LAB_ALONE(cosh) LAB_ALONE(tanh) LAB_ALONE(asinh) LAB_ALONE(acosh) LAB_ALONE(atanh) LAB_ALONE(exp2) LAB_ALONE(log2)
    LAB_ALONE(trunc) LAB_ALONE(round) LAB_ALONE(roundEven) LAB_ALONE(ceil) LAB_ALONE(smoothstep) LAB_ALONE(isnan)
    LAB_ALONE(isinf) LAB_ALONE(sign) LAB_ALONE(bitCount) LAB_ALONE(findLSB) LAB_ALONE(findMSB) LAB_ALONE(bitfieldExtract)
    LAB_ALONE(bitfieldInsert) LAB_ALONE(ldexp) LAB_ALONE(fma) LAB_ALONE(step) LAB_ALONE(mod)
    LAB_VECTOR(sin, LAB_LIBMVEC(v_sinf)(z...)) LAB_VECTOR(cos, LAB_LIBMVEC(v_cosf)(z...)) LAB_VECTOR(exp, LAB_LIBMVEC(v_expf)(z...))
    LAB_VECTOR(log, LAB_LIBMVEC(v_logf)(z...)) LAB_VECTOR(pow, LAB_LIBMVEC(vv_powf)(z...)) LAB_VECTOR(sqrt, square_root(z...))
    LAB_EACH(floor, each, [](Float a) { return by_vector([](Floats z) { return round_down(z); }, a); })
    LAB_EACH(inversesqrt, each, [](Float a) { return 1.0f / sqrt(a); })
    LAB_EACH(fract, each, [](Float a) { return a - floor(a); })
    LAB_EACH(min, each, [](const auto& a, const auto& b) { return select(less(b, a), b, a); })
    LAB_EACH(max, each, [](const auto& a, const auto& b) { return select(less(a, b), b, a); })
    LAB_EACH(clamp, each, [](const auto& a, const auto& low, const auto& high) { return min(max(a, low), high); })
    LAB_EACH(lessThan, each, [](const auto& a, const auto& b) { return less(a, b); })
    LAB_EACH(lessThanEqual, each, [](const auto& a, const auto& b) { return less_or_equal(a, b); })
    LAB_EACH(greaterThan, each, [](const auto& a, const auto& b) { return less(b, a); })
    LAB_EACH(greaterThanEqual, each, [](const auto& a, const auto& b) { return less_or_equal(b, a); })
    LAB_EACH(equal, each, [](const auto& a, const auto& b) { return lanes::equal(a, b); })
    LAB_EACH(notEqual, each, [](const auto& a, const auto& b) { return !lanes::equal(a, b); })
    LAB_EACH(not_, each, [](const Mask& a) { return !a; })
    LAB_EACH(floatBitsToInt, each, [](Float a) { return bits_as<int>(a); })
    LAB_EACH(floatBitsToUint, each, [](Float a) { return bits_as<uint>(a); })
    LAB_EACH(intBitsToFloat, each, [](const auto& a) { return bits_as<float>(a); })
    LAB_EACH(uintBitsToFloat, each, [](const auto& a) { return bits_as<float>(a); })
    LAB_EACH(abs, each, []<typename U>(const Lanes<U>& a) {
        if constexpr (std::is_same_v<U, float>)
            return bits_as<float>(bits_as<int>(a) & 0x7fffffff);
        else
            return select(less(a, 0), -a, a);
    })
    LAB_EACH(mix, each, []<typename W>(const auto& a, const auto& b, const W& weight) {
        if constexpr (std::is_same_v<Element<W>, bool>)
            return select(weight, b, a);
        else
            return a * (1.0f - weight) + b * weight;
    })
    LAB_EACH(bitfieldReverse, each, []<typename U>(const Lanes<U>& a) {
        const auto swap = [](const Lanes<uint>& bits, uint mask, uint shift) {
            return ((bits >> shift) & mask) | ((bits & mask) << shift);
        };
        const Lanes<uint> bits = swap(swap(swap(a, 0x55555555u, 1u), 0x33333333u, 2u), 0x0f0f0f0fu, 4u);
        return Lanes<U>(swap(swap(bits, 0x00ff00ffu, 8u), 0x0000ffffu, 16u));
    })
#undef LAB_EACH
#undef LAB_ALONE
#undef LAB_VECTOR

    // Functions of whole vectors.
#define LAB_WHOLE(name, ...)                     \
    template <typename... T>                     \
    LAB_INLINE static auto name(const T&... x) { \
        if constexpr (Varying<T...>)             \
            return (__VA_ARGS__)(x...);          \
        else                                     \
            return Plain::name(x...);            \
    }
    LAB_WHOLE(all, [](const auto& a) { return lanes::all(a); })
    LAB_WHOLE(any, [](const auto& a) { return !lanes::all(each([](const Mask& b) { return !b; }, a)); })
    LAB_WHOLE(dot, [](const auto& a, const auto& b) {
        const auto product = a * b;
        constexpr int n = size_of<std::remove_const_t<decltype(product)>>;
        if constexpr (n == 4)  // as GLM adds them
            return (product[0] + product[1]) + (product[2] + product[3]);
        Lanes<float> sum = component(product, 0);
        for (int i = 1; i < n; ++i) sum = sum + component(product, i);
        return sum;
    })
    LAB_WHOLE(length, [](const auto& a) { return sqrt(dot(a, a)); })
    LAB_WHOLE(distance, [](const auto& a, const auto& b) { return length(b - a); })
    LAB_WHOLE(normalize, [](const auto& a) { return a * inversesqrt(dot(a, a)); })
    LAB_WHOLE(reflect, [](const auto& i, const auto& n) { return i - n * dot(n, i) * 2.0f; })
    LAB_WHOLE(cross, [](const auto& a, const auto& b) {
        return make<vec3>(a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]);
    })
    LAB_WHOLE(faceforward, [](const auto& n, const auto& i, const auto& side) { return select(dot(side, i) < 0.0f, n, -n); })
    LAB_WHOLE(refract, [](const auto& i, const auto& n, const auto& eta) {
        const Lanes<float> cosine = dot(n, i), k = 1.0f - eta * eta * (1.0f - cosine * cosine);
        return select(k < 0.0f, i * 0.0f, i * eta - n * (eta * cosine + sqrt(k)));
    });
#undef LAB_WHOLE
    // clang-format on

    template <typename M>
    LAB_INLINE static auto transpose(const M& a) {
        if constexpr (requires { a.column; }) {
            Mat<M::Column::length(), M::length()> result;
            for (int i = 0; i < M::length(); ++i)
                for (int j = 0; j < M::Column::length(); ++j) result[j][i] = a[i][j];
            return result;
        } else {
            return Plain::transpose(a);
        }
    }

    template <typename A, typename B, typename High, typename Low>
    LAB_INLINE static void umulExtended(const A& a, const B& b, High&& high, Low&& low) {
        typedef uint64_t Wide __attribute__((vector_size(4 * lane_count)));
        constexpr uint64_t low_half = 0xffffffffu;
        const auto top = each(
            [](const Lanes<uint>& x, const Lanes<uint>& y) {
                const Wide p = reinterpret_cast<Wide>(x.raw), q = reinterpret_cast<Wide>(y.raw);
                const Wide even = (p & low_half) * (q & low_half), odd = (p >> 32) * (q >> 32);
                return Lanes<uint>::of(reinterpret_cast<Lanes<uint>::Raw>((even >> 32) | (odd & ~low_half)));
            },
            a, b);
        low = varying(a) * b;
        high = top;
    }
    template <typename A, typename B, typename Carry>
    LAB_INLINE static auto uaddCarry(const A& a, const B& b, Carry&& carry) {
        const auto sum = varying(a) + b;
        carry = each([](const auto& x, const auto& y) { return Lanes<uint>(less(x, y)); }, sum, varying(a));
        return sum;
    }

    template <typename T>
    LAB_INLINE static T nonuniformEXT(const T& index) {
        return index;
    }
    LAB_INLINE static ivec2 textureSize(const Texture& texture, int level) { return Plain::textureSize(texture, level); }

    // These ask which lanes are active.
    template <typename T>
    LAB_INLINE static V<T> atomicAdd(const Mask& active, const Ref<T>& target, const V<T>& operand) {
        V<T> before;
        for_each_lane(active,
                      [&](int lane) { before.set(lane, Plain::atomicAdd(target.base[target.word(lane)], operand[lane])); });
        return before;
    }
    LAB_INLINE static V<vec4> texelFetch(const Mask& active, const Texture& texture, const V<ivec2>& position, int level) {
        return texelFetch(active, ref_to(texture, 0), position, level);
    }
    template <typename T>
    LAB_INLINE static V<vec4> texelFetch(const Mask& active, const Ref<T>& texture, const V<ivec2>& position, int level) {
        V<vec4> result;
        for_each_lane(active, [&](int lane) {
            const Texture& chosen = texture.base[texture.word(lane) / word_count<Texture>];
            const vec4 texel = Plain::texelFetch(chosen, ivec2(position.x[lane], position.y[lane]), level);
            for (int i = 0; i < 4; ++i) result[i].set(lane, texel[i]);
        });
        return result;
    }
};

struct ShaderBase : Builtins {
    const Bindings& bindings;
    uvec3 gl_WorkGroupID;
    V<uvec3> gl_LocalInvocationID, gl_GlobalInvocationID;
    V<uint> gl_LocalInvocationIndex;

    // By Embree, see shaders/engine/trace_ray/embree.glsl.
    LAB_INLINE Mask native_closest_hit(const Mask& active, const V<vec3>& origin, const V<vec3>& direction, const V<float>& t_max,
                                       V<uint>& instance, V<uint>& triangle, V<vec2>& barycentrics, V<float>& distance) const {
        RayPacket packet = packet_of(active, origin, direction, t_max);
        bindings.rays->find_closest_hits(packet);
        read(instance, packet.instance);
        read(triangle, packet.triangle);
        read(barycentrics.x, packet.barycentrics[0]);
        read(barycentrics.y, packet.barycentrics[1]);
        read(distance, packet.t_max);
        return hits_of(packet);
    }
    LAB_INLINE Mask native_any_hit(const Mask& active, const V<vec3>& origin, const V<vec3>& direction,
                                   const V<float>& t_max) const {
        RayPacket packet = packet_of(active, origin, direction, t_max);
        bindings.rays->find_any_hits(packet);
        return hits_of(packet);
    }

  private:
    template <typename T, typename Word>
    LAB_INLINE static void read(Lanes<T>& target, const Word* words) {
        std::memcpy(&target.raw, words, sizeof target.raw);
    }
    LAB_INLINE static Mask hits_of(const RayPacket& packet) {
        Mask hits;
        read(hits, packet.is_active);
        return hits;
    }
    LAB_INLINE static RayPacket packet_of(const Mask& active, const V<vec3>& origin, const V<vec3>& direction,
                                          const V<float>& t_max) {
        RayPacket packet;
        const auto write = [](auto* words, const auto& x) { std::memcpy(words, &x.raw, sizeof x.raw); };
        for (int i = 0; i < 3; ++i) {
            write(packet.origin[i], origin[i]);
            write(packet.direction[i], direction[i]);
        }
        write(packet.t_min, Lanes<float>(0.0f));
        write(packet.time, Lanes<float>(0.0f));
        write(packet.t_max, t_max);
        write(packet.mask, Lanes<uint>(~0u));
        write(packet.flags, Lanes<uint>(0u));
        write(packet.is_active, active);
        return packet;
    }
};

// The program's way in.
template <typename Shader>
Outcome run_group(const Bindings& bindings, uint32_t group, char* error, size_t error_size) {
    return native::run_group(error, error_size, [&] {
        for (uint first = 0; first < Shader::local_size; first += lane_count) {
            Lanes<uint> index;
            for (uint lane = 0; lane < lane_count; ++lane) index.set(static_cast<int>(lane), first + lane);
            const V<uvec3> local = make<uvec3>(index, 0u, 0u), global = make<uvec3>(index + group * Shader::local_size, 0u, 0u);
            Shader shader{{{}, bindings, uvec3(group, 0, 0), local, global, index}};
            shader.main_(index < Shader::local_size);
        }
    });
}

}  // namespace lab::native::lanes
