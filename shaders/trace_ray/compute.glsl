// trace_ray() for any device: a bounding volume hierarchy (BVH) in two buffers, built by common/tracing/bvh.cpp.
#extension GL_EXT_samplerless_texture_functions : require

// A node is eight texels: low x, high x, low y, high y, low z, high z of its four children and references to them.
layout(set = 0, binding = BINDING_BVH_NODES) uniform utextureBuffer bvh_nodes;
// A triangle is three texels: a vertex each, then instance, triangle and nothing as fourth components.
layout(set = 0, binding = BINDING_BVH_TRIANGLES) uniform utextureBuffer bvh_triangles;

const uint LEAF_SHIFT = 28u;  // a leaf's reference is its number of triangles << LEAF_SHIFT | the first
const uint FIRST_LEAF = 1u << LEAF_SHIFT;
const uint NONE = 0xffffffffu;

#ifdef COUNT_TRAVERSAL_STEPS
uint traversal_steps = 0u;  // nodes and triangles visited by this invocation
#define COUNT_STEP() ++traversal_steps
#else
#define COUNT_STEP()
#endif

vec4 fetch_row(int row) { return uintBitsToFloat(texelFetch(bvh_nodes, row)); }
#ifndef V_PRECISE_EDGE
#define V_PRECISE_EDGE precise
#endif

