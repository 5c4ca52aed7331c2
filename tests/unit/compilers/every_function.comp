#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_samplerless_texture_functions : require
// What GLSL has, in one shader. Beside it is what newer compilers make of it: Debian 13 has glslang 15, and a later one is in its
// unstable branch. After a change, there:
//     glslangValidator -g -V --target-env vulkan1.2 every_function.comp -o glslang_15.spv
layout(local_size_x = 16) in;
layout(scalar, set = 0, binding = 1) buffer Results { float results[]; };
layout(scalar, set = 0, binding = 2) buffer Block { uint total; vec3 weight; mat3 turn; uvec2 rest[]; } block;
layout(set = 0, binding = 3) uniform texture2D picture;
layout(set = 0, binding = 4) uniform texture2D pictures[];
layout(scalar, push_constant) uniform Constants { uint first; } constants;

struct Part { float a; bool b; uvec2 c; };
struct Whole { Part parts[2]; mat2 m; };
const float table[4] = float[4](1.0, 0.5, 0.25, 0.125);
const Part fixed_parts[2] = Part[](Part(1.0, true, uvec2(2u)), Part(3.0, false, uvec2(4u, 5u)));
uint next = 0u;
void give(float x) { results[gl_GlobalInvocationID.x * 128u + next++] = x; }
void give(vec2 v) { give(v.x); give(v.y); }
void give(vec3 v) { give(v.xy); give(v.z); }
void give(vec4 v) { give(v.xy); give(v.zw); }
void give(uint x) { give(float(x & 0xffffu)); give(float(x >> 16)); }
void give(int x) { give(uint(x)); }
void give(bool b) { give(b ? 1.0 : 0.0); }
Part add(Part p, inout Part q) { q.a += p.a; if (q.b) return q; q.c.yx += p.c; return p; }
float[2] pair(float x) { return float[2](x, -x); }
void halve(inout vec2 v, out float before) { before = v.x; v *= 0.5; }

