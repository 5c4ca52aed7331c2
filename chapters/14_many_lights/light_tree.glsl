// Three ways to choose an emissive triangle: by the tree, by its power as in earlier chapters, and all alike.
const uint CHOOSES_BY_TREE = 0u;
const uint CHOOSES_BY_POWER = 1u;
const uint CHOOSES_UNIFORMLY = 2u;
#ifndef LIGHT_CHOICE
#define LIGHT_CHOICE CHOOSES_BY_TREE
#endif

// The point x_k at which light arrives, as the tree sees it.
struct Receiver {
    vec3 position;
    vec3 normal;  // light arrives from its side only, or from everywhere if it is 0
};

// Of the latest light sample. The bounce that follows weighs what it finds by the density that this sample would have had.
Receiver receiver = Receiver(vec3(0.0), vec3(0.0));

void set_receiver(ShadingData s) {
    receiver = Receiver(s.position, s.normal);
#ifdef FEATURE_MICROFACETS
    if (s.is_rough_dielectric) receiver.normal = vec3(0.0);
#endif
}

#ifdef FEATURE_LIGHT_TREE

// The cosine of max(0, a - b), where b is an angle of at most π/2 whose sine is known, too. Of 0 up to the angle b, every
// direction could be meant, so the cosine is 1 there.
float get_cos_beyond(float cos_a, float cos_b, float sin_b) {
    if (cos_a >= cos_b) return 1.0;
    return cos_a * cos_b + sqrt(max(1.0 - cos_a * cos_a, 0.0)) * sin_b;
}

// An estimate of the light that a point gets from the node's triangles, if nothing is in between. 0 only where none can arrive.
float get_importance(LightNode node, Receiver x) {
    vec3 to_node = node.centre - x.position;
    float distance = length(to_node);
    // Within the sphere, light may come from anywhere.
    if (distance <= node.radius) return node.power / (node.radius * node.radius);

    // From x_k the sphere fills a cone about ω with this half angle, or a little less than we say because of rounding errors.
    vec3 omega = to_node / distance;
    float sin_size = min(node.radius / distance + 8.0 * ROUNDING, 1.0), cos_size = sqrt(1.0 - sin_size * sin_size);

    // The smallest angle θ' that a triangle's normal may have to the direction from it to x_k. The angle to the axis comes
    // first, then the cone of normals takes some of it, and the size of the sphere takes more.
    float sin_spread = sqrt(max(1.0 - node.cos_spread * node.cos_spread, 0.0));
    float cos_light = get_cos_beyond(-dot(node.axis, omega), node.cos_spread, sin_spread);
    cos_light = get_cos_beyond(cos_light, cos_size, sin_size);
    if (cos_light <= 0.0) return 0.0;

    // The smallest angle θ at x_k.
    float cos_surface = x.normal == vec3(0.0) ? 1.0 : get_cos_beyond(dot(x.normal, omega), cos_size, sin_size);
    return node.power * cos_light * max(cos_surface, 0.0) / (distance * distance);
}

// The probability of the first of two children, given that one is chosen. `is_dead_end` says that neither can be.
float get_first_probability(uint child, Receiver x, out bool is_dead_end) {
    float first = get_importance(light_nodes[child], x), second = get_importance(light_nodes[child + 1u], x);
    is_dead_end = first + second == 0.0;
    return first / (first + second);
}

// Decides with the given probability by a number in [0,1) of 64 binary digits, and turns its position within the part that was
// decided for into a new number. If numbers are stratified, so are the new ones, except for their last digits: a hash provides
// those.
bool decide(float probability, inout uvec2 digits) {
    // The less likely part comes first, since numbers close to 0 have the most digits.
    bool is_turned = probability > 0.5;
    float width = 4294967296.0 * (is_turned ? 1.0 - probability : probability);
    uvec2 end = uvec2(uint(width), uint(4294967296.0 * fract(width)));
    bool is_below = digits.x < end.x || (digits.x == end.x && digits.y < end.y);
    uvec2 fresh = digits;
    advance_random_state(fresh);
    if (!is_below) {
        digits.x -= end.x + uint(digits.y < end.y);
        digits.y -= end.y;
        width = 4294967296.0 - width;
    }
    float rest = (float(digits.x) + float(digits.y) / 4294967296.0) / width;
    digits = uvec2((uint(min(16777216.0 * rest, 16777215.0)) << 8u) | (fresh.x >> 24u), fresh.y);
    return is_below != is_turned;
}

