// Triangles to build trees from, and comparison of two trees.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "tracing/bvh.h"

namespace lab {

inline BvhTriangle make_triangle(const vec3& a, const vec3& b, const vec3& c, size_t id) {
    const mat3 rows = glm::transpose(mat3(a, b, c));
    return {rows[0], 0, rows[1], static_cast<uint32_t>(id), rows[2], 0};
}

// Triangles of size `extent` in a cube of size 1, times `scale`.
inline std::vector<BvhTriangle> random_triangles(size_t count, float extent, float scale = 1) {
    std::mt19937 generator(1);
    std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
    const auto point = [&] {
        const float x = uniform(generator), y = uniform(generator);
        return vec3(x, y, uniform(generator));
    };
    std::vector<BvhTriangle> triangles;
    for (size_t i = 0; i < count; ++i) {
        const vec3 centre = point();
        const vec3 a = centre + extent * point(), b = centre + extent * point(), c = centre + extent * point();
        triangles.push_back(make_triangle(scale * a, scale * b, scale * c, i));
    }
    return triangles;
}

// A height field of 2 width^2 triangles.
inline std::vector<BvhTriangle> height_field(size_t width) {
    const auto vertex = [&](size_t i, size_t j) {
        const float x = static_cast<float>(i) / static_cast<float>(width);
        const float z = static_cast<float>(j) / static_cast<float>(width);
        return vec3(x, 0.1f * std::sin(9 * x) * std::cos(7 * z), z);
    };
    std::vector<BvhTriangle> triangles;
    for (size_t i = 0; i < width; ++i)
        for (size_t j = 0; j < width; ++j) {
            triangles.push_back(make_triangle(vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), triangles.size()));
            triangles.push_back(make_triangle(vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j), triangles.size()));
        }
    return triangles;
}

template <typename T>
bool same_bytes(const LargeArray<T>& a, const LargeArray<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

inline void expect_same(const Bvh& a, const Bvh& b) {
    EXPECT_TRUE(same_bytes(a.nodes, b.nodes));
    EXPECT_TRUE(same_bytes(a.triangles, b.triangles));
}

}  // namespace lab