void functions(float x) {
    give(sin(x) + cos(x) * tan(x) + asin(x * 0.1) + acos(x * 0.1) + atan(x) + atan(x, 2.0));
    give(sinh(x) + cosh(x) + tanh(x) + asinh(x) + acosh(x + 1.0) + atanh(x * 0.01));
    give(pow(x, 1.5) + exp(x * 0.1) + log(x) + exp2(x * 0.1) + log2(x) + sqrt(x) + inversesqrt(x) + radians(x) + degrees(x));
    vec3 v = vec3(x, -1.5, 2.5), w = vec3(0.3, x, -0.7);
    give(abs(v) + sign(v) + floor(v) + trunc(v) + roundEven(v) + ceil(v) + fract(v) + mod(v, 0.7) + mod(v, vec3(2.0)));
    give(min(v, w) + max(v, 0.2) + clamp(v, w, vec3(9.0)) + mix(v, w, 0.25) + mix(v, w, lessThan(v, w)) + step(v, w));
    give(smoothstep(vec3(0.0), vec3(2.0), v) + fma(v, w, v) + ldexp(v, ivec3(1, 2, 3)));
    give(length(v) + distance(v, w) + dot(v, w));
    give(cross(v, w) + normalize(v) + faceforward(v, w, v) + reflect(v, normalize(w)) + refract(normalize(v), normalize(w), 0.9));
    give(isnan(x) || isinf(x));
    float whole;
    give(modf(-x - 0.25, whole));
    give(whole);
    vec3 parts;
    give(modf(v, parts) * 10.0 + parts);
    int power;
    give(frexp(x * 5.0, power));
    give(power);
    ivec2 powers;
    give(frexp(v.xy, powers));
    give(powers.y);
    give(unpackHalf2x16(packHalf2x16(v.xy)) + unpackUnorm2x16(packUnorm2x16(v.xy)) + unpackSnorm2x16(packSnorm2x16(w.xz)));
    give(unpackUnorm4x8(packUnorm4x8(vec4(w, 1.0))) + unpackSnorm4x8(packSnorm4x8(vec4(w, 1.0))));
}
void numbers(uint u) {
    int i = int(u) - 7;
    uint high, low;
    umulExtended(u * 0x80000001u, 6u, high, low);
    give(high + low);
    int above, below;
    imulExtended(i * 0x40000001, 9, above, below);
    give(above + below);
    give(uaddCarry(u, ~0u, high) + high + usubBorrow(u, 9u, low) + low);
    give(bitfieldInsert(u, 5u, 3, 4) + bitfieldReverse(u) + uint(bitCount(u) + findLSB(u) + findMSB(u) + findMSB(i)));
    give(bitfieldExtract(i, 1, 5) + int(bitfieldExtract(u, 1, 2)) + i / 3 + i % 3 + abs(i) + sign(i) + clamp(i, -2, 2) + max(i, 3));
    give((u << 3) ^ (u >> 1u) | (u & 6u) + ~u + u / 3u + u % 3u + min(u, 4u));
    give(-i + (i >> 1) + floatBitsToInt(float(i)) + int(floatBitsToUint(1.5)) + int(uintBitsToFloat(0x40400000u)));
    give(any(equal(uvec2(u), uvec2(3u, 4u))) && !all(notEqual(ivec2(i), ivec2(u))) || u > 5u ^^ i < 0);
    give(vec3(lessThanEqual(uvec3(u), uvec3(1u, 2u, 3u))) + vec3(greaterThan(vec3(i), vec3(0.0))) + vec3(not(bvec3(u < 4u))));
    give(atomicAdd(block.rest[u].x, 2u) + atomicMax(block.rest[u].y, u) + atomicExchange(block.rest[u].x, 7u));
    give(atomicCompSwap(block.rest[u].x, 7u, 8u) + uint(block.rest.length()));
}
void values(uint u, float x) {
    Part p = Part(x, u < 3u, uvec2(u, 2u)), q = fixed_parts[u & 1u];
    p = add(p, q);
    Whole whole;
    whole.parts[0] = whole.parts[1] = p;
    whole.parts[u & 1u] = q;
    whole.m = mat2(x, 2.0, 3.0, 4.0);
    whole.m[u & 1u].y *= 2.0;
    Whole other = whole;
    give(other == whole);
    give(other.parts[1].b);
    give(other.parts[1].c.y);
    give((other.m * vec2(x, 1.0) + vec2(1.0, x) * other.m) * determinant(other.m));
    give(inverse(other.m)[1] + transpose(other.m)[0] + (other.m * mat2(2.0))[1] + outerProduct(vec2(x), vec2(1.0, 2.0))[1]);
    give(block.turn * block.weight);
    float list[4] = table;
    list[u & 3u] += x;
    give(list[1] + pair(x)[1] + table[u & 3u] + float(list.length()));
    vec2 v = vec2(x, 3.0);
    float before;
    halve(v.yx, before);
    give(v * before);
    give(texelFetch(picture, ivec2(u & 1u, 1), 0) + texelFetchOffset(picture, ivec2(0, u & 1u), 0, ivec2(1, 0)));
    give(texelFetch(pictures[1], ivec2(u & 1u), 0).xy + vec2(textureSize(picture, 0)));
}
void statements(uint u) {
    float sum = 0.0;
    for (uint i = 0u; i < 6u; ++i) {
        switch (i + u) {
            case 1u: continue;
            case 3u: sum += 1.0;
            case 4u: sum += 2.0; break;
            default: sum += 4.0;
        }
        if (sum > 9.0) break;
    }
    int turns = 0;
    do { ++turns; if (turns == 2) continue; } while (turns < 4);
    while (turns > 0) turns -= 3;
    give(sum + float(turns));
    give(u > 2u && next++ < 9u ? sum : u < 5u ? 2.0 : 3.0);
}
void main() {
    uint u = gl_LocalInvocationIndex + constants.first;
    functions(float(u) * 0.37 + 0.5);
    numbers(u);
    values(u, float(gl_WorkGroupID.x + u));
    statements(u + gl_NumWorkGroups.x);
}
