// Looks at the light tree from a random point: red counts points whose probabilities do not add up to 1, green counts lamps that
// could send light but are never chosen, and draws whose density is not that of their trail. The mean of blue is 1 if lamps are
// chosen as often as their probabilities say: it is 1 more than the frequency of those on one side less their probability.
#define path_trace path_trace_of_chapter
#include "observed.glsl"
#undef path_trace

const uint DRAWS = 64u;

uint get_trail(LightTriangle light) { return light_leaves[get_light_place(light.instance, light.triangle)].trail; }
bool is_on_the_left(LightTriangle light, Receiver x) { return get_light_point(light, vec2(1.0 / 3.0)).position.x < x.position.x; }

// In the box around the spheres of the root's children, or close to a lamp. One in four has no normal.
Receiver get_random_receiver(inout uvec2 seed) {
    vec2 u = get_random_numbers(seed), v = get_random_numbers(seed), w = get_random_numbers(seed);
    LightNode root = light_nodes[0];
    vec3 low = vec3(NO_LIMIT), high = vec3(-NO_LIMIT);
    for (int i = 0; i < 4; ++i) {
        if (!(root.power[i] > 0.0)) continue;
        vec3 centre = vec3(root.centre_x[i], root.centre_y[i], root.centre_z[i]);
        low = min(low, centre - root.radius[i]);
        high = max(high, centre + root.radius[i]);
    }
    Receiver x = Receiver(true, 0.5 * (low + high), vec3(0.0));
    vec3 offset = 0.5 * (high - low) * (2.0 * vec3(u, v.x) - 1.0);
    if (v.y < 0.25) {
        LightTriangle light = light_triangles[uint(w.x * float(light_triangles.length()))];
        x.position = get_light_point(light, u).position;
        offset *= 1e-3;
    }
    x.position += offset;
    float z = 2.0 * w.y - 1.0, angle = 2.0 * PI * get_random_numbers(seed).x;
    if (v.x < 0.75) x.normal = vec3(sqrt(1.0 - z * z) * vec2(cos(angle), sin(angle)), z);
    return x;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Receiver receiver = get_random_receiver(seed);
    uint count = uint(light_triangles.length()), lost = 0u;
    float sum = 0.0, left = 0.0;
    for (uint first = 0u; first < count; first += 64u) {
        float part = 0.0;  // so that rounding errors of the sum stay small
        for (uint i = first; i < min(first + 64u, count); ++i) {
            LightTriangle light = light_triangles[i];
            float probability = get_tree_probability(receiver, get_trail(light));
            part += probability;
            if (is_on_the_left(light, receiver)) left += probability;

            vec2 u = get_random_numbers(seed);
            light.inverse_density = 1.0;
            LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));
            vec3 to_light = y.position - receiver.position;
            bool can_arrive = dot(y.normal, to_light) < 0.0 &&
                              (receiver.normal == vec3(0.0) || dot(receiver.normal, to_light) > 0.0);
            if (can_arrive && !(probability > 0.0)) ++lost;
        }
        sum += part;
    }
    float frequency = 0.0;
    for (uint i = 0u; i < DRAWS; ++i) {
        vec2 u;
        LightTriangle light = choose_light_by_tree(receiver, seed, u);
        if (is_on_the_left(light, receiver)) frequency += 1.0 / float(DRAWS);
        LightLeaf leaf = light_leaves[get_light_place(light.instance, light.triangle)];
        float density = get_tree_probability(receiver, leaf.trail) / leaf.area;
        if (!(abs(density * light.inverse_density - 1.0) < 1e-5)) ++lost;
    }
    return vec3(!(abs(sum - 1.0) < 1e-6), lost, 1.0 + frequency - left);
}
