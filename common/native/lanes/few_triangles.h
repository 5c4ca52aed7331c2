// In a scene of a few triangles, the rays of lanes are tested against all of them: that takes less time than a tree.
#pragma once
#include "native/embree.h"

#ifdef LAB_FEW_TRIANGLES
#include "native/lanes/vectors.h"

namespace lab::native {

class FewTriangles final : public EmbreeTracer {
  public:
    static constexpr size_t limit = 5 * lane_count / 2;  // in scenes full of gaps, Embree is faster with more

    FewTriangles(const Triangle* triangles, size_t count) : EmbreeTracer(triangles, count) {
        for (size_t i = 0; i < count; ++i) planes_.emplace_back(triangles[i], unit_);
    }

    void find_closest_hits(RayPacket& packet) const override {
        to_units(packet);
        const Rays rays(packet);
        Hits closest = rays.ends(packet.t_max);
        Words primitive{};
        for (size_t i = 0; i < planes_.size(); ++i) {
            const Hits hits = rays.hits(planes_[i]);
            const Integers is_closer = hits.are_before(closest);
            primitive = is_closer ? Words{} + static_cast<uint32_t>(i) : primitive;
            closest.height = is_closer ? hits.height : closest.height;
            closest.speed = is_closer ? hits.speed : closest.speed;
            closest.sum = is_closer ? hits.sum : closest.sum;
            for (int j = 1; j < 3; ++j) closest.weights[j] = is_closer ? hits.weights[j] : closest.weights[j];
        }
        for (int i = 0; i < 2; ++i) packet.barycentrics[i] = closest.weights[i + 1] / closest.sum;
        packet.t_max = closest.height / closest.speed;
        packet.primitive = primitive;
        packet.is_active &= closest.sum != 0;
        to_scene(packet);
    }

    void find_any_hits(RayPacket& packet) const override {
        to_units(packet);
        const Rays rays(packet);
        const Hits ends = rays.ends(packet.t_max);
        const Integers is_active = packet.is_active;
        Integers is_hit{};
        for (const Plane& plane : planes_) {
            is_hit |= rays.hits(plane).are_before(ends);
            if (lanes::signs(is_active & ~is_hit) == 0) break;
        }
        packet.is_active = is_active & is_hit;
    }

  private:
    LAB_INLINE static Floats of(float x) { return x - Floats{}; }  // unlike a sum with 0, this costs nothing
    LAB_INLINE static Floats dot(const Floats (&a)[3], const Floats (&b)[3]) {
        return lanes::multiply_add(a[0], b[0], lanes::multiply_add(a[1], b[1], a[2] * b[2]));
    }

    // a b - c d, with an error of less than two units in the last place, and 0 only if it is (Jeannerod, Louvet, Muller: Further
    // analysis of Kahan's algorithm for the accurate computation of 2 x 2 determinants, 2013).
    LAB_INLINE static Floats difference(Floats a, Floats b, Floats c, Floats d) {
        const Floats product = c * d;
        return lanes::multiply_add(a, b, -product) + lanes::multiply_add(-c, d, product);
    }

    struct Plane {  // of a triangle
        float corners[3][3], normal[3];
        float base[3];  // the corner whose coordinates are rounded the least: as exactly as those of a hit, or more

        Plane(const Triangle& triangle, float unit) {
            const decltype(triangle.x)* rows[]{&triangle.x, &triangle.y, &triangle.z};
            double edges[2][3], cross[3];
            for (int axis = 0; axis < 3; ++axis) {
                for (int i = 0; i < 3; ++i) corners[i][axis] = rows[axis]->corners[i] * unit;
                for (int i = 0; i < 2; ++i) edges[i][axis] = double{corners[i + 1][axis]} - corners[0][axis];
            }
            for (int axis = 0; axis < 3; ++axis) {
                const int next = (axis + 1) % 3, last = (axis + 2) % 3;
                cross[axis] = edges[0][next] * edges[1][last] - edges[0][last] * edges[1][next];
            }
            const auto size = [this](int i) { return std::hypot(corners[i][0], corners[i][1], corners[i][2]); };
            const int closest = size(0) <= std::min(size(1), size(2)) ? 0 : size(1) <= size(2) ? 1 : 2;
            std::copy_n(corners[closest], 3, base);
            const double length = std::hypot(cross[0], cross[1], cross[2]);
            for (int axis = 0; axis < 3; ++axis) normal[axis] = length > 0 ? static_cast<float>(cross[axis] / length) : 0;
        }
    };

