// trace_ray() for any device: traverses a bounding volume hierarchy (BVH) of our own.
#include "bvh.glsl"

// A reference below END is the index of an inner node; above END it is a leaf: (triangle count << 28) | first triangle.
const uint END = 0x0fffffffu;
const uint MISS = 0xffffffffu;

uint traversal_steps = 0u;  // nodes and triangles that this invocation has visited

// Finds the closest hit nearer than t_max, or with `any_hit` the first one that it meets.
bool traverse(Ray ray, float t_max, bool any_hit, out Hit hit) {
    // Boxes: the ray meets the plane x = p at t = p * inverse.x + offset.x. Zeros in the direction would give NaN.
    vec3 direction = mix(ray.direction, vec3(1e-18), lessThan(abs(ray.direction), vec3(1e-18)));
    precise vec3 inverse = 1.0 / direction;
    ivec3 near = ivec3(0, 2, 4) + ivec3(lessThan(direction, vec3(0.0)));
    ivec3 far = near ^ 1;
    // Rounding must not lose a box: the builder pads it by 2^-20 of its coordinates, and here by as much of the ray's origin.
    float radius = max(abs(ray.origin.x), max(abs(ray.origin.y), abs(ray.origin.z))) / 1048576.0;
    precise vec3 near_offset = -ray.origin * inverse - radius * abs(inverse);
    precise vec3 far_offset = -ray.origin * inverse + radius * abs(inverse);

    // Triangles: a permutation of the axes makes z the direction's largest component, then a shear turns the ray into
    // the z-axis. Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1) 2013.
    vec3 size = abs(ray.direction);
    ivec3 axes = size.x > max(size.y, size.z) ? ivec3(1, 2, 0) : size.y > size.z ? ivec3(2, 0, 1) : ivec3(0, 1, 2);
    vec3 origin = vec3(ray.origin[axes.x], ray.origin[axes.y], ray.origin[axes.z]);
    vec3 shear = vec3(ray.direction[axes.x], ray.direction[axes.y], 1.0) / ray.direction[axes.z];

    uint stack[BVH_STACK_SIZE];
    stack[0] = END;
    int top = 0;
    uint reference = 0u;
    int hit_triangle = -1;
    hit.distance = t_max;
    while (reference != END) {
        if (reference < END) {
            ++traversal_steps;
            int node = 8 * int(reference);
            vec4 near_x = fetch_node_row(node + near.x), far_x = fetch_node_row(node + far.x);
            vec4 near_y = fetch_node_row(node + near.y), far_y = fetch_node_row(node + far.y);
            vec4 near_z = fetch_node_row(node + near.z), far_z = fetch_node_row(node + far.z);
            uvec4 children = fetch_node_texel(node + 6);
            // As integers, the bits of positive floats are ordered like the floats and negative ones stay negative.
            ivec4 enter_x = floatBitsToInt(near_x * inverse.x + near_offset.x);
            ivec4 enter_y = floatBitsToInt(near_y * inverse.y + near_offset.y);
            ivec4 enter_z = floatBitsToInt(near_z * inverse.z + near_offset.z);
            ivec4 leave_x = floatBitsToInt(far_x * inverse.x + far_offset.x);
            ivec4 leave_y = floatBitsToInt(far_y * inverse.y + far_offset.y);
            ivec4 leave_z = floatBitsToInt(far_z * inverse.z + far_offset.z);
            ivec4 enter = max(enter_x, max(enter_y, max(enter_z, 0)));
            ivec4 leave = min(leave_x, min(leave_y, min(leave_z, floatBitsToInt(hit.distance))));
            // Sort the children by distance, misses last. The two lowest bits hold the child's index.
            uvec4 key = uvec4((enter & ~3) | ivec4(0, 1, 2, 3));
            key = mix(uvec4(MISS), key, lessThanEqual(enter, leave));
            key = uvec4(min(key.xz, key.yw), max(key.xz, key.yw)).xzyw;
            key = uvec4(min(key.xy, key.zw), max(key.xy, key.zw));
            key.yz = uvec2(min(key.y, key.z), max(key.y, key.z));
            // Visit the nearest next; the others wait on the stack.
            if (key.w != MISS) stack[++top] = children[key.w & 3u];
            if (key.z != MISS) stack[++top] = children[key.z & 3u];
            if (key.y != MISS) stack[++top] = children[key.y & 3u];
            reference = key.x != MISS ? children[key.x & 3u] : stack[top--];
        }
        // No else: if the node led to a leaf, its triangles are tested in the same iteration.
        if (reference > END) {
            int first = 3 * int(reference & END);
            int end = first + 3 * int(reference >> 28u);
            // Not do-while: one driver lets threads that left a loop at its bottom repeat it, without the values they had loaded.
            for (int triangle = first; triangle < end; triangle += 3) {
                ++traversal_steps;
                vec3 x = fetch_triangle_row(triangle + axes.x);
                vec3 y = fetch_triangle_row(triangle + axes.y);
                vec3 z = fetch_triangle_row(triangle + axes.z) - origin.z;
                // Triangles that share a vertex compute the same numbers for it, and the difference of two rounded products never
                // has the wrong sign: so no ray slips through between them. `precise` forbids fusing.
                precise vec3 sheared_x = fma(vec3(-shear.x), z, x - origin.x);
                precise vec3 sheared_y = fma(vec3(-shear.y), z, y - origin.y);
                precise vec3 area = sheared_x.zxy * sheared_y.yzx - sheared_y.zxy * sheared_x.yzx;
                float sum = area.x + area.y + area.z;
                bool is_inside = all(greaterThanEqual(area, vec3(0.0))) || all(lessThanEqual(area, vec3(0.0)));
                vec3 weights = area / sum;
                float distance = dot(weights, shear.z * z);
                if (is_inside && sum != 0.0 && distance > 0.0 && distance < hit.distance) {
                    hit.distance = distance;
                    hit.barycentrics = weights.yz;
                    hit_triangle = triangle;
                }
            }
            reference = any_hit && hit_triangle >= 0 ? END : stack[top--];
        }
    }
    if (hit_triangle < 0) return false;
    hit.instance = fetch_triangle_texel(hit_triangle).w;
    hit.triangle = fetch_triangle_texel(hit_triangle + 1).w;
#ifdef FEATURE_DIELECTRICS
    hit.material_class = get_material_class(hit.triangle);
#endif
    return true;
}

// Finds the closest hit nearer than t_max, and returns whether there is one.
bool trace_ray(Ray ray, float t_max, out Hit hit) {
    ++ray_count;
    return traverse(ray, t_max, false, hit);
}

// Whether anything is hit nearer than t_max. Any hit will do.
bool is_occluded(Ray ray, float t_max) {
    ++ray_count;
    Hit hit;
    return traverse(ray, t_max, true, hit);
}