// Descends the tree: one number decides at all nodes, and what is left of it is the first of the two numbers for a point.
LightTriangle choose_light_by_tree(inout uvec2 seed, out vec2 u) {
    uvec2 words = get_random_words(seed), digits = words;
    u = to_numbers(words);
    advance_random_state(digits);
    digits = uvec2(words.x, digits.x);
    float probability = 1.0;
    uint child = light_nodes[0].child;
    while (child < IS_LIGHT_LEAF) {
        bool is_dead_end;
        float first_probability = get_first_probability(child, receiver, is_dead_end);
        if (is_dead_end) return LightTriangle(0u, 0u, 0u, 0u, 0.0);
        bool is_first = decide(first_probability, digits);
        probability *= is_first ? first_probability : 1.0 - first_probability;
        child = light_nodes[is_first ? child : child + 1u].child;
    }
    u.x = to_numbers(digits).x;
    LightTriangle light = light_triangles[child - IS_LIGHT_LEAF];
    light.inverse_density = light_leaves[get_light_place(light.instance, light.triangle)].area / probability;
    return light;
}

// The probability of a leaf: its trail says which children lead there.
float get_tree_probability(uint trail) {
    float probability = 1.0;
    uint child = light_nodes[0].child;
    for (; child < IS_LIGHT_LEAF && probability > 0.0; trail >>= 1u) {
        bool is_dead_end;
        float first_probability = get_first_probability(child, receiver, is_dead_end);
        if (is_dead_end) return 0.0;
        bool is_first = (trail & 1u) == 0u;
        probability *= is_first ? first_probability : 1.0 - first_probability;
        child = light_nodes[is_first ? child : child + 1u].child;
    }
    return probability;
}

// Each triangle has the same probability.
LightTriangle choose_light_uniformly(inout uvec2 seed, out vec2 u) {
    uint count = uint(light_triangles.length());
    uvec2 words = get_random_words(seed);
    u = to_numbers(words);
    uint digits;
    LightTriangle light = light_triangles[get_random_index(count, words, digits)];
    u.x = to_numbers(uvec2(digits)).x;
    light.inverse_density = light_leaves[get_light_place(light.instance, light.triangle)].area * float(count);
    return light;
}

// Half of the light samples go to the light probe, if there is one.
const float TRIANGLE_PROBABILITY = HAS_LIGHT_PROBE_CELLS ? 1.0 - LIGHT_PROBE_PROBABILITY : 1.0;

// Chooses a triangle, and two numbers in [0,1) for a point on it.
LightTriangle choose_light(inout uvec2 seed, out vec2 u) {
    if (LIGHT_CHOICE == CHOOSES_BY_POWER) return choose_light_triangle(seed, u);
    bool is_uniform = LIGHT_CHOICE == CHOOSES_UNIFORMLY;
    LightTriangle light = is_uniform ? choose_light_uniformly(seed, u) : choose_light_by_tree(seed, u);
    light.inverse_density /= TRIANGLE_PROBABILITY;
    return light;
}

// p_A: the density with respect to area that the light sample before had at the emissive triangle that a bounce has hit.
float get_light_density(ShadingData s) {
    if (LIGHT_CHOICE == CHOOSES_BY_POWER) return s.light_density;
    LightLeaf leaf = light_leaves[s.light];
    bool is_uniform = LIGHT_CHOICE == CHOOSES_UNIFORMLY;
    float probability = is_uniform ? 1.0 / float(light_triangles.length()) : get_tree_probability(leaf.trail);
    return TRIANGLE_PROBABILITY * probability / leaf.area;
}
#else
LightTriangle choose_light(inout uvec2 seed, out vec2 u) { return choose_light_triangle(seed, u); }
float get_light_density(ShadingData s) { return s.light_density; }
#endif

// The shading data where a bounce hits, with the density of the light sample before.
ShadingData get_weighed_shading_data(Hit hit, vec3 ray_direction) {
    ShadingData s = get_shading_data(hit, ray_direction);
    if (s.light_density > 0.0) s.light_density = get_light_density(s);
    return s;
}