    struct Hits {
        Integers are_inside;
        Floats height, speed;    // of the origin over the plane, and of the way to it: their ratio is the distance
        Floats weights[3], sum;  // of the corners: barycentric coordinates times their sum

        // Compares distances without a division. Rays along the plane, whose speed is 0, hit nothing.
        LAB_INLINE Integers are_before(const Hits& others) const {
            return are_inside & (height > 0) & (height * others.speed < others.height * speed);
        }
    };

    struct Rays {
        Floats origin[3], direction[3];
        Floats x[3] = {}, y[3] = {};  // whose products with a position, relative to the origin, are where the ray sees it

        explicit Rays(const RayPacket& packet) {
            Floats sizes[3];
            Integers z[3];
            for (int axis = 0; axis < 3; ++axis) {
                origin[axis] = packet.origin[axis];
                direction[axis] = packet.direction[axis];
                sizes[axis] = direction[axis] < 0 ? -direction[axis] : direction[axis];
            }
            // Shears the ray into the axis that it follows the most.
            Integers is_left = ~Integers{};
            Floats along{}, across[2]{};
            for (int axis = 0; axis < 3; ++axis) {
                const int next = (axis + 1) % 3, last = (axis + 2) % 3;
                const Integers is_largest = is_left & (sizes[axis] >= sizes[next]) & (sizes[axis] >= sizes[last]);
                is_left &= ~is_largest;
                along = is_largest ? direction[axis] : along;
                across[0] = is_largest ? direction[next] : across[0];
                across[1] = is_largest ? direction[last] : across[1];
                z[axis] = is_largest;
            }
            const Floats slopes[]{-across[0] / along, -across[1] / along};
            for (int axis = 0; axis < 3; ++axis) {
                x[axis] = z[axis] ? slopes[0] : z[(axis + 2) % 3] ? of(1) : Floats{};
                y[axis] = z[axis] ? slopes[1] : z[(axis + 1) % 3] ? of(1) : Floats{};
            }
        }

        // What is nearer than t_max is before them.
        static Hits ends(Floats t_max) {
            Hits ends{};
            ends.height = t_max;
            ends.speed += 1;
            return ends;
        }

        // Weights of corners have the right sign, as in compute.glsl, and are 0 only at an edge, which is inside. So no ray
        // passes between two triangles, nor between those around a corner, unless it runs along one of them.
        LAB_INLINE Hits hits(const Plane& plane) const {
            Floats corners[3][3], xs[3], ys[3], base[3], normal[3];
            for (int i = 0; i < 3; ++i) {
                for (int axis = 0; axis < 3; ++axis) corners[i][axis] = plane.corners[i][axis] - origin[axis];
                xs[i] = dot(corners[i], x);
                ys[i] = dot(corners[i], y);
                base[i] = plane.base[i] - origin[i];
                normal[i] = of(plane.normal[i]);
            }
            Hits hits;
            for (int i = 0; i < 3; ++i) {
                const int next = (i + 1) % 3, last = (i + 2) % 3;
                hits.weights[i] = difference(xs[next], ys[last], ys[next], xs[last]);
            }
            const auto& [a, b, c] = hits.weights;
            hits.sum = a + b + c;
            hits.are_inside = (((a >= 0) & (b >= 0) & (c >= 0)) | ((a <= 0) & (b <= 0) & (c <= 0))) & (hits.sum != 0);
            const Floats height = dot(base, normal), speed = dot(direction, normal);
            hits.height = speed < 0 ? -height : height;
            hits.speed = speed < 0 ? -speed : speed;
            return hits;
        }
    };

    std::vector<Plane> planes_;
};

}  // namespace lab::native
#endif

extern "C" __attribute__((visibility("default"))) lab::native::RayTracer* lab_make_ray_tracer(
    const lab::native::RayTracer::Triangle* triangles, size_t count) {
    using namespace lab::native;
#ifdef LAB_FEW_TRIANGLES
    if (count <= FewTriangles::limit) return new FewTriangles(triangles, count);
#endif
    return new EmbreeTracer(triangles, count);
}
