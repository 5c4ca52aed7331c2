// Views: an estimator that shows what a camera ray hits instead of the radiance that it carries.

// A pseudorandom colour for each number, so that neighbours differ.
vec3 get_colour(uint id) {
    uvec2 seed = uvec2(id, 0u);
    vec2 u = get_random_numbers(seed);
    return vec3(u, get_random_numbers(seed).x);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    bool is_hit = trace_ray(ray, NO_LIMIT, hit);
#ifdef FEATURE_OPEN_BOUNDARIES
    float passed = 0.0;
    while (is_hit && is_open_boundary(hit)) {  // there is nothing to see
        passed += hit.distance;
        ray = get_ray_behind(hit, ray.direction);
        is_hit = trace_ray(ray, NO_LIMIT, hit);
    }
    hit.distance += passed;
#endif
#ifdef VIEW_BVH_STEPS
    return vec3(traversal_steps);
#endif
#ifdef VIEW_FOCUS
    // Circle of confusion in the plane in focus, c = A |z - f| / z, over the height of a pixel there.
    Camera camera = parameters.camera;
    float blur = is_hit ? abs(1.0 - camera.focus_distance / (hit.distance * dot(ray.direction, camera.forward))) : 1.0;
    float pixel = 2.0 * camera.focus_distance * length(camera.up) / float(parameters.image_size.y);
    return vec3(2.0 * camera.aperture_radius * blur / pixel);
#endif
    if (!is_hit) return vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
#if defined(BEHIND_GLASS) && defined(FEATURE_DIELECTRICS)
    // What smooth glass lets through, or else reflects: a path leaves it here after at most so many surfaces.
    for (int i = 0; s.is_dielectric && i < 8; ++i) {
        vec3 direction = refract(ray.direction, s.normal, 1.0 / s.relative_index);
        if (direction == vec3(0.0)) direction = reflect(ray.direction, s.normal);
        ray = get_ray_from_surface(s, direction);
        if (!trace_ray(ray, NO_LIMIT, hit)) return vec3(0.0);
        s = get_shading_data(hit, ray.direction);
    }
#endif
#if defined(VIEW_NORMALS)
    return 0.5 + 0.5 * s.normal;
#elif defined(VIEW_DEPTH)
    return vec3(hit.distance);
#elif defined(VIEW_ALBEDO)
    return s.diffuse_albedo;
#elif defined(VIEW_EMISSION)
    return s.emission;
#elif defined(VIEW_TEXTURE_COORDINATES)
    return vec3(fract(s.texture_coordinates), 0.0);
#elif defined(VIEW_TRIANGLES)
    return get_colour(hit.triangle);
#else
    return get_colour(hit.instance);
#endif
}