// Closest hit nearer than t_max, or with `any_hit` the first that turns up.
bool traverse(Ray ray, float t_max, bool any_hit, out Hit hit) {
    // A zero in the direction would make NaN of rays on the face of a box.
    vec3 direction = mix(ray.direction, vec3(1e-18), lessThan(abs(ray.direction), vec3(1e-18)));
    precise vec3 inverse = 1.0 / direction;
    ivec3 near_row = ivec3(0, 2, 4) + ivec3(lessThan(direction, vec3(0.0)));
    ivec3 far_row = near_row ^ 1;
    // Rounding errors must not cut off the border of a box. The boxes are padded for theirs, here are those of o.
    vec3 magnitude = abs(ray.origin);
    float padding = 9.5367431640625e-07 * max(magnitude.x, max(magnitude.y, magnitude.z));
    precise vec3 near_offset = -ray.origin * inverse - padding * abs(inverse);
    precise vec3 far_offset = -ray.origin * inverse + padding * abs(inverse);

#ifndef V_MT
    vec3 row_x, row_y, row_z;
    vec3 a = abs(ray.direction), d = ray.direction;
    if (a.x >= a.y && a.x >= a.z) { row_x = vec3(-d.y / d.x, 1, 0); row_y = vec3(-d.z / d.x, 0, 1); row_z = vec3(1.0 / d.x, 0, 0); }
    else if (a.y >= a.z) { row_x = vec3(0, -d.z / d.y, 1); row_y = vec3(1, -d.x / d.y, 0); row_z = vec3(0, 1.0 / d.y, 0); }
    else { row_x = vec3(1, 0, -d.x / d.z); row_y = vec3(0, 1, -d.y / d.z); row_z = vec3(0, 0, 1.0 / d.z); }
#endif

    uint stack[BVH_STACK_SIZE];
    stack[0] = NONE;
    int top = 0;
    uint reference = 0u;
    int hit_row = -1;
    hit.distance = t_max;
    while (reference != NONE) {
        if (reference < FIRST_LEAF) {
            COUNT_STEP();
            int node = 8 * int(reference);
            vec4 enter_x = fetch_row(node + near_row.x) * inverse.x + near_offset.x;
            vec4 enter_y = fetch_row(node + near_row.y) * inverse.y + near_offset.y;
            vec4 enter_z = fetch_row(node + near_row.z) * inverse.z + near_offset.z;
            vec4 leave_x = fetch_row(node + far_row.x) * inverse.x + far_offset.x;
            vec4 leave_y = fetch_row(node + far_row.y) * inverse.y + far_offset.y;
            vec4 leave_z = fetch_row(node + far_row.z) * inverse.z + far_offset.z;
            uvec4 children = texelFetch(bvh_nodes, node + 6);
            vec4 enter = max(enter_x, max(enter_y, max(enter_z, vec4(0.0))));
            vec4 leave = min(leave_x, min(leave_y, min(leave_z, vec4(hit.distance))));
            // Positive floats sort like their bits. The two lowest bits remember the child.
            uvec4 key = mix(uvec4(NONE), (floatBitsToUint(enter) & ~3u) | uvec4(0, 1, 2, 3), lessThanEqual(enter, leave));
            key = uvec4(min(key.xz, key.yw), max(key.xz, key.yw)).xzyw;
            key = uvec4(min(key.xy, key.zw), max(key.xy, key.zw));
            key.yz = uvec2(min(key.y, key.z), max(key.y, key.z));
            if (key.w != NONE) stack[++top] = children[key.w & 3u];
            if (key.z != NONE) stack[++top] = children[key.z & 3u];
            if (key.y != NONE) stack[++top] = children[key.y & 3u];
            if (key.x != NONE) reference = children[key.x & 3u];
            else reference = stack[top--];
        } else {
            int row = 3 * int(reference & (FIRST_LEAF - 1u));
            int end = row + 3 * int(reference >> LEAF_SHIFT);
            for (; row < end; row += 3) {
                COUNT_STEP();
                vec3 v_0 = uintBitsToFloat(texelFetch(bvh_triangles, row).xyz);
                vec3 v_1 = uintBitsToFloat(texelFetch(bvh_triangles, row + 1).xyz);
                vec3 v_2 = uintBitsToFloat(texelFetch(bvh_triangles, row + 2).xyz);
#ifdef V_MT
                vec3 e_1 = v_1 - v_0, e_2 = v_2 - v_0;
                vec3 p = cross(ray.direction, e_2);
                float inv_det = 1.0 / dot(e_1, p);
                vec3 s = ray.origin - v_0;
                float u = dot(s, p) * inv_det;
                vec3 q = cross(s, e_1);
                float v = dot(ray.direction, q) * inv_det;
                float t = dot(e_2, q) * inv_det;
                if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < hit.distance) {
                    hit.distance = t;
                    hit.barycentrics = vec2(u, v);
                    hit_row = row;
                }
#else
                v_0 -= ray.origin; v_1 -= ray.origin; v_2 -= ray.origin;
                V_PRECISE_EDGE vec3 x = vec3(dot(row_x, v_0), dot(row_x, v_1), dot(row_x, v_2));
                V_PRECISE_EDGE vec3 y = vec3(dot(row_y, v_0), dot(row_y, v_1), dot(row_y, v_2));
                vec3 z = vec3(dot(row_z, v_0), dot(row_z, v_1), dot(row_z, v_2));
                V_PRECISE_EDGE vec3 edge = x.yzx * y.zxy - y.yzx * x.zxy;
                float lowest = min(edge.x, min(edge.y, edge.z)), highest = max(edge.x, max(edge.y, edge.z));
                float det = edge.x + edge.y + edge.z;
                if ((lowest >= 0.0 || highest <= 0.0) && det != 0.0) {
                    vec3 w = edge / det;
                    float t = dot(w, z);
                    if (t > 0.0 && t < hit.distance) {
                        hit.distance = t;
                        hit.barycentrics = w.yz;
                        hit_row = row;
                    }
                }
#endif
            }
            reference = any_hit && hit_row >= 0 ? NONE : stack[top--];
        }
    }
    if (hit_row < 0) return false;
    hit.instance = texelFetch(bvh_triangles, hit_row).w;
    hit.triangle = texelFetch(bvh_triangles, hit_row + 1).w;
    return true;
}

bool trace_ray(Ray ray, float t_max, out Hit hit) {
    ++ray_count;
    return traverse(ray, t_max, false, hit);
}

bool is_occluded(Ray ray, float t_max) {
    ++ray_count;
    Hit hit;
    return traverse(ray, t_max, true, hit);
}
