// Splitting where every branch gets a generator of its own, and its light is put together from the back: the radiance
// that leaves x_k is direct light + factor · radiance that leaves x_{k+1}.
#include "direct_light.glsl"

// Different branches start in different states, since the generator's step is a bijection.
uvec2 get_branch_seed(uvec2 seed, uint branch) {
    uvec2 branch_seed = seed + uvec2(branch, 0u);
    advance_random_state(branch_seed);
    return branch_seed;
}

// Density cos θ / π: the normal plus a uniform point of the unit sphere.
vec3 sample_cosine_lobe(vec3 normal, inout uvec2 seed) {
    vec2 u = get_random_numbers(seed);
    float z = 1.0 - 2.0 * u.x;
    vec3 point = vec3(sqrt(1.0 - z * z) * vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y)), z);
    vec3 sum = normal + point;
    return dot(sum, sum) > 1e-12 ? normalize(sum) : normal;
}

// What x_k sends back by itself, and the share of what it gets from x_{k+1}.
struct Vertex {
    vec3 own;
    vec3 factor;
};

// Vertices of which one block is kept. A full block is joined to one vertex, which is exact: both are linear.
const uint BLOCK = 8u;

Vertex join_vertices(Vertex vertices[BLOCK], uint count) {
    Vertex joined = Vertex(vec3(0.0), vec3(1.0));
    for (uint i = count; i-- > 0u;) {
        joined.own = vertices[i].own + vertices[i].factor * joined.own;
        joined.factor *= vertices[i].factor;
    }
    return joined;
}

vec3 trace_branch(ShadingData s, vec3 out_direction, uvec2 seed) {
    Vertex vertices[BLOCK];
    uint count = 0u;
    for (uint k = 1u; k <= parameters.max_path_length && is_above_surface(s, out_direction); ++k) {
        Vertex vertex = Vertex(vec3(0.0), vec3(0.0));
        if (LIGHT_SAMPLING) {
            vec3 direct_light = sample_direct_light(s, out_direction, seed);
            if (is_counted(k)) vertex.own += direct_light;
        }
        vec3 omega = sample_cosine_lobe(s.normal, seed);
        bool is_last = LIGHT_SAMPLING && !HAS_BACKGROUND && k == parameters.max_path_length;
        bool is_hit = false;
        if (!is_last && is_above_surface(s, omega)) {
            vec3 factor = get_pi_brdf(s, omega, out_direction);
            Hit hit;
            is_hit = trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit);
            if (is_hit) {
                s = get_shading_data(hit, omega);
                if (!LIGHT_SAMPLING && is_counted(k)) vertex.own += factor * s.emission;
                vertex.factor = factor;
                out_direction = -omega;
            } else if (is_counted(k)) {
                vertex.own += factor * get_background_radiance(omega);
            }
        }
        vertices[count++] = vertex;
        if (!is_hit) break;
        if (count == BLOCK) {
            vertices[0] = join_vertices(vertices, count);
            count = 1u;
        }
    }
    return join_vertices(vertices, count).own;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.emission : vec3(0.0);
    uint factor = parameters.splitting_factor;
    vec3 branches = vec3(0.0);
    for (uint branch = 1u; branch <= factor; ++branch)
        branches += trace_branch(s, -ray.direction, get_branch_seed(seed, branch));
    return radiance + branches / float(factor);
}
